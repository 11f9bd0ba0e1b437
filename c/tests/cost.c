/* For tests/instructions.sh borders: `cost METHOD COUNT < EVENTS` pushes the events of the first COUNT magnetometer samples. EVENTS, as c/examples/stream.c
 * reads them, are read whatever COUNT is, so that reading them is not in the difference of two counts. */
#include <inttypes.h>
#include <magcomp.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct {
    char sensor;
    int64_t time_ns;
    double x, y, z;
} event;

int main(int count_of_arguments, char **arguments) {
    static event events[100000];
    size_t read = 0;
    if (count_of_arguments != 3) return 2;
    event *next = events;
    while (read < sizeof events / sizeof *events &&
           scanf(" %c %" SCNd64 " %lf %lf %lf", &next->sensor, &next->time_ns, &next->x, &next->y, &next->z) == 5) {
        next = &events[++read];
    }
    char config[64];
    snprintf(config, sizeof config, "{\"method\": \"%s\"}", arguments[1]);
    magcomp_compensator *compensator;
    if (magcomp_compensator_create(config, &compensator) != MAGCOMP_ERROR_NONE) return 1;
    magcomp_reading reading = {.size = sizeof reading};
    long left = atol(arguments[2]);
    for (next = events; left > 0 && next < events + read; next++) {
        magcomp_error error;
        if (next->sensor == 'g') {
            error = magcomp_compensator_push_rotation_rate(compensator, next->time_ns, next->x, next->y, next->z);
        } else if (next->sensor == 'a') {
            error = magcomp_compensator_push_up(compensator, next->time_ns, next->x, next->y, next->z);
        } else {
            error = magcomp_compensator_push(compensator, next->time_ns, next->x, next->y, next->z, &reading);
            left--;
        }
        if (error != MAGCOMP_ERROR_NONE) return 1;
    }
    magcomp_compensator_free(compensator);
    return left > 0;
}

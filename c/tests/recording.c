/* Events on stdin, as examples/stream.c reads them; readings by their bits, in the form of rust/magcomp-ffi/examples/expected.rs. */
#include <inttypes.h>
#include <magcomp.h>
#include <stdio.h>
#include <string.h>

static void bits(const double *values, int count) {
    for (int k = 0; k < count; k++) {
        uint64_t bits;
        memcpy(&bits, &values[k], sizeof bits);
        if (values[k] != values[k]) {
            printf(" -");
        } else {
            printf(" %" PRIx64, bits);
        }
    }
}

int main(void) {
    static const char *const labels[] = {"collecting", "tracking", "suspect", "held", "disturbed", "rejected"};
    magcomp_compensator *compensator;
    magcomp_reading reading = {.size = sizeof reading};
    char sensor;
    int64_t time_ns;
    double x, y, z;
    if (magcomp_compensator_create("{\"heading\": {\"axis\": \"Auto\"}}", &compensator) != MAGCOMP_ERROR_NONE) return 1;
    while (scanf(" %c %" SCNd64 " %lf %lf %lf", &sensor, &time_ns, &x, &y, &z) == 5) {
        if (sensor == 'g') magcomp_compensator_push_rotation_rate(compensator, time_ns, x, y, z);
        if (sensor == 'a') magcomp_compensator_push_up(compensator, time_ns, x, y, z);
        if (sensor != 'm') continue;
        if (magcomp_compensator_push(compensator, time_ns, x, y, z, &reading) != MAGCOMP_ERROR_NONE) return 1;
        const double window = (double)reading.window;
        printf("reading %" PRId64 " %s", reading.time_ns, labels[reading.status]);
        bits(reading.field_ut, 3);
        bits(&reading.total_field_ut, 1);
        bits(&reading.heading_deg, 1);
        bits(&reading.heading_sigma_deg, 1);
        bits(&reading.inclination_deg, 1);
        bits(reading.attitude, 4);
        bits(&reading.attitude_sigma_deg, 1);
        bits(&reading.sigma_t, 1);
        bits(&window, 1);
        bits(&reading.coverage, 1);
        printf("\n");
    }
    magcomp_compensator_free(compensator);
    return 0;
}

#include <inttypes.h>
#include <magcomp.h>
#include <stdio.h>
#include <time.h>

/* Lines on stdin: m (magnetometer, uT), g (gyroscope, rad/s) or a (accelerometer, m/s^2), the time in ns, x, y, z. */
int main(void) {
    magcomp_config config = {.size = sizeof config};
    magcomp_config_default(&config);
    config.declination_deg = 2.5;
    magcomp_compensator *compensator;
    if (magcomp_compensator_create_with(&config, &compensator) != MAGCOMP_ERROR_NONE) {
        fprintf(stderr, "%s\n", magcomp_compensator_last_error(NULL));
        return 1;
    }
    magcomp_reading reading = {.size = sizeof reading};
    char sensor;
    int64_t time_ns;
    double x, y, z;
    while (scanf(" %c %" SCNd64 " %lf %lf %lf", &sensor, &time_ns, &x, &y, &z) == 5) {
        if (sensor == 'g') magcomp_compensator_push_rotation_rate(compensator, time_ns, x, y, z);
        if (sensor == 'a') magcomp_compensator_push_up(compensator, time_ns, x, y, z);
        if (sensor != 'm' || magcomp_compensator_push(compensator, time_ns, x, y, z, &reading) != MAGCOMP_ERROR_NONE) continue;
        /* NaN until there is a heading; the text says what is missing */
        printf("%.2f +- %.2f deg, %s\n", reading.true_heading_deg, reading.heading_sigma_deg, magcomp_compensator_status_text(compensator));
    }
    const char *kept; /* for magcomp_compensator_adopt of the next launch */
    if (magcomp_compensator_keep(compensator, time(NULL), &kept) == MAGCOMP_ERROR_NONE) fprintf(stderr, "%s\n", kept);
    magcomp_compensator_free(compensator);
    return 0;
}

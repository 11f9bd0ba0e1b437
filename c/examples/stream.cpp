#include <cstdio>
#include <ctime>
#include <iostream>
#include <magcomp.hpp>

// Lines on stdin: m (magnetometer, uT), g (gyroscope, rad/s) or a (accelerometer, m/s^2), the time in ns, x, y, z.
int main() try {
    magcomp::Config config;
    config.declination_deg = 2.5;
    magcomp::Compensator compensator(config);
    char sensor;
    std::int64_t time_ns;
    double x, y, z;
    while (std::cin >> sensor >> time_ns >> x >> y >> z) {
        if (sensor == 'g') compensator.push_rotation_rate(time_ns, x, y, z);
        if (sensor == 'a') compensator.push_up(time_ns, x, y, z);
        if (sensor != 'm') continue;
        const auto reading = compensator.push(time_ns, x, y, z);
        // NaN until there is a heading; the text says what is missing
        std::printf("%.2f +- %.2f deg, %s\n", reading.true_heading_deg, reading.heading_sigma_deg, compensator.status_text().c_str());
    }
    if (const auto kept = compensator.keep(std::time(nullptr))) std::cerr << *kept << '\n'; // for adopt of the next launch
} catch (const magcomp::Error &error) {
    std::cerr << error.what() << '\n';
    return 1;
}

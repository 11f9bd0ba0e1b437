// magcomp.hpp: errors are exceptions, what is not there is no value, objects move; threads.
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <magcomp.hpp>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

void check(bool is_so, int line) {
    if (is_so) return;
    std::cerr << "borders.cpp:" << line << ": not so\n";
    std::exit(1);
}

template <typename Action> void refuses(magcomp_error code, const std::string &says, int line, Action action) {
    try {
        action();
    } catch (const magcomp::Error &error) {
        if (error.code() == code && std::string(error.what()).find(says) != std::string::npos) return;
        std::cerr << error.code() << ' ' << error.what() << '\n';
    }
    check(false, line);
}

constexpr std::int64_t step_ns = 10'000'000;

static_assert(!std::is_copy_constructible_v<magcomp::Compensator> && std::is_nothrow_move_constructible_v<magcomp::Compensator>);

void borders() {
    using magcomp::Compensator;
    refuses(MAGCOMP_ERROR_CONFIG, "unknown field `rail`", __LINE__, [] { Compensator(R"({"rail": 3})"); });
    magcomp::Config config;
    check(config.range_ut == 2000 && std::isnan(config.declination_deg), __LINE__);
    config.declination_deg = 400;
    refuses(MAGCOMP_ERROR_CONFIG, "declination_deg", __LINE__, [&] { Compensator{config}; });
    refuses(MAGCOMP_ERROR_CONFIG, "declination_deg", __LINE__, [&] { Compensator().set_heading(config); });
    config.declination_deg = 4;
    Compensator{config}.set_heading(config);
    Compensator first;
    check(!first.calibration() && !first.keep(0) && first.status_text().empty(), __LINE__);
    check(first.push(0, 20, 0, 40).status == MAGCOMP_STATUS_COLLECTING, __LINE__);
    check(first.push_up(step_ns, 0, 0, 9.81) && !first.push_up(step_ns, 0, 0, 9.81), __LINE__);
    check(first.push_heading(step_ns, 90, 5, MAGCOMP_NORTH_TRUE) && !first.push_heading(step_ns, 90, 5, MAGCOMP_NORTH_TRUE, {{0, 1, 0}}), __LINE__);
    check(first.push_attitude(step_ns, {1, 0, 0, 0}) && !first.push_attitude(step_ns, {0, 0, 0, 0}), __LINE__);
    refuses(MAGCOMP_ERROR_CONFIG, "NORTH_NONE", __LINE__, [&] { first.push_heading(step_ns, 90, 5, MAGCOMP_NORTH_NONE); });
    check(first.heading_aid() == MAGCOMP_HEADING_AID_NONE && !first.found_declination(), __LINE__);
    check(!first.push_up(step_ns, 0, 0, 9.81), __LINE__);
    check(first.last_error().find("same time") != std::string::npos, __LINE__);
    check(first.push_rotation_rate(step_ns, 0, 0, 1) && !first.push_rotation_rate(2 * step_ns, 0, 0, 1e9), __LINE__);
    refuses(MAGCOMP_ERROR_CONFIG, "hidden_s", __LINE__, [&] { first.push_gap(-1); });
    refuses(MAGCOMP_ERROR_CONFIG, "`Left`", __LINE__, [&] { first.set_heading(R"({"axis": "Left"})"); });
    refuses(MAGCOMP_ERROR_KEPT_DAMAGED, "damaged", __LINE__, [&] { first.adopt("{}"); });
    magcomp_calibration given{0, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {20, -30, 40}, 50};
    first.adopt(given, 2);
    check(first.calibration().value().hard_iron_ut[1] == -30, __LINE__);
    given.field_strength_ut = 0;
    refuses(MAGCOMP_ERROR_CALIBRATION, "field strength", __LINE__, [&] { first.adopt(given, 2); });

    std::vector<std::array<double, 3>> points;
    refuses(MAGCOMP_ERROR_FIT, "too few", __LINE__, [&] { magcomp::fit_ellipsoid(points); });
    for (int k = 0; k < 200; k++) {
        const double up = 1 - (2 * k + 1) / 200.0, across = std::sqrt(1 - up * up);
        points.push_back({48 * across * std::cos(2.4 * k) + 20, 48 * across * std::sin(2.4 * k) - 30, 48 * up + 40});
    }
    const magcomp::EllipsoidFit fit = magcomp::fit_ellipsoid(points, 48);
    check(std::abs(fit.calibration.hard_iron_ut[1] + 30) < 1e-6 && fit.fit.residual_rms_ut < 1e-6, __LINE__);
    check(!Compensator().covariance(), __LINE__);

    Compensator second = std::move(first);
    check(second.calibration().has_value(), __LINE__);
    refuses(MAGCOMP_ERROR_NULL_POINTER, "compensator", __LINE__, [&] { first.push(0, 1, 2, 3); });
    second.reset();
    check(!second.calibration(), __LINE__);
}

// Each thread's message of create is its own; calls with one compensator wait for each other.
void threads() {
    magcomp::Compensator shared;
    std::vector<std::thread> running;
    for (int k = 0; k < 4; k++) {
        running.emplace_back([&shared, k] {
            magcomp_compensator *none;
            const std::string config = "{\"thread_" + std::to_string(k) + "\": 1}";
            for (int round = 0; round < 300; round++) {
                check(magcomp_compensator_create(config.c_str(), &none) == MAGCOMP_ERROR_CONFIG, __LINE__);
                check(std::string(magcomp_compensator_last_error(nullptr)).find("thread_" + std::to_string(k)) != std::string::npos, __LINE__);
                // times of the threads do not agree: most are rejected, none breaks anything
                (void)shared.push_up(round * step_ns, 0, 0, 9.81);
                (void)shared.push(round * step_ns, 20 + round % 7, round % 5, 40);
            }
        });
    }
    for (auto &thread : running) thread.join();
    check(shared.push(1000 * step_ns, 20, 0, 40).status != MAGCOMP_STATUS_REJECTED, __LINE__);
}

} // namespace

int main() {
    borders();
    threads();
}

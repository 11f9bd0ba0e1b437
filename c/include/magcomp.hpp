// magcomp for C++17: what magcomp.h has, freed by itself, with errors as exceptions. Units, ranges and threads are those of magcomp.h.
#ifndef MAGCOMP_HPP
#define MAGCOMP_HPP

#include "magcomp.h"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace magcomp {

// What a call refuses; what() is the message.
class Error : public std::runtime_error {
public:
    Error(magcomp_error code, const char *message) : std::runtime_error(message), code_(code) {}
    magcomp_error code() const noexcept { return code_; }

private:
    magcomp_error code_;
};

// Settings, each its default until it is set: see magcomp_config. A number that is not known is NaN.
struct Config : magcomp_config {
    Config() noexcept : magcomp_config{} {
        size = sizeof(magcomp_config);
        (void)magcomp_config_default(this);
    }
};

// Finds M and b from a stream of samples, again whenever they change. It can be moved, not copied; one that was moved from refuses every call. Every member
// may throw Error.
class Compensator {
public:
    // All settings their default; those of a Config; or those of a JSON text: see magcomp_compensator_create.
    Compensator() : Compensator(Config()) {}
    explicit Compensator(const Config &config) {
        magcomp_compensator *made = nullptr;
        check(magcomp_compensator_create_with(&config, &made));
        owned_.reset(made);
    }
    explicit Compensator(const std::string &config_json) {
        magcomp_compensator *made = nullptr;
        check(magcomp_compensator_create(config_json.c_str(), &made));
        owned_.reset(made);
    }

    // Begins anew with the same settings.
    void reset() { check(magcomp_compensator_reset(get())); }

    // From now on headings are reported like this: see magcomp_compensator_set_heading_with, magcomp_compensator_set_heading.
    void set_heading(const Config &config) { check(magcomp_compensator_set_heading_with(get(), &config)); }
    void set_heading(const std::string &heading_json) { check(magcomp_compensator_set_heading(get(), heading_json.c_str())); }

    // A raw magnetic sample, uT. One that cannot be used is no error: its reading has MAGCOMP_STATUS_REJECTED.
    magcomp_reading push(std::int64_t time_ns, double x_ut, double y_ut, double z_ut) {
        magcomp_reading reading{};
        reading.size = sizeof reading;
        check(magcomp_compensator_push(get(), time_ns, x_ut, y_ut, z_ut, &reading));
        return reading;
    }

    // A gyroscope's event, rad/s, before the magnetic sample that follows it. Whether it was used; one that was left out does no harm now and then.
    bool push_rotation_rate(std::int64_t time_ns, double x_rad_s, double y_rad_s, double z_rad_s) {
        return used(magcomp_compensator_push_rotation_rate(get(), time_ns, x_rad_s, y_rad_s, z_rad_s));
    }

    // An accelerometer's or gravity event, m/s^2, up at rest. Whether it was used.
    bool push_up(std::int64_t time_ns, double x_m_s2, double y_m_s2, double z_m_s2) {
        return used(magcomp_compensator_push_up(get(), time_ns, x_m_s2, y_m_s2, z_m_s2));
    }

    // A heading from outside, such as a GNSS course: see magcomp_compensator_push_heading. `axis` is what points there, device axes; none: the vehicle.
    // Whether it was taken.
    bool push_heading(std::int64_t time_ns, double heading_deg, double sigma_deg, magcomp_north reference,
                      const std::optional<std::array<double, 3>> &axis = std::nullopt) {
        const double *const pointing = axis ? axis->data() : nullptr;
        return used(magcomp_compensator_push_heading(get(), time_ns, heading_deg, sigma_deg, reference, pointing));
    }

    // An orientation from outside, w, x, y, z: see magcomp_compensator_push_attitude. Whether it was taken.
    bool push_attitude(std::int64_t time_ns, const std::array<double, 4> &to_world, magcomp_north reference = MAGCOMP_NORTH_NONE,
                       double sigma_deg = 0) {
        const auto &[w, x, y, z] = to_world;
        return used(magcomp_compensator_push_attitude(get(), time_ns, w, x, y, z, reference, sigma_deg));
    }

    // What headings from outside are worth after the latest sample.
    magcomp_heading_aid heading_aid() const noexcept { return magcomp_compensator_heading_aid(get()); }

    // The declination that headings from true north have shown, and its standard deviation, deg; nothing before one was used, or while one is set.
    std::optional<std::pair<double, double>> found_declination() const {
        std::pair<double, double> found;
        if (is_there(magcomp_compensator_found_declination(get(), &found.first, &found.second))) return found;
        return std::nullopt;
    }

    // The covariance of b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz, row by row; nothing before there is a calibration.
    std::optional<std::array<double, 81>> covariance() const {
        std::array<double, 81> covariance;
        if (is_there(magcomp_compensator_covariance(get(), covariance.data()))) return covariance;
        return std::nullopt;
    }

    // So many seconds passed that the samples' clock does not show.
    void push_gap(double hidden_s) { check(magcomp_compensator_push_gap(get(), hidden_s)); }

    // The status of the latest reading as a sentence.
    std::string status_text() const { return magcomp_compensator_status_text(get()); }

    // The message of the latest call that failed, also where it is no exception: an event that was left out.
    std::string last_error() const { return magcomp_compensator_last_error(get()); }

    // M, b and |h| in force; nothing before there is one.
    std::optional<magcomp_calibration> calibration() const {
        magcomp_calibration calibration{};
        calibration.size = sizeof calibration;
        if (is_there(magcomp_compensator_calibration(get(), &calibration))) return calibration;
        return std::nullopt;
    }

    // From now on this calibration is in force, until something better is learned. Its `size` need not be set.
    void adopt(magcomp_calibration calibration, double hard_iron_sigma_ut) {
        calibration.size = sizeof calibration;
        check(magcomp_compensator_adopt_calibration(get(), &calibration, hard_iron_sigma_ut));
    }

    // What was learned, as a text for the next launch; nothing before anything was. `unix_time_s` is now, seconds since 1970.
    std::optional<std::string> keep(std::int64_t unix_time_s) const {
        const char *kept = nullptr;
        if (is_there(magcomp_compensator_keep(get(), unix_time_s, &kept))) return kept;
        return std::nullopt;
    }

    // Begins with a text of keep, as sure as its age makes it.
    void adopt(const std::string &kept_json, std::int64_t unix_time_s = MAGCOMP_TIME_UNKNOWN) {
        check(magcomp_compensator_adopt(get(), kept_json.c_str(), unix_time_s));
    }

    // For functions of magcomp.h. It stays this object's.
    magcomp_compensator *get() const noexcept { return owned_.get(); }

private:
    struct Free {
        void operator()(magcomp_compensator *compensator) const noexcept { magcomp_compensator_free(compensator); }
    };
    std::unique_ptr<magcomp_compensator, Free> owned_;

    void check(magcomp_error code) const {
        if (code != MAGCOMP_ERROR_NONE) throw Error(code, magcomp_compensator_last_error(get()));
    }

    bool is_there(magcomp_error code) const {
        if (code == MAGCOMP_ERROR_NOTHING_YET) return false;
        check(code);
        return true;
    }

    bool used(magcomp_error code) const {
        if (code >= MAGCOMP_ERROR_EVENT_NOT_FINITE && code <= MAGCOMP_ERROR_EVENT_AHEAD) return false;
        check(code);
        return true;
    }
};

// A fit of raw samples, and how sure it is.
struct EllipsoidFit {
    magcomp_calibration calibration;
    magcomp_fit fit;
};

// One fit of raw samples of a turned device, uT. `field_strength_ut` is |h| where it is known. May throw Error.
inline EllipsoidFit fit_ellipsoid(const std::vector<std::array<double, 3>> &points_ut,
                                  double field_strength_ut = std::numeric_limits<double>::quiet_NaN()) {
    static_assert(sizeof(std::array<double, 3>) == 3 * sizeof(double), "rows of three numbers");
    EllipsoidFit found{};
    found.calibration.size = sizeof found.calibration;
    found.fit.size = sizeof found.fit;
    const double nothing = 0;
    const double *const first = points_ut.empty() ? &nothing : points_ut.front().data();
    const magcomp_error code = magcomp_fit_ellipsoid(first, points_ut.size(), field_strength_ut, &found.calibration, &found.fit);
    if (code != MAGCOMP_ERROR_NONE) throw Error(code, magcomp_compensator_last_error(nullptr));
    return found;
}

} // namespace magcomp

#endif

// magcomp: frees a magnetometer from the magnetic disturbance that its device carries, sample by sample. C99 and C++17; magcomp.hpp wraps it for C++.
// Written from the Rust sources by cbindgen (c/src/tests.rs): never edit it.
//
// Units: microtesla (ut), rad/s, m/s^2, degrees, nanoseconds (ns) of one clock. Device axes: x right, y up along the screen, z out of it; for a board:
// any right-handed frame that all three sensors share, headings being those of its y axis.
//
// Numbers that are not known are NaN, in every struct; cases that are not known have a NONE.
//
// Structs begin with `size`, which the caller sets to sizeof before each call. A later version of the library appends members: it serves callers that know
// fewer, and an older one sets `size` to the bytes that it filled.
//
// Errors: a function that can fail returns a magcomp_error; above MAGCOMP_ERROR_NONE it changed nothing, but for MAGCOMP_ERROR_PANICKED.
// magcomp_compensator_last_error has the message. Each function's comment ends with the errors that it returns, without their MAGCOMP_ERROR_.
// A magnetic sample that cannot be used is no error: its reading has MAGCOMP_STATUS_REJECTED.
//
// Threads: any thread may call. Two calls with one compensator wait for each other; compensators do not wait for one another. A text that the library
// returns is the compensator's: it is good until the next call that makes the same kind of text, so threads that share a compensator lock around call and
// text. Nobody may use a compensator while or after it is freed.
//
// Every text is UTF-8 and ends with a zero byte. To push a sample or event that is not refused allocates no memory.


#ifndef MAGCOMP_H
#define MAGCOMP_H

#include <stddef.h>
#include <stdint.h>

// The time since 1970 is not known: it is before all.
#define MAGCOMP_TIME_UNKNOWN INT64_MIN

// The version that a program is compiled for; magcomp_version() has that of the library which it runs with.
#define MAGCOMP_VERSION_MAJOR 0

// Its second number. Before 1.0 another one may be another ABI.
#define MAGCOMP_VERSION_MINOR 1

// Its third number.
#define MAGCOMP_VERSION_PATCH 0

// Whether a call did what it is for, and why not.
enum magcomp_error
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It did.
  MAGCOMP_ERROR_NONE = 0,
  // A pointer that must not be null is null.
  MAGCOMP_ERROR_NULL_POINTER = 1,
  // The `size` of a struct is not set, or smaller than any version's.
  MAGCOMP_ERROR_SIZE = 2,
  // A setting, or a number beside it, is unknown or outside its range; or a text is no JSON, or not UTF-8.
  MAGCOMP_ERROR_CONFIG = 3,
  // M, b and |h| are none that a calibration can have.
  MAGCOMP_ERROR_CALIBRATION = 4,
  // A text is no kept calibration. Start without it.
  MAGCOMP_ERROR_KEPT_DAMAGED = 5,
  // A kept calibration was written by a newer version. Update the library, or start without.
  MAGCOMP_ERROR_KEPT_NEWER = 6,
  // There is nothing to hand out yet: nothing was learned.
  MAGCOMP_ERROR_NOTHING_YET = 7,
  // A panic was caught: a fault of the library. The compensator refuses every call but reset, free and those for its texts.
  MAGCOMP_ERROR_PANICKED = 8,
  // An event beside the magnetic samples has a number that is NaN or infinite.
  MAGCOMP_ERROR_EVENT_NOT_FINITE = 9,
  // Such an event is beyond anything a sensor reads: 60 rad/s, 200 m/s^2; or beyond what its function takes.
  MAGCOMP_ERROR_EVENT_OUT_OF_RANGE = 10,
  // Such an event is at or before a magnetic sample that was pushed. A heading: more than 5 s so, or not after the latest that was used.
  MAGCOMP_ERROR_EVENT_LATE = 11,
  // Such an event has the time of another.
  MAGCOMP_ERROR_EVENT_DUPLICATE = 12,
  // Such an event is so far ahead of the magnetic samples that its clock must be another.
  MAGCOMP_ERROR_EVENT_AHEAD = 13,
  // No ellipsoid fits these samples.
  MAGCOMP_ERROR_FIT = 14,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_error magcomp_error;
#else
typedef int32_t magcomp_error;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What the compensator is doing.
enum magcomp_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // There is no calibration yet. `reason` says why.
  MAGCOMP_STATUS_COLLECTING = 0,
  // Calibrated, and following changes.
  MAGCOMP_STATUS_TRACKING = 1,
  // Something changed; it is not yet decided whether the device or the place.
  MAGCOMP_STATUS_SUSPECT = 2,
  // Calibrated, but not learning: the calibration is kept. `reason` says why.
  MAGCOMP_STATUS_HELD = 3,
  // The place is disturbed, not the device: the calibration is kept, and after 30 s learned on in the field of that place.
  MAGCOMP_STATUS_DISTURBED = 4,
  // This sample was not used, and changed nothing; 50 in a row that agree on another clock begin that clock. `reason` says why.
  MAGCOMP_STATUS_REJECTED = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_status magcomp_status;
#else
typedef int32_t magcomp_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Why the status is what it is.
enum magcomp_reason
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The status says it all.
  MAGCOMP_REASON_NONE = 0,
  // Collecting: too few samples for a first fit.
  MAGCOMP_REASON_SAMPLES = 1,
  // Collecting: the device was hardly turned.
  MAGCOMP_REASON_ROTATION = 2,
  // Collecting: the device was turned, but not about enough axes.
  MAGCOMP_REASON_DIRECTIONS = 3,
  // Collecting: the samples allow no fit; the problem is named. See `fit_problem`.
  MAGCOMP_REASON_FIT = 4,
  // Held: the device lies still; nothing is learned from that.
  MAGCOMP_REASON_AT_REST = 5,
  // Held: the device was hardly turned of late.
  MAGCOMP_REASON_TOO_LITTLE_ROTATION = 6,
  // Held: method `Windowed` alone: sigma_T is below its threshold, the latest orientations are too much alike.
  MAGCOMP_REASON_LOW_UNIFORMITY = 7,
  // Held: the latest fit was refused, or no place on Earth has such a field; the problem is named. Is the sensor's unit microtesla? See `fit_problem`.
  MAGCOMP_REASON_FIT_REFUSED = 8,
  // Held: the gyroscope is gone or reads nonsense; the magnetometer alone takes over within a second, but with method `Aided`, which waits.
  MAGCOMP_REASON_NO_GYROSCOPE = 9,
  // Held: method `Constant` alone: by choice it follows no changes.
  MAGCOMP_REASON_CONSTANT = 10,
  // Rejected: a component is NaN or infinite. Check where the samples come from.
  MAGCOMP_REASON_NOT_FINITE = 11,
  // Rejected: a component is beyond the setting `range_ut`. Is the unit microtesla?
  MAGCOMP_REASON_OUT_OF_RANGE = 12,
  // Rejected: a component is at the sensor's full scale, the setting `rail_ut` or as found: the true field is larger.
  MAGCOMP_REASON_SATURATED = 13,
  // Rejected: time did not advance.
  MAGCOMP_REASON_TIME_NOT_AFTER = 14,
  // Rejected: time jumped ahead further than any pause. Is the unit nanoseconds?
  MAGCOMP_REASON_TIME_JUMP = 15,
  // Rejected: the same value to the last bit while the device turns, or where neither gyroscope nor accelerometer tells that it rests: the sensor hangs.
  MAGCOMP_REASON_STUCK = 16,
  // Rejected: the field turns as if the magnetometer had other axes than the gyroscope; the text says which. Asked again with every turn. Give both sensors the same axes.
  MAGCOMP_REASON_AXES = 17,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_reason magcomp_reason;
#else
typedef int32_t magcomp_reason;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Why there is no ellipsoid to report.
enum magcomp_fit_problem
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // `reason` is about no fit.
  MAGCOMP_FIT_PROBLEM_NONE = 0,
  // Fewer samples than the nine parameters.
  MAGCOMP_FIT_PROBLEM_TOO_FEW_SAMPLES = 1,
  // All samples lie near one plane.
  MAGCOMP_FIT_PROBLEM_PLANAR = 2,
  // The directions seen leave too large an error.
  MAGCOMP_FIT_PROBLEM_POOR_COVERAGE = 3,
  // The samples do not lie on one ellipsoid: the disturbance or the place changed meanwhile.
  MAGCOMP_FIT_PROBLEM_INCONSISTENT = 4,
  // A surface that is no ellipsoid fits best.
  MAGCOMP_FIT_PROBLEM_NOT_AN_ELLIPSOID = 5,
  // The field is too weak or too strong to be the Earth's. Is the unit microtesla?
  MAGCOMP_FIT_PROBLEM_FIELD_OUT_OF_RANGE = 6,
  // A sample was NaN or infinite, or the numbers overflowed. Leave such values out.
  MAGCOMP_FIT_PROBLEM_NOT_FINITE = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_fit_problem magcomp_fit_problem;
#else
typedef int32_t magcomp_fit_problem;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What changed.
enum magcomp_event
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // None yet.
  MAGCOMP_EVENT_NONE = 0,
  // The device's own disturbance changed (a magnet or cover was put on or taken off), and was relearned.
  MAGCOMP_EVENT_DEVICE_STEP = 1,
  // The device is as it was before; that calibration was restored.
  MAGCOMP_EVENT_DEVICE_STEP_BACK = 2,
  // The field of the place changed; the calibration is held.
  MAGCOMP_EVENT_PLACE_CHANGED = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_event magcomp_event;
#else
typedef int32_t magcomp_event;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The sensors the estimator runs on, as they come and go.
enum magcomp_mode
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Gyroscope and accelerometer beside the magnetometer: everything works.
  MAGCOMP_MODE_GYROSCOPE_AND_GRAVITY = 0,
  // No accelerometer: the field is corrected and carried, there is no heading.
  MAGCOMP_MODE_GYROSCOPE_ONLY = 1,
  // No usable gyroscope: changes are followed slower.
  MAGCOMP_MODE_GRAVITY_ONLY = 2,
  // Neither: changes are followed slower, and there is no heading.
  MAGCOMP_MODE_MAGNETOMETER_ONLY = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_mode magcomp_mode;
#else
typedef int32_t magcomp_mode;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Which of the nine parameters a change set free.
enum magcomp_model_order
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The estimator does not tell.
  MAGCOMP_MODEL_ORDER_NONE = 0,
  // None: all nine stay.
  MAGCOMP_MODEL_ORDER_NOTHING = 1,
  // Hard iron alone.
  MAGCOMP_MODEL_ORDER_HARD_IRON = 2,
  // All nine.
  MAGCOMP_MODEL_ORDER_ALL = 3,
  // Back to a calibration from before.
  MAGCOMP_MODEL_ORDER_FORMER = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_model_order magcomp_model_order;
#else
typedef int32_t magcomp_model_order;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What headings from outside are worth.
enum magcomp_heading_aid
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // None came in the last two minutes.
  MAGCOMP_HEADING_AID_NONE = 0,
  // They agree with the magnetometer, which knows north at least as well by itself.
  MAGCOMP_HEADING_AID_USED = 1,
  // North is what they say, carried by the gyroscope: the magnetometer knows it less well.
  MAGCOMP_HEADING_AID_LEADS = 2,
  // The latest one contradicts what is known, and is ignored.
  MAGCOMP_HEADING_AID_DISAGREES = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_heading_aid magcomp_heading_aid;
#else
typedef int32_t magcomp_heading_aid;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What a direction from outside counts from.
enum magcomp_north
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Not north: the y axis of an outside world points anywhere, and stays.
  MAGCOMP_NORTH_NONE = 0,
  // True north, as of maps and GNSS. While no declination is set it is learned from these headings.
  MAGCOMP_NORTH_TRUE = 1,
  // Magnetic north.
  MAGCOMP_NORTH_MAGNETIC = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_north magcomp_north;
#else
typedef int32_t magcomp_north;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How the hard and soft iron are estimated.
enum magcomp_method
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Gyroscope and gravity beside the magnetometer; works as `Adaptive` while there is no usable gyroscope.
  MAGCOMP_METHOD_AUTO = 0,
  // The magnetometer alone: notices changes, and relearns them as fast as the samples allow.
  MAGCOMP_METHOD_ADAPTIVE = 1,
  // The paper's: an ellipsoid fit over the latest samples, whose number follows sigma_T.
  MAGCOMP_METHOD_WINDOWED = 2,
  // The first step of the paper's method alone: one fit of the first well spread samples, kept from then on.
  MAGCOMP_METHOD_CONSTANT = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_method magcomp_method;
#else
typedef int32_t magcomp_method;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The axis of the device whose heading is reported.
enum magcomp_axis
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Top edge of the screen, +y.
  MAGCOMP_AXIS_TOP_EDGE = 0,
  // Back camera, -z.
  MAGCOMP_AXIS_CAMERA = 1,
  // The horizontal direction between top edge and camera: no flip when the phone passes upright.
  MAGCOMP_AXIS_AUTO = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum magcomp_axis magcomp_axis;
#else
typedef int32_t magcomp_axis;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Finds M and b from a stream of samples, again whenever they change. magcomp_compensator_create makes one.
typedef struct magcomp_compensator magcomp_compensator;

// The answer to one magnetic sample. Numbers that are not known are NaN.
typedef struct magcomp_reading {
  // sizeof(magcomp_reading).
  size_t size;
  // Time of the sample, ns.
  int64_t time_ns;
  // The corrected sample M^-1 (h_m - b), uT, device axes.
  double field_ut[3];
  // The estimator's own, smoother estimate of it, uT; the heading comes from it.
  double filtered_field_ut[3];
  // One standard deviation of `field_ut` per axis, uT.
  double field_sigma_ut;
  // |field_ut|, uT.
  double total_field_ut;
  // Clockwise from magnetic north, 0 to 360 deg, of the axis that the setting `heading.axis` names.
  double heading_deg;
  // One standard deviation of `heading_deg`, 0 to 180 deg.
  double heading_sigma_deg;
  // Clockwise from true north, 0 to 360 deg; where the setting `heading.declination_deg` is.
  double true_heading_deg;
  // Angle of the field below the horizon, -90 to 90 deg; where a field is known: a north from outside needs none.
  double inclination_deg;
  // The unit quaternion w, x, y, z that takes device axes to east, north (magnetic) and up; w is at least 0.
  double attitude[4];
  // Root of the sum of the variances of the attitude's error about three axes, 0 to 180 deg.
  double attitude_sigma_deg;
  // sigma_T, no unit: how evenly the latest directions are spread.
  double sigma_t;
  // Share of the directions that were seen of late, 0 to 1.
  double coverage;
  // Expected direction error of the calibration over all directions, 0 to 180 deg.
  double direction_sigma_deg;
  // The same for the one combination of parameters that is known worst, deg; without a gyroscope only.
  double worst_sigma_deg;
  // Samples that the estimator looks at.
  uint64_t window;
  // Of SUSPECT and DISTURBED: time of the first sample that did not fit, ns; else 0.
  int64_t status_since_ns;
  // Of the latest event: time of the first sample that did not fit any longer, ns; 0 where there is none.
  int64_t event_since_ns;
  // Of the latest event: when it was decided, ns; 0 where there is none.
  int64_t event_decided_ns;
  // What the compensator is doing.
  magcomp_status status;
  // Why.
  magcomp_reason reason;
  // Of FIT and FIT_REFUSED.
  magcomp_fit_problem fit_problem;
  // The latest change that was decided; it stays until the next.
  magcomp_event event;
  // The sensors that the estimator runs on.
  magcomp_mode mode;
  // Which parameters the latest change set free; without a gyroscope only.
  magcomp_model_order model_order;
} magcomp_reading;

// h_m = M h + b: what a magnetometer reads, h_m, of the Earth's field h.
typedef struct magcomp_calibration {
  // sizeof(magcomp_calibration).
  size_t size;
  // Soft iron M, no unit, row by row: symmetric, positive definite, no element of it or of its inverse beyond +-1000.
  double soft_iron[9];
  // Hard iron b, uT, -100000 to 100000.
  double hard_iron_ut[3];
  // |h|, uT, 1 to 1000.
  double field_strength_ut;
} magcomp_calibration;

// Settings. magcomp_config_default fills in the defaults; change what is to differ. As text, for magcomp_compensator_create, they have
// these names; those of a heading are in {"heading": {}}, those of the paper's method in {"windowed": {}}. What differs, and what is there alone:
//
// - method: One of "Auto", "Aided", "Adaptive", "Windowed", "Constant".
// - initial: A calibration to begin with, from elsewhere; that of the last launch is for `adopt_kept`. Default none. {"soft_iron": [9 numbers], "hard_iron_ut": [3 numbers], "field_strength_ut": |h|}
// - initial_sigma_ut: One standard deviation of each component of `initial`'s hard iron, microtesla, 0.01 to 1000. Default 2; larger makes the first headings less sure, and learning faster.
// - heading.axis: One of "TopEdge", "Camera", "Auto".
// - heading.screen_rotation: One of "Deg0", "Deg90", "Deg180", "Deg270".
// - windowed.n_min: N_min, samples, 9 to N_max: the shortest window, and what sigma_T looks at. Default 100; smaller follows changes sooner with more noise.
// - windowed.n_max: N_max, samples, at most 100 000: the longest window. Default 2000; larger is steadier under poor motion and slower to forget.
// - windowed.sigma_th: sigma_th, dimensionless, 0 to 10: below it nothing is updated. Default 0.1.
// - windowed.normalisation: How the standard deviations in sigma_T are normalised. Default `HalfRange`. One of "HalfRange", "EvenSphere".
// - windowed.residual: The residual that fits square and sum. Default `Corrected`. `Algebraic` follows the paper as written: a window is fitted however far its samples lie from one ellipsoid. One of "Algebraic", "Corrected".
// - windowed.noise_floor_ut: Least white noise, microtesla per axis, 0 to 1000, for which a fit is judged. Default 5; smaller accepts poorer coverage where the residual is small.
typedef struct magcomp_config {
  // sizeof(magcomp_config).
  size_t size;
  // A magcomp_method. How the hard and soft iron are estimated. Default MAGCOMP_METHOD_AUTO.
  int32_t method;
  // A magcomp_axis. The axis whose heading it is. Default MAGCOMP_AXIS_TOP_EDGE.
  int32_t axis;
  // How the screen's content is turned against the device. Default 0, not at all. One of 0, 90, 180, 270.
  int32_t screen_rotation_deg;
  // Largest component of a raw sample, microtesla, 1 to 100 000; a larger one is rejected. Default 2000; larger accepts stronger magnets.
  double range_ut;
  // The magnetometer's full scale, microtesla (Android: `Sensor.getMaximumRange`). A component at or beyond it is rejected as saturated. 1 to 100 000. Default NaN: it is found once an axis has read the same extreme again and again in motion.
  double rail_ut;
  // The field's strength, microtesla, 1 to 1000, where it is known (the geomagnetic model gives it): then the soft iron carries the sensor's scale. Every method listens to it. Default NaN: found by the method.
  double field_strength_ut;
  // Declination, degrees, east positive, -180 to 180: gives `true_heading_deg`. Default NaN.
  double declination_deg;
  // Standard deviation of `up` at rest, degrees, 0 to 90, for `heading_sigma_deg`; what motion adds to gravity comes on top. Default 0.5.
  double tilt_sigma_deg;
} magcomp_config;

// How sure a fit is.
typedef struct magcomp_fit {
  // sizeof(magcomp_fit).
  size_t size;
  // Of b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz (no unit), row by row.
  double covariance[81];
  // Root mean square distance of the samples from the ellipsoid, uT.
  double residual_rms_ut;
  // Expected direction error over all directions, deg.
  double direction_sigma_deg;
  // Why there is no fit. None where there is one.
  magcomp_fit_problem problem;
} magcomp_fit;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The library's version, such as 0.1.0.
const char *magcomp_version(void);

// Makes a compensator, with everything that it will ever need, and puts it into `compensator`; free it with magcomp_compensator_free.
// magcomp_compensator_create_with takes the settings as a struct.
//
// `config_json` has the settings that are not to be the default, such as {"rail_ut": 1200, "heading": {"declination_deg": 2.5}}; null: all are.
// magcomp_config lists them.
//
// Errors: NULL_POINTER (`compensator`); CONFIG. `*compensator` is null then, and magcomp_compensator_last_error(NULL) has this thread's message.
magcomp_error magcomp_compensator_create(const char *config_json,
                                         struct magcomp_compensator **compensator);

// Frees a compensator and its texts. Null is left alone.
void magcomp_compensator_free(struct magcomp_compensator *compensator);

// The message of the latest call with this compensator that failed, in English; of null: of the latest call of this thread that failed without one, as
// create does. Empty before the first. Never null. Good until the next such call fails.
const char *magcomp_compensator_last_error(const struct magcomp_compensator *compensator);

// Begins anew with the same settings, also after a panic: what was learned and adopted is forgotten. Errors: NULL_POINTER.
magcomp_error magcomp_compensator_reset(struct magcomp_compensator *compensator);

// From now on headings are reported like this; nothing else changes. `heading_json` has the settings that are not to be the default; null: all are.
// They are those of magcomp_config's `heading`.
//
// Errors: NULL_POINTER (`compensator`); CONFIG.
magcomp_error magcomp_compensator_set_heading(struct magcomp_compensator *compensator,
                                              const char *heading_json);

// A raw magnetic sample, uT, device axes; its time, ns, is after that of the sample before. Fills `reading`, whose size is set.
//
// Errors: NULL_POINTER (both); SIZE. A sample that cannot be used (NaN, out of range, time going backwards) is no error: see MAGCOMP_STATUS_REJECTED.
magcomp_error magcomp_compensator_push(struct magcomp_compensator *compensator,
                                       int64_t time_ns,
                                       double x_ut,
                                       double y_ut,
                                       double z_ut,
                                       struct magcomp_reading *reading);

// A gyroscope's event, rad/s, device axes, counter-clockwise positive, at its own rate; its time, ns, is of the magnetic samples' clock. Push it before
// the magnetic sample that follows it.
//
// Errors: NULL_POINTER; EVENT_NOT_FINITE, EVENT_OUT_OF_RANGE, EVENT_LATE, EVENT_DUPLICATE, EVENT_AHEAD: the event is left out, which does no harm now
// and then.
magcomp_error magcomp_compensator_push_rotation_rate(struct magcomp_compensator *compensator,
                                                     int64_t time_ns,
                                                     double x_rad_s,
                                                     double y_rad_s,
                                                     double z_rad_s);

// An accelerometer's or gravity event, m/s^2, device axes: what an accelerometer at rest reads, which points up (+9.81 along z when flat). Else as
// magcomp_compensator_push_rotation_rate.
magcomp_error magcomp_compensator_push_up(struct magcomp_compensator *compensator,
                                          int64_t time_ns,
                                          double x_m_s2,
                                          double y_m_s2,
                                          double z_m_s2);

// About so many seconds passed, 0 to 1e9, that the samples' clock does not show: the system slept. The calibration is as unsure as one that was kept for
// so long. Errors: NULL_POINTER; CONFIG.
magcomp_error magcomp_compensator_push_gap(struct magcomp_compensator *compensator,
                                           double hidden_s);

// The status of the latest reading as one English sentence with its numbers, such as "collecting: turn the device about more axes". Empty before the
// first, and of null. Never null. Good until the next call of this function.
const char *magcomp_compensator_status_text(const struct magcomp_compensator *compensator);

// M, b and |h| in force. Fills `calibration`, whose size is set.
//
// Errors: NULL_POINTER (both); SIZE; NOTHING_YET.
magcomp_error magcomp_compensator_calibration(const struct magcomp_compensator *compensator, struct magcomp_calibration *calibration);

// From now on this calibration is in force, until something better is learned. `hard_iron_sigma_ut` is one standard deviation of each component of b, 0.01
// to 1000 uT. Live samples judge it first: the status is MAGCOMP_STATUS_HELD until a turned device agrees.
//
// Errors: NULL_POINTER (both); SIZE; CALIBRATION; CONFIG (`hard_iron_sigma_ut`).
magcomp_error magcomp_compensator_adopt_calibration(struct magcomp_compensator *compensator,
                                                    const struct magcomp_calibration *calibration,
                                                    double hard_iron_sigma_ut);

// What was learned, with its covariance and age, as one line of JSON to be kept for the next launch. `unix_time_s` is now, seconds since 1970. The text is
// the compensator's, good until the next call of this function.
//
// Errors: NULL_POINTER (both); NOTHING_YET: nothing was learned from live samples; `*kept_json` is null then.
magcomp_error magcomp_compensator_keep(const struct magcomp_compensator *compensator,
                                       int64_t unix_time_s,
                                       const char **kept_json);

// Begins with a text of magcomp_compensator_keep, as sure as its age makes it. `unix_time_s` is now, seconds since 1970 by the clock that keep was told; of
// a time before that, such as MAGCOMP_TIME_UNKNOWN, as good as nothing is believed beforehand. Live samples judge it first, as above.
//
// Errors: NULL_POINTER (both); CONFIG (not UTF-8); KEPT_DAMAGED; KEPT_NEWER.
magcomp_error magcomp_compensator_adopt(struct magcomp_compensator *compensator,
                                        const char *kept_json,
                                        int64_t unix_time_s);

// Fills `config`, whose size is set, with the default of every setting. Errors: NULL_POINTER; SIZE. They leave no message.
magcomp_error magcomp_config_default(struct magcomp_config *config);

// As magcomp_compensator_create, with settings as members.
//
// Errors: NULL_POINTER (both); SIZE; CONFIG. `*compensator` is null then, and magcomp_compensator_last_error(NULL) has this thread's message.
magcomp_error magcomp_compensator_create_with(const struct magcomp_config *config,
                                              struct magcomp_compensator **compensator);

// As magcomp_compensator_set_heading: `axis`, `screen_rotation_deg`, `declination_deg` and `tilt_sigma_deg` of `config`; nothing else of it is used.
//
// Errors: NULL_POINTER (both); SIZE; CONFIG.
magcomp_error magcomp_compensator_set_heading_with(struct magcomp_compensator *compensator,
                                                   const struct magcomp_config *config);

// One fit of raw samples of a turned device, as a compensator's first: `points_ut` are `count` times three numbers, uT, in any order. `field_strength_ut` is
// |h| where it is known, 1 to 1000, else NaN. Fills `calibration` and, where it is not null, `fit`, whose sizes are set.
//
// Errors: NULL_POINTER (`points_ut`, `calibration`); SIZE; CONFIG (`field_strength_ut`); FIT: `fit` says which problem, `calibration` is as it was. The message is this thread's:
// magcomp_compensator_last_error(NULL).
magcomp_error magcomp_fit_ellipsoid(const double *points_ut,
                                    size_t count,
                                    double field_strength_ut,
                                    struct magcomp_calibration *calibration,
                                    struct magcomp_fit *fit);

// How sure M and b in force are: the covariance of b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz (no unit), 9 rows of 9 numbers, into `covariance`, which
// has room for 81.
//
// Errors: NULL_POINTER (both); NOTHING_YET.
magcomp_error magcomp_compensator_covariance(const struct magcomp_compensator *compensator,
                                             double *covariance);

// A heading from outside: a GNSS course, a landmark. Degrees clockwise from the north that `reference`, a magcomp_north, names, -360 to 360; its standard
// deviation, above 0, up to 180 deg, of errors that are taken to last for 10 s. `axis` is what points there: three numbers of any length but 0, device
// axes, such as the top edge 0, 1, 0; null: a vehicle in which the device lies, turned against it by an angle that does not change.
//
// It is used at the magnetic sample that follows it in time, or comes up to 5 s late. The gyroscope carries north from one to the next; without a gyroscope
// they are not used. One that contradicts what is known is ignored, unless others say the same for a minute. The filtered field, heading and attitude go
// by it; the calibration and `field_ut` do not.
//
// Errors: NULL_POINTER (`compensator`); CONFIG (`reference`); EVENT_NOT_FINITE, EVENT_OUT_OF_RANGE, EVENT_LATE, EVENT_DUPLICATE, EVENT_AHEAD: it is left out.
magcomp_error magcomp_compensator_push_heading(struct magcomp_compensator *compensator,
                                               int64_t time_ns,
                                               double heading_deg,
                                               double sigma_deg,
                                               int32_t reference,
                                               const double *axis);

// An orientation from outside, such as a camera's pose: the quaternion w + x i + y j + z k, of any length but 0, that takes device axes to a world whose z
// points up. While the gyroscope is missing its turns stand in for it. Where the world's y axis points to a north, which `reference` then names, it is a
// heading too, of the standard deviation `sigma_deg`; with MAGCOMP_NORTH_NONE `sigma_deg` is not read.
//
// Errors: as magcomp_compensator_push_heading.
magcomp_error magcomp_compensator_push_attitude(struct magcomp_compensator *compensator,
                                                int64_t time_ns,
                                                double w,
                                                double x,
                                                double y,
                                                double z,
                                                int32_t reference,
                                                double sigma_deg);

// What headings from outside are worth after the latest sample; MAGCOMP_HEADING_AID_NONE of null, and after a panic.
magcomp_heading_aid magcomp_compensator_heading_aid(const struct magcomp_compensator *compensator);

// The declination that headings from true north have shown, deg, east positive, and its standard deviation. Either pointer may be null.
//
// Errors: NULL_POINTER (`compensator`); NOTHING_YET: no such heading was used yet, or a declination is set. Both numbers are NaN then.
magcomp_error magcomp_compensator_found_declination(const struct magcomp_compensator *compensator,
                                                    double *declination_deg,
                                                    double *sigma_deg);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* MAGCOMP_H */

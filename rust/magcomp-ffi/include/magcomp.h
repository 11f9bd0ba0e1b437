// made by bindings/generate.sh from bindings/reading.toml
// The C path for a stream of sensor events, beside what uniffi generates (MagcompFFI.h): plain numbers in, one struct out,
// no allocation. `rust/magcomp-ffi/src/c.rs` implements it; the Swift class `Compensator` wraps it.
//
// A handle is a number, not a pointer: of a closed or freed object it answers MAGCOMP_CLOSED. Any thread may call.

#pragma once

#include <stdint.h>

/// An answer below 0 is an error.
enum {
    /// The object is closed or gone.
    MAGCOMP_CLOSED = -1,
    /// A panic was caught, now or before: the object refuses use until it is reset.
    MAGCOMP_PANICKED = -2,
    /// `out` is null.
    MAGCOMP_NO_ROOM = -3,
};

/// Directions that are told apart.
enum { MAGCOMP_DIRECTIONS = 48 };

/// What the compensator is doing: the codes of bindings/status.toml. `kind` is one of `Status`, `reason` one of the enum it carries, `problem` one of
/// `FitProblem` where `reason` carries it. -1: none.
/// Whole numbers and reals are the case's fields, in order; an axis is a whole number, 0 to 2, and three axes are reals.
typedef struct MagcompStatus {
    int32_t kind;
    int32_t reason;
    int32_t problem;
    int64_t whole[2];
    double real[3];
} MagcompStatus;

/// The latest decided change. `kind` is a code of `EventKind`; -1: none.
typedef struct MagcompEvent {
    int32_t kind;
    int64_t since_ns;
    int64_t decided_ns;
} MagcompEvent;

/// The answer to a magnetometer sample: microtesla, degrees, nanoseconds. What is not known is NaN.
typedef struct MagcompReading {
    double field_ut[3];
    double field_sigma_ut;
    double filtered_field_ut[3];
    double total_field_ut;
    double heading_deg;
    double heading_sigma_deg;
    double true_heading_deg;
    double inclination_deg;
    double attitude_w;
    double attitude_x;
    double attitude_y;
    double attitude_z;
    double attitude_sigma_deg;
    double sigma_t;
    int32_t window;
    double coverage;
    double direction_sigma_deg;
    double worst_sigma_deg;
    /// A code of `ModelOrder`; -1: none.
    int32_t model_order;
    double reported_hard_iron_jump_ut;
    /// A code of `SensorMode`.
    int32_t mode;
    MagcompEvent event;
    MagcompStatus status;
} MagcompReading;

/// A raw magnetometer event, microtesla; `bx` to `bz` are the operating system's own hard iron, NaN for none. Fills `out`
/// and answers 0.
int32_t magcomp_push(int64_t handle, int64_t time_ns, double x, double y, double z, double bx, double by, double bz,
                     MagcompReading *_Nullable out);

/// A gyroscope event, rad/s. 0: used; above 0: not used, `EventRejection` counted from 1.
int32_t magcomp_push_rotation_rate(int64_t handle, int64_t time_ns, double x, double y, double z);

/// An accelerometer or gravity event, m/s^2, pointing up. Answers as above.
int32_t magcomp_push_up(int64_t handle, int64_t time_ns, double x, double y, double z);

/// Where the field has not pointed yet: unit vectors in the device frame, their components one after another, into `out`, which holds three times
/// MAGCOMP_DIRECTIONS. Answers how many vectors.
int32_t magcomp_unseen_directions(int64_t handle, double *_Nullable out);

//! Carried phones whose sensors, loggers and apps do not read what they should: a field that is filled up, slow sensors, other conventions, an
//! accelerometer or a gyroscope at fault. Each group is a table of sensors: a line and a way of carrying make a variant.

use super::families::BOTH;
use super::fields::{Line, table};
use super::group::Group;
use super::sensors::Sensors;
use super::variant::Variant;
use crate::inertial::Fault;
use crate::motion::Motion::{Game, Look, Mixed, Text};
use crate::simulate::{Filled, Magnetometer, Noise};
use magcomp::nalgebra::{Matrix3, Vector3};

/// Rate to which a field is filled up, samples a second, and its noise, uT.
const FILLED_HZ: f64 = 200.0;
const FILLED_NOISE_UT: f64 = 0.7;
/// From when on a sensor is at fault, s.
const FAULT_S: f64 = 40.0;
/// A bias of the gyroscope steps by this, rad/s; that of the accelerometer is this, m/s^2.
const BIAS_RAD_S: f64 = 0.1;
const BIAS_M_S2: f64 = 1.0;

pub(super) fn variants() -> Vec<Variant> {
    [resampled(), slow(), conventions(), accelerometer(), gyroscope()].concat()
}

fn line(name: &'static str, about: &'static str, sensors: Sensors) -> Line {
    Line { name, about, happens: Vec::new(), sensors }
}

/// The usual sensors but for this of the magnetometer.
fn magnetic(of: impl Fn(Magnetometer) -> Magnetometer) -> Sensors {
    let usual = Sensors::carried();
    Sensors { magnetometer: of(usual.magnetometer), ..usual }
}

fn resampled() -> Vec<Variant> {
    let fast = Sensors::carried().at_rate(FILLED_HZ);
    let filled = |filled| {
        let magnetometer =
            Magnetometer { noise: Noise::Ut(FILLED_NOISE_UT), filled: Some(filled), ..fast.magnetometer };
        Sensors { magnetometer, ..fast }
    };
    let lines = vec![
        line("line2", "200 Hz interpolated from 100", filled(Filled::Interpolated(2))),
        line("line4", "200 Hz interpolated from 50", filled(Filled::Interpolated(4))),
        line("line8", "200 Hz interpolated from 25", filled(Filled::Interpolated(8))),
        line("held2", "100 Hz, each value twice", filled(Filled::Held(2))),
        line("held4", "50 Hz, each value four times", filled(Filled::Held(4))),
        line("held8", "25 Hz, each value eight times", filled(Filled::Held(8))),
    ];
    table(Group::Resampled, &[(Text, "walk"), (Look, "look")], 80.0, lines)
}

fn slow() -> Vec<Variant> {
    let usual = Sensors::carried();
    let gyroscope = |gyro_hz| Sensors { gyro_hz, ..usual };
    let magnetometer = |rate_hz| magnetic(|sensor| Magnetometer { rate_hz, ..sensor });
    let lines = vec![
        line("all5", "all sensors 5 Hz", usual.at_rate(5.0)),
        line("all10", "all sensors 10 Hz", usual.at_rate(10.0)),
        line("all16", "all sensors 16 Hz", usual.at_rate(16.0)),
        line("all25", "all sensors 25 Hz", usual.at_rate(25.0)),
        line("gyro5", "the gyroscope 5 Hz, others 100", gyroscope(5.0)),
        line("gyro10", "the gyroscope 10 Hz, others 100", gyroscope(10.0)),
        line("gyro16", "the gyroscope 16 Hz, others 100", gyroscope(16.0)),
        line("gyro25", "the gyroscope 25 Hz, others 100", gyroscope(25.0)),
        line("mag5", "the magnetometer 5 Hz, others 100", magnetometer(5.0)),
        line("mag10", "the magnetometer 10 Hz, others 100", magnetometer(10.0)),
        line("mag16", "the magnetometer 16 Hz, others 100", magnetometer(16.0)),
        line("mag25", "the magnetometer 25 Hz, others 100", magnetometer(25.0)),
    ];
    // what one motion teaches is believed in the next
    table(Group::Slow, &[(Text, "walk"), (Mixed, "mixed")], 90.0, lines)
}

fn conventions() -> Vec<Variant> {
    let usual = Sensors::carried();
    let field = |read_as| magnetic(|sensor| Magnetometer { read_as, ..sensor });
    let one = Matrix3::identity();
    let lines = vec![
        line("swapped", "x and y of the magnetometer swapped", field(SWAPPED)),
        line(
            "mirrored",
            "x of the magnetometer mirrored",
            field(Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0))),
        ),
        line("turned90", "the magnetometer turned by 90 deg about z", field(TURNED)),
        line("gravity", "the accelerometer's sign turned", Sensors { accel_read_as: -one, ..usual }),
        line("milligauss", "the field in milligauss", field(one * 10.0)),
        line("degrees", "the gyroscope in deg/s", Sensors { gyro_read_as: one * 1_f64.to_degrees(), ..usual }),
        line(
            "mixed",
            "calibrated and uncalibrated samples in turns",
            magnetic(|it| Magnetometer { is_mixed: true, ..it }),
        ),
    ];
    table(Group::Conventions, &[(Text, "walk"), (Look, "look")], 80.0, lines)
}

const SWAPPED: Matrix3<f64> = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
const TURNED: Matrix3<f64> = Matrix3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0);

fn accelerometer() -> Vec<Variant> {
    let usual = Sensors::carried();
    let lines = vec![
        line("frozen", "frozen at 40 s", Sensors { accel_fault: Some((FAULT_S, Fault::Frozen)), ..usual }),
        line("swapped", "x and y swapped", Sensors { accel_read_as: SWAPPED, ..usual }),
        line("biased", "biased by 1 m/s^2", Sensors { accel_bias: BIAS_M_S2, ..usual }),
    ];
    table(Group::Accelerometer, &BOTH, 90.0, lines)
}

fn gyroscope() -> Vec<Variant> {
    let usual = Sensors::carried();
    let fault = |fault| Sensors { gyro_fault: Some((FAULT_S, fault)), ..usual };
    let late = |late_s| magnetic(|sensor| Magnetometer { late_s, ..sensor });
    let lines = vec![
        line("zeros", "exact zeros from 40 s on", fault(Fault::Zeros)),
        line("frozen", "frozen at 40 s", fault(Fault::Frozen)),
        line("bias", "its bias steps by 0.1 rad/s at 40 s", fault(Fault::Biased(Vector3::x() * BIAS_RAD_S))),
        line(
            "gaps",
            "silent for 50 to 300 ms of each 5 s",
            Sensors { gyro_silent_s: Some((5.0, (0.05, 0.3))), ..usual },
        ),
        line("early30", "the magnetometer's stamps 30 ms early", late(-0.03)),
        line("early50", "the magnetometer's stamps 50 ms early", late(-0.05)),
        line("early100", "the magnetometer's stamps 100 ms early", late(-0.1)),
        line("late30", "the magnetometer's stamps 30 ms late", late(0.03)),
        line("late50", "the magnetometer's stamps 50 ms late", late(0.05)),
        line("late100", "the magnetometer's stamps 100 ms late", late(0.1)),
    ];
    table(Group::Gyroscope, &[(Text, "walk"), (Game, "game")], 80.0, lines)
}

//! Scenarios of the paper's kind: 40 uT, dip 60 degrees, parameters `mid`, 30 dB, the change after 25 s of 65; the magnetometer alone.

use super::group::Group;
use super::happening::{By, Happening, When};
use super::phones::{PhoneChange, phone};
use super::sensors::Sensors;
use super::variant::{DeviceKind, Place, Variant};
use crate::motion::Motion;
use crate::parameters::ParameterSet;
use crate::simulate::{Noise, Spikes};

/// Field, uT.
const FIELD_UT: f64 = 40.0;
/// When they change, s.
const CHANGE_S: f64 = 25.0;
/// Ten field strengths, uT.
const SPIKE_UT: f64 = 10.0 * FIELD_UT;

pub(super) fn variants() -> Vec<Variant> {
    use Motion::{Stroll, Tumble, Uniform};
    let change = |by, for_s| vec![Happening::Step { when: When::At(CHANGE_S), by, over_s: 0.0, for_s }];
    let all_grow = || change(By::Everything(1.5), None);
    let small = || change(By::OffsetInFields([0.06, -0.06, 0.05]), None);
    let ramp = Happening::Ramp { from_s: CHANGE_S, over_s: 50.0, by: By::HardIron(1.5) };
    let mut spikes =
        paper("spikes", "even orientations, M and b grow by half, 2 % spikes of 400 uT", Uniform, all_grow());
    spikes.sensors.magnetometer.spikes = Some(Spikes { share: 0.02, size_ut: (SPIKE_UT, SPIKE_UT + 1e-6) });
    vec![
        paper("constant", "even orientations, nothing changes", Uniform, Vec::new()),
        paper("step", "even orientations, M and b grow by half", Uniform, all_grow()),
        paper("step-hand", "in a hand, M and b grow by half", Tumble, all_grow()),
        paper("step-walk", "strolling, M and b grow by half", Stroll, all_grow()),
        paper("ramp", "even orientations, b grows by half over 50 s", Uniform, vec![ramp]),
        paper("random-steps", "even orientations, all drawn anew every 15 s", Uniform, vec![Happening::Redrawn]),
        spikes,
        paper(
            "pulse",
            "even orientations, b off by 31 uT for 0.5 s",
            Uniform,
            change(By::OffsetInFields([0.6, -0.4, 0.3]), Some(0.5)),
        ),
        paper("covers", "even orientations, M and b times 1.5 and back every 15 s", Uniform, vec![Happening::Covers]),
        paper("small-step", "even orientations, b steps by 4 uT", Uniform, small()),
        paper("small-step-hand", "in a hand, b steps by 4 uT", Tumble, small()),
    ]
}

fn paper(name: &str, about: &str, motion: Motion, happens: Vec<Happening>) -> Variant {
    let mut sensors = Sensors::plain().without_gyroscope();
    sensors.has_accelerometer = false;
    sensors.magnetometer.noise = Noise::SnrDb(30.0);
    Variant {
        about: about.to_owned(),
        group: Group::Paper,
        duration_s: 65.0,
        earth: (FIELD_UT, 60.0),
        place: Place::Even,
        device: DeviceKind::Set(ParameterSet::Mid),
        change_s: CHANGE_S,
        happens,
        sensors,
        ..phone(name, motion, PhoneChange::Nothing)
    }
}

//! Every simulated scenario, as data: a list of [`Variant`]s, each with a name, a motion, what happens to the device and the place, and
//! the sensors with their oddities. A variant and a seed name a stream with its truth, bit for bit.
//!
//! `phones` has the phones of 60 s that figures are quoted of, `paper` the scenarios of the paper, `families` phones as they are carried, with
//! the accelerations that belong to it: latitudes, steps of the device, motions, places, sensors, a long run. `fields` and `readings` have what goes
//! wrong for users: the first in the field and the hand (a place's field that swings, a device that is shaken, boards with magnets, changes that go
//! back, a second launch), the second in sensors, loggers and apps (resampled fields, slow sensors, conventions, sensors at fault).

mod families;
mod fields;
mod group;
mod happening;
mod paper;
mod phones;
mod readings;
mod sensors;
mod variant;

pub use group::Group;
#[cfg(not(target_family = "wasm"))]
pub(crate) use happening::symmetric;
pub use happening::{By, Happening, Swing, When};
pub use phones::{CHANGE_S, FIELD_UT, PLACE_S, PhoneChange, phone};
pub use sensors::Sensors;
#[cfg(not(target_family = "wasm"))]
pub(crate) use variant::hash;
pub use variant::{DeviceKind, Kept, Place, ROOM_UT, Variant};

impl Group {
    /// Its variants, in the order of the table.
    pub fn variants(self) -> Vec<Variant> {
        all().into_iter().filter(|variant| variant.group == self).collect()
    }
}

/// What methods are compared on when nothing else is asked for.
pub const COMPARED: [&str; 20] = [
    "constant",
    "step",
    "step-hand",
    "step-walk",
    "ramp",
    "random-steps",
    "spikes",
    "pulse",
    "covers",
    "small-step",
    "small-step-hand",
    "phone-hand",
    "phone-walk",
    "phone-walk-known",
    "phone-drift",
    "phone-steady",
    "phone-walk-steady",
    "phone-planar",
    "phone-still",
    "phone-spikes",
];

/// Every variant, a group after the other.
pub fn all() -> Vec<Variant> {
    [phones::variants(), families::variants(), fields::variants(), readings::variants(), paper::variants()].concat()
}

/// The variant of that name.
pub fn find(name: &str) -> Result<Variant, String> {
    let found = all().into_iter().find(|variant| variant.name == name);
    found.ok_or_else(|| format!("no variant is called {name}; `magcomp evaluate --list` has all names"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn every_variant_has_a_name_and_a_line_of_its_own() {
        let all = all();
        let mut names: Vec<_> = all.iter().map(|variant| variant.name.clone()).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all.len());
        for group in Group::value_variants() {
            let mut lines: Vec<_> = group.variants().iter().map(|variant| variant.about.clone()).collect();
            let count = lines.len();
            lines.sort();
            lines.dedup();
            assert!(lines.len() == count && count > 0, "{group:?}: {lines:?}");
        }
        assert!(find("phone-steady").is_ok() && find("nothing").is_err());
    }

    /// Whatever has a size is that large in the truth, and changes when it says.
    #[test]
    fn the_truth_has_what_the_data_say() {
        let changes = |name: &str| find(name).unwrap().stream(3).changes;
        for (name, sizes) in [
            ("phone-steady", &[][..]),
            ("phone-walk", &[26.9]),
            ("steps.b150", &[150.0]),
            ("steps.off10s", &[30.0, 30.0]),
            ("places.room10s", &[]),
            ("places.room-cover", &[26.9]),
            ("places.car-mount", &[30.0]),
            ("covers", &[11.7, 11.7, 11.7]),
        ] {
            let found = changes(name);
            let found: Vec<f64> = found.iter().map(|change| change.size_ut).collect();
            assert_eq!(found.len(), sizes.len(), "{name}: {found:?}");
            assert!(found.iter().zip(sizes).all(|(found, size)| (found - size).abs() < 0.1), "{name}: {found:?}");
        }
        let stream = find("steps.b150").unwrap().stream(3);
        let b = |at: usize| stream.truth[at].hard_iron_ut;
        assert!(((b(4100) - b(3900)).norm() - 150.0).abs() < 1e-9);
        assert_eq!(b(3900), b(0));
    }

    /// Every stream can be made and has samples of all its sensors in order.
    #[test]
    fn every_variant_makes_a_stream() {
        let all: Vec<_> = all().into_iter().filter(|variant| variant.duration_s < 500.0).collect();
        let made = crate::parallel::map(&all, crate::parallel::cores(), |variant| {
            let stream = variant.stream(1);
            let due = variant.duration_s * stream.rate_hz;
            let share = stream.magnetic.len() as f64 / due;
            let in_order = stream.magnetic.windows(2).all(|pair| pair[0].time_ns < pair[1].time_ns);
            let finite = stream.magnetic.iter().all(|sample| sample.field_ut.iter().all(|v| v.is_finite()))
                && stream.ups.iter().all(|event| event.up_m_s2.iter().all(|v| v.is_finite()))
                && stream.rotation_rates.iter().all(|event| event.rate_rad_s.iter().all(|v| v.is_finite()));
            (variant.name.clone(), share > 0.7 && share <= 1.0 && in_order && finite)
        });
        assert!(made.iter().all(|(_, good)| *good), "{made:?}");
    }
}

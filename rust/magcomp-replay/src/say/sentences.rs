//! A replay in words.

use crate::judge::DeviceChange;
use crate::judge::HeadingError;
use crate::judge::Judgement;
use crate::statistics::MeanSpread;
use crate::table::number;

/// Total fields that the Earth has at its surface, uT.
pub(super) const EARTH_UT: (f64, f64) = (22.0, 67.0);
/// Most changes that are told in words.
const MOST_CHANGES: usize = 12;

/// What a replay comes to, a sentence or two each: heading, field, changes.
pub(super) fn sentences(judgement: &Judgement) -> Vec<String> {
    let heading = reference_sentence(judgement).or_else(|| legs_sentence(judgement));
    let turns = turns_sentence(judgement).filter(|_| judgement.heading.is_none());
    let listed = |what: &str, told: Vec<String>| (!told.is_empty()).then(|| format!("{what}: {}.", told.join("; ")));
    let marks = listed("Noted", judgement.marks.iter().map(ToString::to_string).collect());
    let bearings = listed("Heading", judgement.bearings.iter().map(ToString::to_string).collect());
    let (field, dip, changes) = (field_sentence(judgement), dip_sentence(judgement), changes_sentence(judgement));
    let found = [heading, bearings, field, dip, turns, changes, marks];
    let mut found: Vec<String> = found.into_iter().flatten().collect();
    if judgement.total_field_ut.compensated.is_none() {
        let (from_s, to_s) = judgement.counted_s;
        let few = match judgement.answered > 0.0 {
            true => format!("Fewer than 50 samples were answered from {from_s:.0} to {to_s:.0} s: too few to judge."),
            false => "No sample was answered: there is nothing to judge.".to_owned(),
        };
        found.insert(0, few);
    }
    if judgement.samples_at_rail > 0 {
        found.push(format!(
            "{} of {} had a component at the sensor's rail and were left out.",
            judgement.samples_at_rail,
            counted(judgement.rows, "sample")
        ));
    }
    found
}

fn reference_sentence(judgement: &Judgement) -> Option<String> {
    let (what, error) = match judgement.published_heading {
        Some(published) => ("the heading", published),
        None => ("the heading of the corrected sample", judgement.heading?),
    };
    let rms = |error: HeadingError| short(error.rms_deg);
    let others = others(judgement.raw_heading.map(rms), judgement.system_heading.map(rms));
    let others = others.map_or_else(String::new, |others| format!("; {others}"));
    let (rms_deg, constant) = (short(error.rms_deg), signed(error.constant_deg));
    Some(format!("Reference: {what} is {rms_deg} deg rms off{others}; constant angle {constant} deg taken out."))
}

fn legs_sentence(judgement: &Judgement) -> Option<String> {
    let legs = judgement.legs?;
    let (ours, raw) = (short(legs.deviation_deg), short(legs.raw_deviation_deg));
    Some(format!("Way: the heading is {ours} deg off over its {} legs, up to one constant; raw {raw}.", legs.legs))
}

fn field_sentence(judgement: &Judgement) -> Option<String> {
    let fields = judgement.total_field_ut;
    let MeanSpread { mean, spread } = fields.compensated?;
    let spreads = fields.map(|field| short(field.spread));
    let others = others(spreads.raw, spreads.system).map_or_else(String::new, |others| format!(" ({others})"));
    let (low, high) = EARTH_UT;
    let earth = match judgement.earth {
        Some(earth) => format!("the world magnetic model has {:.1} for the place", earth.total_field_ut),
        None if (low..=high).contains(&mean) => format!("the Earth has {low} to {high}"),
        None => format!("the Earth has {low} to {high}: b is wrong, or iron is near"),
    };
    Some(format!("Total field: spread {} uT{others}, mean {mean:.1}; {earth}.", short(spread)))
}

fn dip_sentence(judgement: &Judgement) -> Option<String> {
    let dips = judgement.dip_deg;
    let MeanSpread { mean, spread } = dips.compensated?;
    let spreads = dips.map(|dip| short(dip.spread));
    let others = others(spreads.raw, spreads.system).map_or_else(String::new, |others| format!(" ({others})"));
    let earth = judgement.earth.map_or_else(String::new, |earth| format!("; the model has {:.1}", earth.dip_deg));
    Some(format!("Dip: spread {} deg{others}, mean {mean:.1}{earth}.", short(spread)))
}

fn turns_sentence(judgement: &Judgement) -> Option<String> {
    let full = judgement.full_turns?;
    let swings = full.rms_deg.map(short);
    let others = others(swings.raw, swings.system).map_or_else(String::new, |others| format!(" ({others})"));
    let turns = counted(full.turns, "full turn");
    Some(format!("Within {turns} by the gyroscope north swings by {} deg rms{others}.", swings.compensated?))
}

/// The same figure of the other fields.
fn others(raw: Option<String>, system: Option<String>) -> Option<String> {
    let system = system.map(|figure| format!("the system's own {figure}"));
    let parts: Vec<String> = system.into_iter().chain(raw.map(|figure| format!("raw {figure}"))).collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// Device steps and places, in the order of time.
fn changes_sentence(judgement: &Judgement) -> Option<String> {
    let devices = judgement.device_changes.iter().map(|change| (change.since_s, device_words(change)));
    let places = judgement
        .places
        .iter()
        .map(|place| (place.from_s, format!("place differed from {:.1} to {:.1} s", place.from_s, place.to_s)));
    let mut told: Vec<(f64, String)> = devices.chain(places).collect();
    told.sort_by(|a, b| a.0.total_cmp(&b.0));
    let more = told.len().saturating_sub(MOST_CHANGES);
    let words: Vec<String> = told.into_iter().take(MOST_CHANGES).map(|(_, words)| words).collect();
    let more = if more > 0 { format!("; and {more} more, which --json lists") } else { String::new() };
    (!words.is_empty()).then(|| format!("Changes: {}{more}.", words.join("; ")))
}

fn device_words(change: &DeviceChange) -> String {
    let what = if change.back { "device as it was before from" } else { "device changed at" };
    let by = change.hard_iron_change_ut.map_or_else(String::new, |ut| format!(" (hard iron by {ut:.1} uT)"));
    format!("{what} {:.1} s{by}", change.since_s)
}

pub(super) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// One digit after the point below 10, none from there on.
pub(super) fn short(value: f64) -> String {
    number(Some(value), if value < 9.95 { 1 } else { 0 })
}

pub(super) fn signed(value: f64) -> String {
    format!("{value:+.1}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::PlaceDiffered;
    use crate::table;
    use crate::{Ignore, Step, judge, replay, usual_part};
    use magcomp::nalgebra::{UnitQuaternion, Vector3};
    use magcomp::{Config, ReferenceAxis, ScreenRotation, heading};
    use magcomp_recordings::place::EarthField;
    use magcomp_recordings::recording::{Recording, Row};

    const HARD_IRON_UT: Vector3<f64> = Vector3::new(0.0, 300.0, 0.0);
    /// A field of 40 uT, 60 deg below the horizon.
    const FIELD_UT: Vector3<f64> = Vector3::new(0.0, 20.0, -34.641_016_151_377_55);

    /// Turned flat, a turn in 10 s; the corrected field is right but for a length that is 2 uT more or less by turns. The reference
    /// is turned by `turned_deg`, anticlockwise, so that headings exceed its own by as much.
    fn judged(turned_deg: Option<f64>) -> Judgement {
        let attitude =
            |time_s: f64| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::TAU * time_s / 10.0);
        let row = |k: u32| {
            let time_s = f64::from(k) * 0.02;
            let turned = turned_deg.map(|deg| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), deg.to_radians()));
            Row {
                time_s,
                time_ns: i64::from(k) * 20_000_000,
                field_ut: attitude(time_s).inverse() * FIELD_UT + HARD_IRON_UT,
                up_m_s2: Some(Vector3::z() * 9.8),
                rate_rad_s: Some(Vector3::z() * std::f64::consts::TAU / 10.0),
                attitude: turned.map(|turned| turned * attitude(time_s)),
                ..Row::default()
            }
        };
        let recording = Recording { path: "r.csv".into(), rows: (0..3000).map(row).collect() };
        let mut steps = replay(&recording, &Config::default(), Ignore::default()).unwrap();
        for (k, (step, row)) in steps.iter_mut().zip(&recording.rows).enumerate() {
            let right = row.field_ut - HARD_IRON_UT;
            let field_ut = right * (1.0 + if k % 2 == 0 { 0.05 } else { -0.05 });
            step.reading.field_ut = Some(field_ut);
            step.reading.heading = heading(&field_ut, &Vector3::z(), ReferenceAxis::TopEdge, ScreenRotation::default());
        }
        judge_of(&recording, &steps)
    }

    fn judge_of(recording: &Recording, steps: &[Step]) -> Judgement {
        judge(recording, steps, usual_part(&recording.extent()), ReferenceAxis::TopEdge)
    }

    #[test]
    fn spreads_are_in_ut_where_a_share_of_the_mean_says_the_opposite() {
        let judgement = judged(None);
        let [raw, ours] = [judgement.total_field_ut.raw, judgement.total_field_ut.compensated].map(Option::unwrap);
        // |b + h| has b + h_y and little else: an amplitude of 20 uT, 14.1 rms
        assert!((raw.spread - 14.1).abs() < 0.2, "{raw:?}");
        assert!((ours.spread - 2.0).abs() < 0.01 && (ours.mean - 40.0).abs() < 0.01, "{ours:?}");
        assert!(raw.spread / raw.mean < ours.spread / ours.mean, "the shares say the same as the spreads");
        let lead = table("r.csv", "auto", &judgement).lead;
        assert_eq!(lead[0], "Total field: spread 2.0 uT (raw 14), mean 40.0; the Earth has 22 to 67.");
        assert!(lead[1].starts_with("Dip: spread 0.0 deg, mean 60.0"), "{lead:?}");
        // 40 s are counted, and a turn begins where the last one ended
        assert!(
            lead[2].starts_with("Within 3 full turns by the gyroscope north swings by 0.0 deg rms (raw "),
            "{lead:?}"
        );
        let raw_deg = judgement.full_turns.unwrap().rms_deg.raw.unwrap();
        assert!((95.0..110.0).contains(&raw_deg), "{raw_deg}: a field that turns with the device has 104");
    }

    #[test]
    fn the_place_has_its_own_field() {
        let earth = EarthField { total_field_ut: 47.06, dip_deg: 61.0, declination_deg: 1.5 };
        let lead = table("r.csv", "auto", &Judgement { earth: Some(earth), ..judged(None) }).lead;
        assert!(lead[0].ends_with("mean 40.0; the world magnetic model has 47.1 for the place."), "{lead:?}");
        assert!(lead[1].ends_with("mean 60.0; the model has 61.0."), "{lead:?}");
    }

    #[test]
    fn the_constant_that_is_taken_out_is_told() {
        let judgement = judged(Some(17.0));
        for error in [judgement.published_heading, judgement.heading] {
            let error = error.unwrap();
            assert!((error.constant_deg - 17.0).abs() < 0.01 && error.rms_deg < 0.01, "{error:?}");
        }
        let lead = table("r.csv", "auto", &judgement).lead;
        assert!(lead[0].starts_with("Reference: the heading is 0.0 deg rms off; raw "), "{lead:?}");
        assert!(lead[0].ends_with("constant angle +17.0 deg taken out."), "{lead:?}");
    }

    #[test]
    fn changes_are_told_in_words_and_in_order() {
        let mut judgement = judged(None);
        let change = |since_s, back, hard_iron_change_ut| DeviceChange {
            since_s,
            decided_s: since_s + 1.0,
            back,
            hard_iron_change_ut,
        };
        judgement.device_changes = vec![change(45.2, false, Some(13.42)), change(99.8, true, None)];
        judgement.places = vec![PlaceDiffered { from_s: 60.0, to_s: 70.0 }];
        let expected = "Changes: device changed at 45.2 s (hard iron by 13.4 uT); place differed from 60.0 to 70.0 s; device as it \
                        was before from 99.8 s.";
        assert!(sentences(&judgement).contains(&expected.to_owned()), "{:?}", sentences(&judgement));
        judgement.places = (0..20).map(|k| PlaceDiffered { from_s: f64::from(k), to_s: f64::from(k) }).collect();
        assert!(changes_sentence(&judgement).unwrap().ends_with("; and 10 more, which --json lists."));
    }
}

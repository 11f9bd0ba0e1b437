//! The questions that are asked of a recording, what answers each, and what would.

use super::axes::{Askew, Fits};
use super::dip::{Angle, LEAST_DIP_DEG};
use super::finding::{Conventions, Finding, Streams, Weight};
use super::samples::FEWEST;
use super::tested::{Answer, Tested};

/// The question of the accelerometer's sign.
const SIGN: &str = "sign of the accelerometer";

/// The question of how the magnetometer sits about the screen's normal, and what would answer it.
const ASKEW: &str = "magnetometer askew in the device";
const TILT: &str = "tilt the device by 45 degrees and more while you turn";

impl Conventions {
    /// What to do so that a magnetometer that sits askew would show: its headings are off by as much, and nothing else says so. None
    /// where the recording tells.
    pub fn askew_untested(&self) -> Option<&str> {
        let question = self.tested.iter().find(|tested| tested.what == ASKEW)?;
        (question.answer == Answer::Untested).then_some(question.how.as_str())
    }
}

/// What the questions are answered by.
pub(super) struct Seen<'a> {
    pub has_clock: bool,
    pub field: Option<&'a Fits>,
    pub gravity: Option<&'a Fits>,
    pub askew: Option<Askew>,
    pub angle: Option<Angle>,
}

impl Seen<'_> {
    pub fn tested(&self, found: &Conventions, streams: &Streams<'_>) -> Vec<Tested> {
        let has = |kinds: &[&str]| found.findings.iter().any(|finding| kinds.contains(&finding.kind));
        let [no_field, no_up, no_rate] = [streams.field, streams.up, streams.rate].map(|events| events.len() < FEWEST);
        let turn = "turn the device about each of its axes, half a turn and back, for 20 s";
        let needs = |missing: bool, sensor: &str, otherwise: &str| {
            if missing { format!("record the {sensor} too") } else { otherwise.to_owned() }
        };
        let both = |missing: bool, other: &str| {
            if no_rate { needs(true, "gyroscope", turn) } else { needs(missing, other, turn) }
        };
        let question = |what, kinds: &[&str], is_sound: bool, by: &str, would: &str| {
            Tested::of(what, has(kinds), is_sound, by, would)
        };
        let proven = |fits: Option<&Fits>| fits.is_some_and(Fits::is_proven);
        let is_level = found.dip_deg.is_some_and(|dip_deg| dip_deg.abs() > LEAST_DIP_DEG);
        let askew = match self.askew {
            Some(askew) if askew.is_known() => format!("by its turns: within {:.0} deg", askew.within_deg()),
            _ => "by its turns".to_owned(),
        };
        vec![
            question("unit of the field", &["field_unit"], found.radius_ut.is_some(), "by its size", turn),
            question(
                "axes of the magnetometer",
                &["field_axes"],
                proven(self.field),
                "by its turns against the gyroscope's",
                &both(no_field, "magnetometer"),
            ),
            question(
                ASKEW,
                &["field_askew"],
                self.askew.is_some_and(|askew| askew.is_sound()) && proven(self.field),
                &askew,
                &needs(no_rate, "gyroscope", TILT),
            ),
            question(
                "unit and axes of the gyroscope",
                &["gyroscope_unit", "gyroscope_axes"],
                proven(self.gravity) || proven(self.field),
                "by the turns of gravity and field",
                &both(no_up, "accelerometer"),
            ),
            question(
                "axes of the accelerometer",
                &["accelerometer_axes", "dip_axes"],
                proven(self.gravity) || self.angle == Some(Angle::Same),
                "by gravity's turns, and by its angle to the field",
                &needs(no_up, "accelerometer", turn),
            ),
            question(
                SIGN,
                &["accelerometer_sign"],
                is_level && !has(&["dip_sign"]),
                "by the dip, north of the magnetic equator",
                &needs(no_up, "accelerometer", "--place LAT,LON, and a turn about each axis"),
            ),
            question(
                "clocks",
                &["clock"],
                self.has_clock && !(no_up && no_rate),
                "the sensors' times overlap",
                "record gyroscope and accelerometer too",
            ),
            question(
                "delay of the field",
                &["field_delay"],
                found.field_delay_s.is_some(),
                "by its turns against the gyroscope's",
                &both(no_field, "magnetometer"),
            ),
            question(
                "samples",
                &["dead_axis", "no_numbers", "two_kinds", "field_interpolated", "rate_low"],
                !no_field,
                "numbers, rates and steps of each sensor",
                "record for a second and more",
            ),
        ]
    }
}

impl Conventions {
    /// With the dip that the place's model has, degrees: its sign proves that of the accelerometer.
    pub fn judge_sign(&mut self, model_deg: f64) {
        let Some(dip_deg) = self.dip_deg.filter(|dip_deg| dip_deg.abs().min(model_deg.abs()) > LEAST_DIP_DEG) else {
            return;
        };
        self.findings.retain(|finding| finding.kind != "dip_sign" && finding.kind != "accelerometer_sign");
        self.tested.retain(|tested| tested.what != SIGN);
        let is_wrong = dip_deg * model_deg < 0.0;
        self.tested.push(Tested::of(SIGN, is_wrong, true, "by the dip that the place has", ""));
        if is_wrong {
            let text = format!(
                "the dip is {dip_deg:.0} deg, and the place has {model_deg:.0}: the acceleration is of Apple's sign: --units a=-m/s2 (or the \
                 magnetometer's axes are all turned round: --frame m=-x,-y,-z)"
            );
            self.findings.insert(0, Finding { kind: "accelerometer_sign", weight: Weight::Fault, text });
        }
    }
}

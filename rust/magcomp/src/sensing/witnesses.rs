//! Gyroscope, gravity and field as witnesses of each other's turns. Two that agree convict the third; one alone convicts nobody but a
//! gyroscope whose axis repeats its reading while all else moves. Each sample asks anew.
//!
//! ```text
//! gravity does not turn with the gyroscope (`axes`), nor does the field (`turning`)     the gyroscope is contradicted
//! gravity turns with it, the field would along other axes                              the sample is refused
//! gravity repeats its reading while the gyroscope turns, or an axis of the gyroscope does while all else moves          it is left out
//! ```

use super::axes::Axes;
use super::frame::{Frame, Piece, Whole};
use super::pairing::{PairedInertial, Rotation};
use super::turning::Turning;
use crate::tuning::choices;
use nalgebra::Vector3;

choices! {
    /// What each of the witnesses is heard for.
    Tuning {
    } mechanisms {
        /// Gravity contradicts a gyroscope whose axes are flipped or dead, or that is read in degrees
        axes;
        /// The field vouches for a gyroscope that gravity contradicts
        vouching;
        /// A magnetometer whose axes are not the gyroscope's is refused
        field_axes;
        /// An accelerometer that hangs is no vertical
        hanging;
    }
}

/// See the module.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Witnesses {
    tuning: Tuning,
    /// What gravity and the field see next.
    frame: Frame,
    gravity: Axes,
    field: Turning,
    /// The latest sample was refused for its axes.
    has_refused: bool,
}

/// What they say of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Testimony {
    /// Neither gravity nor the field turns as the gyroscope says.
    pub is_gyroscope_contradicted: bool,
    /// An axis of the gyroscope is dead.
    pub is_gyroscope_dead: bool,
    /// The sample is refused: its field turns with the gyroscope only where its components, 1 to 3, lie along these axes of the gyroscope, negative the
    /// other way round.
    pub other_axes: Option<[i8; 3]>,
    /// The sample before was refused.
    pub was_refused: bool,
}

impl Witnesses {
    pub fn new(tuning: Tuning) -> Self {
        Self { tuning, ..Self::default() }
    }

    /// As it began.
    pub fn anew(&self) -> Self {
        Self::new(self.tuning)
    }

    /// Hears a sample and what was paired to it, `span_s` after the sample before. Where the accelerometer hangs its vertical is taken out of `paired`.
    /// `field_ut` is `None` where the field is of no use: nothing is said of its axes then.
    pub fn hear(&mut self, paired: &mut PairedInertial, field_ut: Option<&Vector3<f64>>, span_s: f64) -> Testimony {
        if let (Some(rotation), Some(up_m_s2)) = (&paired.rotation, &paired.up_m_s2) {
            self.gravity.read(rotation, span_s, up_m_s2);
            if self.tuning.hanging && self.gravity.is_gravity_frozen() {
                // the gyroscope carries on where up is
                paired.up_m_s2 = None;
            }
        }
        match &paired.rotation {
            Some(rotation) => self.add(rotation, paired.up_m_s2, field_ut.copied(), span_s),
            None => self.pause(),
        }
        let Tuning { axes, vouching, field_axes, .. } = self.tuning;
        let (verdict, contradicts) = (&self.field.verdict, self.gravity.is_contradicted);
        let other_axes = verdict.axes.filter(|_| field_axes && !contradicts && field_ut.is_some());
        let was_refused = self.has_refused;
        if field_ut.is_some() {
            self.has_refused = other_axes.is_some();
        }
        Testimony {
            is_gyroscope_contradicted: axes && contradicts && (!vouching || verdict.contradicts),
            is_gyroscope_dead: axes && self.gravity.is_dead(),
            other_axes,
            was_refused,
        }
    }

    /// No turn reaches across this moment.
    pub fn pause(&mut self) {
        self.frame = Frame::default();
        self.gravity.pause();
        self.field.pause();
    }

    fn add(&mut self, rotation: &Rotation, up_m_s2: Option<Vector3<f64>>, raw_ut: Option<Vector3<f64>>, dt_s: f64) {
        let Rotation { increment_rad, variance_rad2: bridged_rad2, .. } = *rotation;
        let piece = Piece { increment_rad, dt_s, bridged_rad2, raw_ut, late_s: 0.0, up_m_s2 };
        let Some(Whole { raw_ut, up_m_s2, between_rad, length_s, .. }) = self.frame.add(&piece, false) else { return };
        match up_m_s2 {
            Some(up_m_s2) => self.gravity.see(&up_m_s2, &between_rad, length_s),
            None => self.gravity.pause(),
        }
        match raw_ut {
            Some(raw_ut) => self.field.see(&raw_ut, &between_rad, length_s),
            None => self.field.pause(),
        }
    }
}

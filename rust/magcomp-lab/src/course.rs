//! How something comes and goes: a share over time, and what that share is a share of.

use crate::motion::noise::ease;
use crate::parameters::Parameters;
use magcomp::nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// A share over time.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// From 0 to 1 from `at_s` on, eased over `over_s` (0: at once), and back from `until_s` on.
    Held {
        /// s.
        at_s: f64,
        /// s.
        over_s: f64,
        /// s; none for what stays.
        until_s: Option<f64>,
    },
    /// From 0 to 1 evenly.
    Even {
        /// s.
        from_s: f64,
        /// s.
        over_s: f64,
    },
    /// A sine of amplitude 1.
    Sine {
        /// s.
        from_s: f64,
        /// Per second.
        hz: f64,
    },
    /// 0 and 1 in turn, from each of these times on, s.
    Switched(Vec<f64>),
}

impl Course {
    /// From `at_s` on.
    pub fn step(at_s: f64) -> Self {
        Self::Held { at_s, over_s: 0.0, until_s: None }
    }

    /// The share at a time, s.
    pub fn at(&self, time_s: f64) -> f64 {
        match self {
            Self::Held { at_s, over_s, until_s } => {
                let gone = until_s.map_or(0.0, |until_s| come(time_s - until_s, *over_s));
                come(time_s - at_s, *over_s) * (1.0 - gone)
            }
            Self::Even { from_s, over_s } => ((time_s - from_s) / over_s).clamp(0.0, 1.0),
            Self::Sine { from_s, hz } => {
                if time_s > *from_s {
                    (TAU * hz * time_s).sin()
                } else {
                    0.0
                }
            }
            Self::Switched(edges_s) => (edges_s.partition_point(|edge_s| *edge_s < time_s) % 2) as f64,
        }
    }

    /// How far it is under way: 1 halfway, 0 before and after.
    fn under_way(&self, time_s: f64) -> f64 {
        let Self::Held { at_s, over_s, until_s } = self else { return 0.0 };
        let way = |share: f64| 4.0 * share * (1.0 - share);
        way(come(time_s - at_s, *over_s)) + until_s.map_or(0.0, |until_s| way(come(time_s - until_s, *over_s)))
    }
}

fn come(since_s: f64, over_s: f64) -> f64 {
    if over_s > 0.0 { ease(since_s / over_s) } else { f64::from(u8::from(since_s >= 0.0)) }
}

/// A part of the device's disturbance that comes and goes.
#[derive(Clone, Debug, PartialEq)]
pub struct DevicePart {
    /// When.
    pub course: Course,
    /// What it adds to b, uT.
    pub hard_iron_ut: Vector3<f64>,
    /// What it adds to M.
    pub soft_iron: Matrix3<f64>,
    /// What b takes in besides, halfway, as a magnet does that is brought there, uT.
    pub detour_ut: Vector3<f64>,
}

impl DevicePart {
    /// Of b alone.
    pub fn offset(course: Course, hard_iron_ut: Vector3<f64>) -> Self {
        Self { course, hard_iron_ut, soft_iron: Matrix3::zeros(), detour_ut: Vector3::zeros() }
    }

    /// What leads from one set of parameters to another, where the field is `field_ut`.
    pub fn between(course: Course, from: &Parameters, to: &Parameters, field_ut: f64) -> Self {
        let offset_ut = (to.hard_iron - from.hard_iron) * field_ut;
        Self { soft_iron: to.soft_iron - from.soft_iron, ..Self::offset(course, offset_ut) }
    }

    /// What it adds to M and b at a time, s.
    pub fn at(&self, time_s: f64) -> (Matrix3<f64>, Vector3<f64>) {
        let share = self.course.at(time_s);
        (self.soft_iron * share, self.hard_iron_ut * share + self.detour_ut * self.course.under_way(time_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_course_is_where_it_should_be() {
        let at = |course: &Course, times: &[f64]| times.iter().map(|t| course.at(*t)).collect::<Vec<_>>();
        assert_eq!(at(&Course::step(5.0), &[4.999, 5.0]), [0.0, 1.0]);
        let pulse = Course::Held { at_s: 5.0, over_s: 2.0, until_s: Some(10.0) };
        assert_eq!(at(&pulse, &[5.0, 6.0, 7.0, 10.0, 11.0, 12.0]), [0.0, 0.5, 1.0, 1.0, 0.5, 0.0]);
        assert_eq!(at(&Course::Even { from_s: 1.0, over_s: 4.0 }, &[0.0, 2.0, 9.0]), [0.0, 0.25, 1.0]);
        let sine = at(&Course::Sine { from_s: 1.0, hz: 0.25 }, &[0.9, 5.0, 7.0]);
        assert!(sine[0] == 0.0 && (sine[1] - 1.0).abs() < 1e-12 && (sine[2] + 1.0).abs() < 1e-12, "{sine:?}");
        assert_eq!(at(&Course::Switched(vec![1.0, 2.0]), &[0.5, 1.5, 2.5]), [0.0, 1.0, 0.0]);
        let part = DevicePart { detour_ut: Vector3::y() * 3.0, ..DevicePart::offset(pulse, Vector3::x()) };
        let b = |time_s| part.at(time_s).1;
        assert_eq!([b(6.0), b(8.0), b(11.0)], [Vector3::new(0.5, 3.0, 0.0), Vector3::x(), Vector3::new(0.5, 3.0, 0.0)]);
    }
}

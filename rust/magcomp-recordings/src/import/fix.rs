//! The course of a GNSS fix as a heading: the direction in which one moves, while one does.

use crate::recording::Course;

/// Choice: slower than this a course says little of where one moves, m/s.
pub(super) const LEAST_M_S: f64 = 1.0;
/// Choice: the error of a GNSS speed across the course, where the phone tells none, m/s.
const SPEED_SIGMA_M_S: f64 = 0.5;

/// Of a bearing, degrees from true north; what the phone tells of its accuracy, degrees; and the speed, m/s. What is negative or not a number is not
/// known.
pub(super) fn course(bearing_deg: f64, accuracy_deg: f64, speed_m_s: f64) -> Option<Course> {
    if !((0.0..=360.0).contains(&bearing_deg) && speed_m_s.is_finite() && speed_m_s >= LEAST_M_S) {
        return None;
    }
    let is_told = accuracy_deg > 0.0 && accuracy_deg <= 180.0;
    let sigma_deg = if is_told { accuracy_deg } else { SPEED_SIGMA_M_S.atan2(speed_m_s).to_degrees() };
    Some(Course { heading_deg: bearing_deg, sigma_deg })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fix_that_stands_or_has_no_bearing_has_no_course() {
        assert_eq!(course(90.0, 5.0, 10.0), Some(Course { heading_deg: 90.0, sigma_deg: 5.0 }));
        for (bearing_deg, speed_m_s) in [(-1.0, 10.0), (f64::NAN, 10.0), (90.0, 0.4), (90.0, -1.0), (90.0, f64::NAN)] {
            assert_eq!(course(bearing_deg, 5.0, speed_m_s), None);
        }
        // no accuracy: 0.5 m/s across 10 m/s
        let sigma_deg = course(90.0, -1.0, 10.0).unwrap().sigma_deg;
        assert!((sigma_deg - 2.862).abs() < 0.001, "{sigma_deg}");
    }
}

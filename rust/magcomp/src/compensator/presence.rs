//! Whether the gyroscope is there, and how often the chain of its rotations broke.

use super::tuning::Tuning;

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Presence {
    /// Time of the latest sample with a rotation, ns.
    rotated_ns: Option<i64>,
    /// Gaps so far: of the gyroscope while it was in use, of samples, and those that were told.
    pub gaps: u64,
}

impl Presence {
    /// Time passed that no sample shows.
    pub fn pause(&mut self) {
        self.gaps = self.gaps.saturating_add(1);
        self.rotated_ns = None;
    }

    /// A sample came, with a rotation since the one before or without.
    pub fn see(&mut self, time_ns: i64, previous_ns: Option<i64>, has_rotation: bool) {
        if has_rotation {
            self.rotated_ns = Some(time_ns);
        } else if previous_ns.is_some() && previous_ns == self.rotated_ns {
            // the chain of rotations breaks here, by the gyroscope's silence or that of all sensors
            self.gaps = self.gaps.saturating_add(1);
        }
    }

    /// Whether it is there for the sample at this time; `None` where it has never been there.
    pub fn is_there(&self, time_ns: i64, previous_ns: Option<i64>) -> Option<bool> {
        let rotated_ns = self.rotated_ns?;
        let is_gone = time_ns.saturating_sub(rotated_ns) > (Tuning::USED.gone_s * 1e9) as i64;
        // a pause of all sensors is no loss of the gyroscope
        Some(!is_gone || Some(rotated_ns) == previous_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_NS: i64 = 10_000_000;

    /// Samples with a rotation up to that of the time 0.
    fn present() -> Presence {
        let mut presence = Presence::default();
        (-9..=0).for_each(|k| presence.see(k * PERIOD_NS, Some((k - 1) * PERIOD_NS), true));
        presence
    }

    #[test]
    fn one_that_never_came_is_not_asked_for() {
        let mut presence = Presence::default();
        presence.see(0, None, false);
        assert_eq!(presence.is_there(0, None), None);
    }

    #[test]
    fn it_is_gone_after_a_second_of_samples_without_a_rotation() {
        let mut presence = present();
        for k in 1..=102 {
            presence.see(k * PERIOD_NS, Some((k - 1) * PERIOD_NS), false);
            assert_eq!(presence.is_there(k * PERIOD_NS, Some((k - 1) * PERIOD_NS)), Some(k <= 100), "{k}");
        }
        assert_eq!(presence.gaps, 1);
    }

    #[test]
    fn a_pause_of_all_sensors_is_no_loss_but_a_gap() {
        let mut presence = present();
        presence.see(5_000_000_000, Some(0), false);
        assert_eq!((presence.is_there(5_000_000_000, Some(0)), presence.gaps), (Some(true), 1));
    }

    #[test]
    fn a_pause_that_is_told_is_a_gap_and_no_gyroscope_is_known_after_it() {
        let mut presence = present();
        assert_eq!((presence.gaps, presence.is_there(PERIOD_NS, Some(0))), (0, Some(true)));
        presence.pause();
        assert_eq!((presence.gaps, presence.is_there(PERIOD_NS, Some(0))), (1, None));
        presence.pause();
        assert_eq!(presence.gaps, 2);
    }

    #[test]
    fn it_is_gone_a_nanosecond_after_a_second() {
        let presence = present();
        assert_eq!(presence.is_there(1_000_000_000, Some(990_000_000)), Some(true));
        assert_eq!(presence.is_there(1_000_000_001, Some(990_000_000)), Some(false));
    }
}

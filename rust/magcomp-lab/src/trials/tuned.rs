//! Recordings with a reference, each read once and played as often as there are choices to try.

use super::figures::{absolute, published};
use super::folder::{name_of, recordings};
use super::groups::{Groups, INDEX, Rule};
use super::score::{config, judge_rows};
use crate::score::is_explained;
use magcomp::{Method, Tunings};
use magcomp_recordings::import::{ImportOptions, open};
use magcomp_recordings::recording::{Extent, Row};
use magcomp_replay::error::RunError;
use magcomp_replay::{Ignore, Judgement, Player};
use std::path::{Path, PathBuf};

/// The recordings of a folder that have a reference, and what its index says of them.
pub struct Folder {
    /// Their paths, by name.
    pub paths: Vec<PathBuf>,
    pub(super) groups: Groups,
}

/// A recording in memory.
pub struct Trial {
    /// Its name: that of its file, without .csv or .csv.gz.
    pub name: String,
    /// Its group.
    pub group: String,
    pub(super) declination_deg: f64,
    pub(super) magnet_s: Option<(f64, f64)>,
    pub(super) rows: Vec<Row>,
}

/// What a play of a trial came to, judged from 20 s after its begin on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrialScore {
    /// Error of the published heading but for one constant, degrees, root mean square; none of fewer than 100 headings.
    pub heading_deg: Option<f64>,
    /// Share of the judged rows that have a heading.
    pub answered: f64,
    /// Mean square of error over sigma.
    pub z2: Option<f64>,
    /// Error of the published heading with the constant left in, degrees, root mean square.
    pub absolute_deg: Option<f64>,
    /// Device steps that no magnet explains, put on or taken off.
    pub false_steps: usize,
    /// Length, hours.
    pub hours: f64,
    /// Rows that were played.
    pub rows: usize,
}

impl Folder {
    /// The recordings of `path`, with its own `INDEX.csv`; where it has none, `index` names groups and declinations.
    pub fn open(path: &Path, index: Option<&Path>) -> Result<Self, RunError> {
        let index = index.filter(|_| !path.join(INDEX).is_file());
        Ok(Self { paths: recordings(path)?, groups: Groups::of(path, index)? })
    }

    /// Reads one of them.
    pub fn read(&self, path: &Path) -> Result<Trial, RunError> {
        let name = name_of(path);
        let Rule { group, declination_deg, magnet_s, .. } = self.groups.find(&name);
        let mut source = open(&[path.to_owned()], &ImportOptions::default())?.source;
        let rows = source.rows()?.collect::<Result<_, _>>()?;
        Ok(Trial { group: group.to_owned(), declination_deg: *declination_deg, magnet_s: *magnet_s, name, rows })
    }
}

impl Trial {
    /// Plays what comes `begin_s` after the first row and later; none where nothing is left to judge.
    pub fn play(
        &self,
        begin_s: f64,
        method: Method,
        ignore: Ignore,
        tunings: Tunings,
    ) -> Result<Option<TrialScore>, RunError> {
        let first_s = self.rows.first().map_or(0.0, |row| row.time_s);
        let rows = &self.rows[self.rows.partition_point(|row| row.time_s < first_s + begin_s)..];
        let mut extent = Extent::default();
        rows.iter().for_each(|row| extent.add(row));
        let player = Player::tuned(config(self.declination_deg), method, ignore, tunings)?;
        let found = judge_rows(player, &extent, rows.iter().map(Ok))?;
        let shift_s = extent.start_s - first_s;
        Ok((found.absolute_heading.rows > 0).then(|| TrialScore {
            heading_deg: published(&found).map(|heading| heading.rms_deg),
            answered: found.absolute_heading.headings as f64 / found.absolute_heading.rows as f64,
            z2: absolute(&found).and_then(|heading| heading.z_squared),
            absolute_deg: absolute(&found).and_then(|heading| heading.rms_deg),
            false_steps: self.false_steps(&found, shift_s),
            hours: found.duration_s / 3600.0,
            rows: rows.len(),
        }))
    }

    /// Device steps that no magnet explains; their times are from `shift_s` after the first row on.
    fn false_steps(&self, found: &Judgement, shift_s: f64) -> usize {
        let is_true = |since_s: f64, decided_s: f64| {
            let mut hands_s = self.magnet_s.into_iter().flat_map(|(on_s, off_s)| [on_s, off_s]);
            hands_s.any(|at_s| is_explained((at_s, at_s), since_s + shift_s, decided_s + shift_s))
        };
        found.device_changes.iter().filter(|change| !is_true(change.since_s, change.decided_s)).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use magcomp_replay::DeviceChange;

    fn trial(name: &str) -> Trial {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings");
        let folder = Folder::open(&folder, Some(Path::new("nowhere.csv"))).unwrap();
        let path = folder.paths.iter().find(|path| name_of(path) == name).unwrap();
        folder.read(path).unwrap()
    }

    /// What `evaluate --recordings` says of it, and a later begin is a recording of its own.
    #[test]
    fn a_play_is_judged_as_evaluate_does() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings");
        let trial = trial("broad_34_attached_magnet_3cm");
        // its own index counts, whatever other is named
        assert_eq!(trial.group, "a magnet on the sensor");
        let path = folder.join("broad_34_attached_magnet_3cm.csv.gz");
        let (score, _) =
            super::super::Score::of(&path, &Groups::of(&folder, None).unwrap(), Ignore::default()).unwrap();
        let play = |begin_s, ignore| trial.play(begin_s, Method::Auto, ignore, Tunings::default()).unwrap();
        let whole = play(0.0, Ignore::default()).unwrap();
        let of = |name: &str| score.figures[name];
        assert_eq!(whole.heading_deg, of("heading_rms_deg"));
        assert_eq!((whole.absolute_deg, whole.z2), (of("heading_absolute_deg"), of("z_squared")));
        assert_eq!((Some(whole.answered), whole.hours), (of("answered"), score.hours));
        // its steps are those of the magnet
        assert!(score.device_steps >= 1 && whole.false_steps < score.device_steps, "{whole:?}");
        let later = play(9.0, Ignore::default()).unwrap();
        assert!(
            (whole.hours - later.hours - 9.0 / 3600.0).abs() < 0.1 / 3600.0 && later.heading_deg != whole.heading_deg
        );
        let alone = play(0.0, Ignore { gyroscope: true, accelerometer: false }).unwrap();
        assert!(alone.heading_deg != whole.heading_deg && alone.rows == whole.rows && later.rows < whole.rows);
        assert_eq!(play(1e4, Ignore::default()), None);
    }

    #[test]
    fn a_step_is_false_unless_a_magnet_was_put_on_or_taken_off_just_then() {
        let trial = trial("broad_34_attached_magnet_3cm");
        assert_eq!(trial.magnet_s, Some((45.1, 99.8)));
        let extent = Extent::default();
        let player = Player::new(&config(0.0), Ignore::default()).unwrap();
        let mut found =
            judge_rows(player, &extent, std::iter::empty::<Result<Row, magcomp_recordings::error::RecordingError>>())
                .unwrap();
        let change = |since_s, decided_s| DeviceChange { since_s, decided_s, back: false, hard_iron_change_ut: None };
        found.device_changes = vec![change(45.0, 46.0), change(70.0, 71.0), change(100.0, 101.0), change(45.0, 45.05)];
        assert_eq!(trial.false_steps(&found, 0.0), 2);
        // begun 12 s later, what is told of 33 s is of 45
        found.device_changes = vec![change(33.0, 34.0), change(45.0, 46.0), change(58.0, 60.0)];
        assert_eq!(trial.false_steps(&found, 12.0), 1);
    }
}

//! Trials: recordings with a reference orientation in one folder, each played and judged, then summed up by groups; with magnets put on by arithmetic
//! (`magnets`); beside other methods (`rivals`), or played again and again with other choices (`tuned`).

mod bound;
mod figures;
mod folder;
mod groups;
mod magnets;
mod magnets_view;
mod rivals;
mod rivals_view;
mod score;
mod tuned;
mod view;

pub use figures::{FIGURES, Figure};
pub use magnets::{MAGNETS, Magnet, MagnetScore, MagnetTrials, put_on_folder};
pub use rivals::{Comparison, Entry, compare_folder};
pub use score::{GroupScore, Score, Summary, Trials};
pub use tuned::{Folder, Trial, TrialScore};

use crate::parallel::map_shown;
use folder::recordings;
use groups::Groups;
use magcomp_replay::Ignore;
use magcomp_replay::error::RunError;
use score::with_warnings;
use std::num::NonZeroUsize;
use std::path::Path;

/// Plays and judges every recording of `folder` that has a reference without the sensors that are left out, on so many threads; `index` names groups and declinations
/// (`magcomp evaluate --help`), the folder's own `INDEX.csv` when it is none. The result does not depend on the number of threads.
///
/// # Errors
/// [`RunError::Recording`] names the file that is at fault; [`RunError::Usage`] where no recording has a
/// reference.
pub fn judge_folder(
    folder: &Path,
    index: Option<&Path>,
    ignore: Ignore,
    threads: NonZeroUsize,
) -> Result<Trials, RunError> {
    let paths = recordings(folder)?;
    let groups = Groups::of(folder, index)?;
    let scores = map_shown("evaluate", &paths, threads, |path| Score::of(path, &groups, ignore));
    let scores = scores.into_iter().collect::<Result<_, _>>()?;
    let (recordings, warnings) = with_warnings(scores, &groups);
    Ok(Trials { groups: GroupScore::of_all(&recordings, &groups), recordings, warnings })
}

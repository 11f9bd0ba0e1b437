//! Whether each convention of a recording was tested, and what would test it.

use serde::Serialize;

/// The answer to one question about a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// It is as it should be.
    Sound,
    /// It is wrong; a finding says what mends it.
    Wrong,
    /// The recording does not tell.
    Untested,
}

/// One question about a recording, and its answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tested {
    /// The question, in a word or two.
    pub what: &'static str,
    /// The answer.
    pub answer: Answer,
    /// By what it was tested, or what would test it.
    pub how: String,
}

impl Tested {
    /// Of what was found wrong, or proven sound; else with what would test it.
    pub(super) fn of(what: &'static str, is_wrong: bool, is_sound: bool, by: &str, would: &str) -> Self {
        let answer = match (is_wrong, is_sound) {
            (true, _) => Answer::Wrong,
            (false, true) => Answer::Sound,
            _ => Answer::Untested,
        };
        Self { what, answer, how: if answer == Answer::Untested { would } else { by }.to_owned() }
    }
}

#!/usr/bin/env python3
"""tests/choices.py counts what a core of three files chooses, and the functions that read it."""

import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
from choices import count, is_chosen  # noqa: E402

FILES = {
    "priors.rs": """
/// Choice: memory, s.
pub(crate) const SETTLED_S: f64 = 5.0;
/// Choice: read nowhere, and a label wins over a value made of names.
const HALF: f64 = SETTLED_S / 2.0;
/// Mathematics: an angle that follows.
const TURN: f64 = 7.0;
const NO_KIND: f64 = 7.0;
const COAT_S: f64 = 2.0 * SETTLED_S;
const COUNT: usize = MOST - 1;
""",
    "part/tuning.rs": """
use crate::priors::SETTLED_S;
choices! {
    /// The choices.
    Tuning {
        /// Read in two functions: `first`, `second`
        gate: 16.0, "", "docs/none.md";
        /// A choice, since it can be set by itself
        settled_s: SETTLED_S, "s", "priors";
        /// Read in its own file
        rate: 0.2, "", "priors";
        /// Read in a pattern
        share: 0.3, "", "priors";
        /// Named, but by nobody who has this Tuning
        idle: 0.4, "", "priors";
    }
}
impl Tuning {
    fn rates(&self) -> f64 { self.rate }
}
""",
    "part/mod.rs": """
use crate::priors::{HALF as UNUSED, SETTLED_S as LONG_S};
/// Choice: most of them; a fixed-size array's length is no job.
const MOST: usize = 32;
struct All { them: [f64; MOST] }
// tuning.gate in a comment
fn first(tuning: &Tuning) -> f64 { tuning.gate + tuning.gate.powi(2) + 9.0 * 1.5 + 0.5 + 1e-9 + 100.0 + 7.5 / 3600.0 * 180.0 }
fn second(&self, [a]: [f64; 1]) -> f64 {
    let close = |x: f64| x > self.tuning.gate && '{' != 'x';
    let text = "tuning.gate MOST { LONG_S";
    fn inner() -> usize { MOST }
    LONG_S + MOST + self.rate
}
fn third(tuning: &Tuning) -> f64 { let Tuning { share, .. } = Tuning::USED; tuning.settled_s + idle.idle }
#[cfg(test)]
mod tests {
    fn fourth(tuning: &Tuning) -> usize { tuning.gate as usize + MOST }
}
""",
    "other.rs": """
fn fifth() -> f64 { crate::priors::SETTLED_S + tuning.gate }
fn sixth() -> f64 { part::Tuning::USED.gate }
""",
    "part/tests/more.rs": "fn seventh(tuning: &Tuning) -> f64 { tuning.gate + 77.0 }",
}

with tempfile.TemporaryDirectory() as folder:
    root = Path(folder)
    for name, text in FILES.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    choices, faults = count(root, root)

found = {name: jobs for part, name, value, place, jobs in choices if not name.startswith("fn")}
numbers = sorted(value for part, name, value, place, jobs in choices if name.startswith("fn"))
# SETTLED_S: second, fifth, and what is made of it: HALF, settled_s, COAT_S. gate: first, second, sixth; fifth has another tuning. MOST: second, inner within it, and COUNT, which
# is no number of type f64. rate: rates; the rate of second is a field of its own
expected = {
    "SETTLED_S": 5, "HALF": 1, "COAT_S": 1, "settled_s": 1, "gate": 3, "rate": 1, "share": 1, "idle": 1, "MOST": 2,
}
assert found == expected, found
# 9 is the size of a matrix, 3600 and 180 are conversions of units
assert numbers == ["1.5", "7.5"], numbers
assert sorted(faults) == [
    "part/tuning.rs: gate names docs/none.md, which is not there",
    "part/tuning.rs: nothing reads idle; delete it",
    "priors.rs: NO_KIND has no kind; begin its comment with one of Choice, Physics, Data sheet, Mathematics, Format, Limit",
], faults
derived, chosen = ["ROOM_S", "0.5 * ROOM_S", "ROOM_S * ROOM_S", "ROOM_S / 3600.0"], ["4.0 * ROOM_S", "ROOM_S / 7.0", "1.5 * ROOM_S", "0.1", "1"]
assert [value for value in derived + chosen if is_chosen(value)] == chosen

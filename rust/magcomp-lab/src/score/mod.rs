//! The one judge of simulated streams: each word has one meaning, and this is it. Angles are degrees, times seconds, 68 and 95 % of errors within one
//! and two sigmas are right.
//!
//! Errors of a sample (see `errors`):
//! * calibration: the angle between what the calibration in force makes of the noise-free sample and the field that was measured;
//! * c: that between the corrected sample, noise and all, and the field at its stamp;
//! * f: that between the carried field and the Earth's, whatever the place adds;
//! * heading: the published heading of the automatic axis, less the true one in the Earth's field. Where the device's x axis is within
//!   49 degrees of the vertical a heading means little and none is judged; nor without an accelerometer.
//!
//! Figures of a run ([`Figures`]):
//! * first: when there is a corrected sample for the first time;
//! * before: root mean square of an error over the 10 s before the first change, or from 20 to 45 s where there is none;
//! * error: root mean square from 20 s on; answered: the share of judged samples from 20 s on that have a heading;
//! * within one, two: the share of heading errors from 20 s on that are smaller than one, two of the sigmas published with them; z2: the mean
//!   square of error over sigma, 1 where sigma is right, smaller where it is too wide;
//! * lie: the longest time for which the status is `Tracking` and the heading beyond three sigmas, from 20 s on; pauses of up to 0.2 s do not
//!   end it. lie deg: the largest error in it;
//! * blind: for how long, from 20 s on, the status is `Tracking` or `Held` and f (the calibration, where no f is ever given) wrong by over 10 degrees;
//! * false: device steps, there or back, that no change explains, an hour. A change explains a step whose onset lies between 5 s before it begins
//!   and 12 s after it ends, and which is not decided before it begins; a step whose onset lies in the first 15 s is part of the start. A place
//!   or a car that changes explains no step; a change during a pause may, and need not, be declared;
//! * again: device steps that changes explain, less one for each change that is told: one slide is one event;
//! * missed: changes of the device of 5 uT at least that no step declares.
//!
//! Figures of a stretch, from a change, or from the start, to the next change or the end ([`Stretch`]), where it lasts 8 s at least:
//! * settled: the time from its begin until the 95th percentile of an error over the trailing second is below a limit and stays there to
//!   its end. Without an answer the error is 180 degrees, and 1 s is the least that the measure can give;
//! * lost: its last 5 s have a root mean square of f (or of the calibration, as above) of over 5 degrees.

mod errors;
mod figures;
mod line;
mod stretch;

pub use errors::{Mode, Sample, samples};
pub use figures::{Errors, Figures};
pub use line::{Line, Runs};
pub use stretch::{Begin, Settled, Stretch};
pub(crate) use stretch::{is_explained, settled};

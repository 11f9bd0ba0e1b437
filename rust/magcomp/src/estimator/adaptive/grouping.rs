//! Neighbouring samples of a device that hardly turns are averaged: a mean of n has a n-th of the noise, which moves the fit less
//! along directions that the motion does not show. A sample that leaps away from its neighbours while the next one is back
//! among them is a spike and is left out.

use crate::snapshot::checked;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Samples that one group can hold: 0.08 s at 400 Hz.
const MOST: usize = 32;

/// Neighbouring samples, units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Group {
    samples: [Vector3<f64>; MOST],
    count: usize,
    sum: Vector3<f64>,
    /// Sum of the verticals, and how many samples had one.
    up: Vector3<f64>,
    ups: usize,
    began_ns: i64,
}

checked!(Group, |it| it.count < MOST && it.ups <= it.count);

impl Group {
    pub fn samples(&self) -> &[Vector3<f64>] {
        &self.samples[..self.count]
    }

    pub fn mean(&self) -> Vector3<f64> {
        self.sum / self.count.max(1) as f64
    }

    pub fn began_ns(&self) -> i64 {
        self.began_ns
    }

    /// The mean vertical, a unit vector, where every sample has one.
    pub fn up(&self) -> Option<Vector3<f64>> {
        if self.ups == self.count { self.up.try_normalize(0.5) } else { None }
    }

    fn add(&mut self, (time_ns, u, up): Timed) {
        if self.count == 0 {
            self.began_ns = time_ns;
        }
        self.samples[self.count] = u;
        self.count += 1;
        self.sum += u;
        if let Some(up) = up {
            self.up += up;
            self.ups += 1;
        }
    }

    fn is_near(&self, u: &Vector3<f64>, radius: f64) -> bool {
        self.count == 0 || (u - self.mean()).norm() < radius
    }

    fn is_complete(&self, time_ns: i64, longest_ns: i64) -> bool {
        self.count == MOST || time_ns.saturating_sub(self.began_ns) >= longest_ns
    }
}

/// Time (ns), sample (units) and vertical (unit vector).
type Timed = (i64, Vector3<f64>, Option<Vector3<f64>>);

/// Forms groups.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Grouping {
    open: Group,
    /// The latest sample that was taken.
    latest: Option<Vector3<f64>>,
    /// A sample that leapt away from it, until the next one tells whether it was a spike.
    odd: Option<Timed>,
}

impl Grouping {
    /// A sample in; the groups that it completes, in order.
    pub fn push(&mut self, sample: Timed, radius: f64, longest_ns: i64) -> [Option<Group>; 2] {
        let mut done = [None, None];
        let leaps = |from: Option<Vector3<f64>>| from.is_some_and(|from| (sample.1 - from).norm() >= radius);
        if leaps(self.latest) {
            let Some(odd) = self.odd.replace(sample) else { return done };
            // two in a row: the motion is fast, or the field has changed
            self.take(odd, radius, longest_ns, &mut done);
            if leaps(Some(odd.1)) {
                return done;
            }
        }
        self.odd = None;
        self.take(sample, radius, longest_ns, &mut done);
        done
    }

    fn take(&mut self, sample: Timed, radius: f64, longest_ns: i64, done: &mut [Option<Group>; 2]) {
        let mut close = |open: &mut Group| {
            done.rotate_left(1);
            done[1] = Some(std::mem::take(open));
        };
        if !self.open.is_near(&sample.1, radius) {
            close(&mut self.open);
        }
        self.open.add(sample);
        self.latest = Some(sample.1);
        if self.open.is_complete(sample.0, longest_ns) {
            close(&mut self.open);
        }
    }
}

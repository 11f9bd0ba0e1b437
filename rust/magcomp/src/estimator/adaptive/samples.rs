//! The samples of the segment, those since the latest change, and their moments: of all of them not yet absorbed, and of
//! the latest 8, 16, ... 1024. A sample enters and leaves in constant time, exactly.

use super::line::Timed;
use super::neighbours::Neighbours;
use crate::ellipsoid::Moments;
use crate::snapshot::{LARGEST_COUNT, checked};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Spans of 8, 16, ... 1024 samples.
pub(super) const SPANS: usize = 8;
const SHORTEST: usize = 8;
const CAPACITY: usize = SHORTEST << (SPANS - 1);
/// Samples that can be looked at again one by one.
pub(super) const REVIEWED: usize = 256;

/// Length of a span, samples.
pub(super) const fn span_length(span: usize) -> usize {
    SHORTEST << span
}

/// See the module.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Samples {
    ring: Vec<Vector3<f64>>,
    next: usize,
    /// Samples since the segment began.
    pub age: usize,
    segment: Moments,
    /// When the samples came that have not been absorbed, as long as none has.
    pub timed: Timed,
    spans: [Moments; SPANS],
    /// None once older samples have left the segment.
    neighbours: Option<Neighbours>,
    /// Standard deviation of their noise, units.
    pub noise: f64,
}

checked!(Samples, |it| {
    let (count, none) = (it.segment.count(), Moments::new(*it.segment.centre_ut(), it.segment.scale_ut()));
    it.ring.len() == CAPACITY
        && it.next < CAPACITY
        && it.age as u64 <= LARGEST_COUNT
        && count <= it.age
        && it.timed.count() == count
        && it.neighbours.as_ref().is_none_or(|neighbours| neighbours.count() == count)
        && (0..SPANS).all(|span| it.spans[span].count() == it.age.min(span_length(span)))
        && it.spans.iter().all(|span| span.is_about(&none))
        && it.noise >= 0.0
});

impl Samples {
    pub fn new(centre_ut: Vector3<f64>, unit_ut: f64) -> Self {
        Self::with(vec![Vector3::zeros(); CAPACITY], centre_ut, unit_ut)
    }

    /// As new, in the memory of these, which have none any more.
    pub fn restart(&mut self, centre_ut: Vector3<f64>, unit_ut: f64) -> Self {
        let mut ring = std::mem::take(&mut self.ring);
        ring.fill(Vector3::zeros());
        Self::with(ring, centre_ut, unit_ut)
    }

    fn with(ring: Vec<Vector3<f64>>, centre_ut: Vector3<f64>, unit_ut: f64) -> Self {
        let none = Moments::new(centre_ut, unit_ut);
        Self {
            ring,
            next: 0,
            age: 0,
            segment: none.clone(),
            timed: Timed::new(),
            spans: std::array::from_fn(|_| none.clone()),
            neighbours: Some(Neighbours::new(none)),
            noise: 0.0,
        }
    }

    /// Nothing, about a new centre.
    pub fn clear(&mut self, centre_ut: Vector3<f64>) {
        let none = Moments::new(centre_ut, self.segment.scale_ut());
        self.age = 0;
        self.spans.fill(none.clone());
        self.segment = none.clone();
        self.neighbours = Some(Neighbours::new(none));
        self.timed = Timed::new();
    }

    /// Moments of the samples not yet absorbed.
    pub fn segment(&self) -> &Moments {
        &self.segment
    }

    /// The same, neighbours averaged.
    pub fn neighbours(&self) -> Option<&Neighbours> {
        self.neighbours.as_ref()
    }

    /// Moments of the latest samples of a span: fewer while the segment is younger.
    pub fn span(&self, span: usize) -> &Moments {
        &self.spans[span]
    }

    /// The sample `back` steps ago, 0 the latest; only as far as the segment's age.
    pub fn latest(&self, back: usize) -> &Vector3<f64> {
        &self.ring[(self.next + CAPACITY - 1 - back % CAPACITY) % CAPACITY]
    }

    fn unit(&self, raw_ut: &Vector3<f64>) -> Vector3<f64> {
        (raw_ut - self.segment.centre_ut()) / self.segment.scale_ut()
    }

    /// One more sample.
    pub fn add(&mut self, raw_ut: &Vector3<f64>) {
        let terms = self.segment.terms(raw_ut);
        for span in 0..SPANS {
            let length = span_length(span);
            if self.age >= length {
                let leaving = *self.latest(length - 1);
                self.spans[span].remove(&leaving);
            }
            self.spans[span].add_terms(&terms);
        }
        self.segment.add_terms(&terms);
        self.timed.add(&self.unit(raw_ut));
        if let Some(neighbours) = &mut self.neighbours {
            neighbours.add(raw_ut, self.noise);
        }
        self.ring[self.next] = *raw_ut;
        self.next = (self.next + 1) % CAPACITY;
        self.age += 1;
    }

    /// These samples, oldest first, and no others.
    fn restore(&mut self, samples: &[Vector3<f64>]) {
        for sample in samples {
            self.timed.add(&self.unit(sample));
            self.ring[self.next] = *sample;
            self.next = (self.next + 1) % CAPACITY;
            if let Some(neighbours) = &mut self.neighbours {
                neighbours.add(sample, self.noise);
            }
        }
        // from the latest backwards, so that each is added once
        for (back, sample) in samples.iter().rev().enumerate() {
            self.segment.add(sample);
            if let Some(span) = (0..SPANS).find(|span| span_length(*span) == back + 1) {
                self.spans[span] = self.segment.clone();
            }
        }
        self.age = samples.len();
        for span in (0..SPANS).filter(|span| span_length(*span) > self.age) {
            self.spans[span] = self.segment.clone();
        }
    }

    /// Only the latest samples of a span remain.
    pub fn cut(&mut self, span: usize) {
        let kept = self.spans[span].clone();
        self.age = kept.count();
        for longer in &mut self.spans[span + 1..] {
            longer.clone_from(&kept);
        }
        self.segment = kept;
        self.timed = Timed::new();
        for back in (0..self.age).rev() {
            self.timed.add(&self.unit(self.latest(back)));
        }
        self.neighbours = (self.age <= REVIEWED).then(|| {
            let mut neighbours = Neighbours::new(Moments::new(*self.segment.centre_ut(), self.segment.scale_ut()));
            (0..self.age).rev().for_each(|back| neighbours.add(self.latest(back), self.noise));
            neighbours
        });
    }

    /// The segment without the latest samples of a span, which remain.
    pub fn absorb(&mut self, span: usize) -> (Moments, Timed) {
        let older = self.segment.without(&self.spans[span]);
        self.segment = self.spans[span].clone();
        self.neighbours = None;
        let mut latest = Timed::new();
        (0..self.segment.count()).rev().for_each(|back| latest.add(&self.unit(self.latest(back))));
        let timed = self.timed.without(&latest);
        self.timed = latest;
        (older, timed)
    }

    /// Drops the samples of a young segment that do not pass. Returns how many.
    pub fn review(&mut self, mut pass: impl FnMut(&Vector3<f64>) -> bool) -> usize {
        let count = self.age.min(REVIEWED);
        if count < self.segment.count() {
            return 0;
        }
        let mut kept = [Vector3::zeros(); REVIEWED];
        let mut good = 0;
        for back in (0..count).rev() {
            let sample = *self.latest(back);
            if pass(&sample) {
                kept[good] = sample;
                good += 1;
            }
        }
        if good < count {
            self.clear(*self.segment.centre_ut());
            self.restore(&kept[..good]);
        }
        count - good
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(k: usize) -> Vector3<f64> {
        let k = k as f64;
        Vector3::new(30.0 * (k * 0.7).sin(), 40.0 * (k * 1.3).cos(), 50.0 * (k * 0.31).sin())
    }

    fn of(range: std::ops::Range<usize>) -> Moments {
        let mut moments = Moments::new(Vector3::zeros(), 40.0);
        range.for_each(|k| moments.add(&sample(k)));
        moments
    }

    #[test]
    fn every_span_holds_its_latest_samples() {
        let mut samples = Samples::new(Vector3::zeros(), 40.0);
        (0..3000).for_each(|k| samples.add(&sample(k)));
        for span in 0..SPANS {
            assert_eq!(*samples.span(span), of(3000 - span_length(span)..3000));
        }
        assert_eq!(samples.absorb(3).0, of(0..2936));
        assert_eq!(*samples.segment(), of(2936..3000));
        samples.cut(1);
        (3000..3040).for_each(|k| samples.add(&sample(k)));
        assert_eq!(samples.age, 56);
        assert_eq!(*samples.span(2), of(3008..3040));
        assert_eq!(*samples.span(5), of(2984..3040));
        assert_eq!(*samples.segment(), of(2984..3040));
    }

    #[test]
    fn a_review_leaves_what_passes() {
        let mut samples = Samples::new(Vector3::zeros(), 40.0);
        (0..40).for_each(|k| samples.add(&sample(k)));
        let bad = sample(7);
        assert_eq!(samples.review(|s| *s != bad), 1);
        assert_eq!(*samples.segment(), of(0..40).without(&of(7..8)));
    }
}

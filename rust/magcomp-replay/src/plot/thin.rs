//! A line thinned as it comes: lowest and highest point of each of many short stretches, which is what the eye sees of a long
//! line.

/// Points a line is thinned to: more than the pixels it can use.
const MOST_POINTS: usize = 1400;

/// A line in the making; points that are not finite interrupt it.
#[derive(Clone, Debug, Default)]
pub struct Thin {
    /// Points of a stretch.
    stretch: usize,
    /// Points of the present stretch so far.
    count: usize,
    first_x: f64,
    lowest: Option<(f64, f64)>,
    highest: Option<(f64, f64)>,
    points: Vec<(f64, f64)>,
}

impl Thin {
    /// For a line of so many points.
    pub fn new(points: usize) -> Self {
        let stretch = (2 * points).div_ceil(MOST_POINTS).max(1);
        Self { stretch, ..Self::default() }
    }

    /// The next point, in the order of x.
    pub fn add(&mut self, x: f64, y: f64) {
        if self.stretch < 3 {
            self.points.push((x, y));
            return;
        }
        if self.count == 0 {
            self.first_x = x;
        }
        self.count += 1;
        if (x + y).is_finite() {
            if self.lowest.is_none_or(|(_, low)| y < low) {
                self.lowest = Some((x, y));
            }
            if self.highest.is_none_or(|(_, high)| y >= high) {
                self.highest = Some((x, y));
            }
        }
        if self.count == self.stretch {
            self.end_stretch();
        }
    }

    /// A point of the present stretch, where there is one.
    pub fn present(&self) -> Option<(f64, f64)> {
        self.lowest
    }

    fn end_stretch(&mut self) {
        match (self.lowest.take(), self.highest.take()) {
            (Some(low), Some(high)) if low.0 <= high.0 => self.points.extend([low, high]),
            (Some(low), Some(high)) => self.points.extend([high, low]),
            _ => self.points.push((self.first_x, f64::NAN)),
        }
        self.count = 0;
    }

    /// The thinned line: at most 1400 points, if no more came than were announced.
    pub fn points(&self) -> Vec<(f64, f64)> {
        let mut whole = self.clone();
        if whole.count > 0 {
            whole.end_stretch();
        }
        whole.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_keeps_its_peaks_and_gaps_in_bounded_room() {
        let mut thin = Thin::new(100_000);
        for k in 0..100_000 {
            let y = match k {
                777 => 5.0,
                50_500 => -5.0,
                60_000..61_000 => f64::NAN,
                _ => f64::from(k % 7) / 7.0,
            };
            thin.add(f64::from(k), y);
        }
        let points = thin.points();
        assert!(points.len() <= MOST_POINTS, "{}", points.len());
        assert!(points.contains(&(777.0, 5.0)) && points.contains(&(50_500.0, -5.0)));
        assert!(points.iter().any(|(x, y)| (60_000.0..61_000.0).contains(x) && y.is_nan()));
        assert!(points.is_sorted_by(|a, b| a.0 <= b.0));
    }

    #[test]
    fn a_short_line_stays() {
        let mut thin = Thin::new(3);
        [(0.0, 1.0), (1.0, f64::INFINITY), (2.0, 3.0)].iter().for_each(|(x, y)| thin.add(*x, *y));
        assert_eq!(thin.points(), [(0.0, 1.0), (1.0, f64::INFINITY), (2.0, 3.0)]);
    }
}

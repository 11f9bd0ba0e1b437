//! What many numbers come to.

/// Root mean square; none of nothing.
pub(crate) fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, squares) = values.fold((0_usize, 0.0), |(count, sum), value| (count + 1, sum + value * value));
    (count > 0).then(|| (squares / count as f64).sqrt())
}

/// Middle value, or the mean of the two middle ones; none of nothing.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.get(values.len().saturating_sub(1) / 2)?, values.get(values.len() / 2)?);
    Some(if low == high { *low } else { (low + high) / 2.0 })
}

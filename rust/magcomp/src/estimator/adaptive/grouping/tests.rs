use super::*;

fn at(x: f64) -> Vector3<f64> {
    Vector3::new(x, 1.0, -1.0)
}

/// The groups of samples of these places, a nanosecond apart, that are near within 1 and close after so many nanoseconds: when each began, of how many
/// samples it is, and their sum.
fn groups(places: &[f64], longest_ns: i64) -> Vec<(i64, f64, f64)> {
    let mut grouping = Grouping::default();
    let mut all = Vec::new();
    for (time_ns, x) in places.iter().enumerate() {
        for group in grouping.push((time_ns as i64, at(*x), None), 1.0, longest_ns).into_iter().flatten() {
            all.push((group.began_ns, group.count, (group.sum.x * 1e9).round() / 1e9));
        }
    }
    all
}

#[test]
fn a_group_ends_after_its_time_or_where_a_sample_is_far_from_its_mean() {
    assert_eq!(groups(&[0.0, 0.1, 0.2, 0.3, 0.4, 0.5], 2), [(0, 3.0, 0.3), (3, 3.0, 1.2)]);
    // of 0, 0.5 and 1 the mean is 0.5: 1.5 is no nearer than 1 to it
    assert_eq!(groups(&[0.0, 0.5, 1.0, 1.5, 2.0], 100), [(0, 3.0, 1.5)]);
}

#[test]
fn a_spike_is_left_out_and_two_leaps_are_none() {
    assert_eq!(groups(&[0.0, 0.1, 5.0, 0.2, 0.3], 4), [(0, 4.0, 0.6)]);
    // the field has changed
    assert_eq!(groups(&[0.0, 0.1, 5.0, 5.1, 5.2, 5.3], 3), [(0, 2.0, 0.1), (2, 4.0, 20.6)]);
    // the motion is fast: the latest one waits
    assert_eq!(groups(&[0.0, 2.0, 4.0, 6.0], 100), [(0, 1.0, 0.0), (1, 1.0, 2.0)]);
}

#[test]
fn a_group_has_the_mean_of_its_samples_and_of_its_verticals_where_all_have_one() {
    let mut group = Group::default();
    assert_eq!((group.mean(), group.up()), (Vector3::zeros(), None));
    group.add((5, at(1.0), Some(Vector3::x())));
    group.add((6, at(4.0), Some(Vector3::y())));
    assert_eq!((group.mean(), group.began_ns), (at(2.5), 5));
    assert!((group.up().unwrap() - Vector3::new(0.5, 0.5, 0.0).normalize()).norm() < 1e-12);
    group.add((7, at(4.0), None));
    assert_eq!((group.mean(), group.up()), (at(3.0), None));
}

use super::*;

#[test]
fn orientations_are_means_of_so_many_samples() {
    let mut session = ConstantField::new(2);
    for (x, orientations) in [(1.0, 0), (3.0, 1), (10.0, 1), (20.0, 2)] {
        session.add(&Vector3::new(x, 2.0 * x, -x)).unwrap();
        assert_eq!(session.orientations(), orientations);
    }
    assert_eq!(session.orientations_ut, [Vector3::new(2.0, 4.0, -2.0), Vector3::new(15.0, 30.0, -15.0)]);
}

#[test]
fn a_sample_that_is_none_changes_nothing() {
    let mut session = ConstantField::new(0);
    assert_eq!(session.add(&Vector3::new(0.0, f64::NAN, 0.0)), Err(RejectReason::NotFinite));
    let beyond = RejectReason::OutOfRange { value_ut: -100_000.5, limit_ut: 100_000.0 };
    assert_eq!(session.add(&Vector3::new(0.0, -100_000.5, 5.0)), Err(beyond));
    assert_eq!(session.orientations(), 0);
    assert_eq!((session.add(&Vector3::new(0.0, -100_000.0, 5.0)), session.orientations()), (Ok(()), 1));
}

/// The six directions of the axes, about a centre: six of 48 cells, and all of it found.
#[test]
fn directions_are_seen_from_the_centre() {
    let mut session = ConstantField::new(1);
    let centre = Vector3::new(300.0, -200.0, 100.0);
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
        for sign in [1.0, -1.0] {
            session.add(&(centre + axis * sign * 50.0)).unwrap();
        }
    }
    assert_eq!(session.coverage().share(), 6.0 / 48.0);
    assert_eq!(session.finish(&FitOptions::default()), Err(FitError::TooFewSamples { have: 6 }));
}

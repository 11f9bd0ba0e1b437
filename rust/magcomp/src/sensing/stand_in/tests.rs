use super::*;
use nalgebra::Vector3;

const MS: i64 = 1_000_000;

/// A device that lies on its side in the world, and then turned by so much about its own z.
fn turned(rad: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(Vector3::x() * 1.2) * UnitQuaternion::from_scaled_axis(Vector3::z() * rad)
}

#[test]
fn a_turn_between_two_poses_is_the_rate_in_their_middle_in_the_frame_of_the_device() {
    let (mut stand_in, mut pairing) = (StandIn::default(), InertialPairing::default());
    // 1 rad/s at 50 ms, 2 rad/s at 150 ms
    for (time_ms, rad) in [(0, 0.5), (100, 0.6), (200, 0.8)] {
        stand_in.take(time_ms * MS, turned(rad), &mut pairing);
    }
    pairing.pair(50 * MS);
    let rotation = pairing.pair(150 * MS).rotation.unwrap();
    assert!((rotation.increment_rad - Vector3::z() * 0.15).norm() < 1e-12, "{}", rotation.increment_rad);
    assert!((rotation.rate_rad_s - Vector3::z() * 2.0).norm() < 1e-12, "{}", rotation.rate_rad_s);
}

/// Whether two poses give a turn.
fn gives(stand_in: &mut StandIn, first_ns: i64, next_ns: i64) -> bool {
    let mut pairing = InertialPairing::default();
    stand_in.take(first_ns, turned(0.0), &mut pairing);
    assert_eq!(pairing, InertialPairing::default(), "one pose is no turn");
    stand_in.take(next_ns, turned(0.1), &mut pairing);
    pairing != InertialPairing::default()
}

#[test]
fn a_turn_is_told_where_the_pose_before_is_not_too_old() {
    assert!(gives(&mut StandIn::default(), 0, 10 * MS));
    assert!(gives(&mut StandIn::default(), 0, 250 * MS));
    assert!(!gives(&mut StandIn::default(), 0, 251 * MS));
}

#[test]
fn the_gyroscope_itself_is_preferred_until_it_falls_silent() {
    let heard_before = |silent_ms: i64| {
        let mut stand_in = StandIn { gyroscope_ns: Some(1_000 * MS), ..StandIn::default() };
        gives(&mut stand_in, (1_000 + silent_ms - 10) * MS, (1_000 + silent_ms) * MS)
    };
    assert!(!heard_before(20) && !heard_before(250) && heard_before(251));
}

#[test]
fn no_turn_reaches_across_a_pause() {
    let (mut stand_in, mut pairing) = (StandIn::default(), InertialPairing::default());
    stand_in.take(0, turned(0.0), &mut pairing);
    stand_in.pause();
    stand_in.take(10 * MS, turned(0.1), &mut pairing);
    assert_eq!(pairing, InertialPairing::default());
    stand_in.take(20 * MS, turned(0.2), &mut pairing);
    assert_ne!(pairing, InertialPairing::default());
}

#[test]
fn a_pose_at_or_before_the_latest_is_late() {
    let (mut stand_in, mut pairing) = (StandIn::default(), InertialPairing::default());
    assert_eq!(stand_in.check(0), Ok(()));
    stand_in.take(10 * MS, turned(0.0), &mut pairing);
    assert_eq!(stand_in.check(9 * MS), Err(EventRejection::Late));
    assert_eq!(stand_in.check(10 * MS), Err(EventRejection::Late));
    assert_eq!(stand_in.check(11 * MS), Ok(()));
}

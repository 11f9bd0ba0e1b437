use super::*;
use nalgebra::Vector3;

const SECOND: i64 = 1_000_000_000;

fn sample(time_ns: i64, x: f64) -> MagneticSample {
    MagneticSample { time_ns, field_ut: Vector3::new(x, 0.5, -0.5) }
}

#[test]
fn each_reason_has_its_limit() {
    let check = |sample, rail_ut| Stream::default().check(&sample, 2000.0, rail_ut, &Tuning::USED, || false);
    assert_eq!(check(sample(0, f64::NAN), None), Err(RejectReason::NotFinite));
    assert_eq!(check(sample(0, -2000.0), None), Ok(()));
    assert_eq!(check(sample(0, -2000.1), None), Err(RejectReason::OutOfRange { value_ut: -2000.1, limit_ut: 2000.0 }));
    let saturated = Err(RejectReason::Saturated { axis: Axis::X, value_ut: -900.0, rail_ut: 900.0 });
    assert_eq!([check(sample(0, -900.0), Some(900.0)), check(sample(0, 899.9), Some(900.0))], [saturated, Ok(())]);
}

#[test]
fn time_goes_forward_by_a_week_at_the_most() {
    let mut stream = Stream::default();
    assert_eq!((stream.latest_ns(), stream.accept(sample(5 * SECOND, 1.0))), (None, None));
    let check = |time_ns| stream.check(&sample(time_ns, 2.0), 2000.0, None, &Tuning::USED, || false);
    let week = 604_800 * SECOND;
    assert_eq!([check(5 * SECOND + 1), check(5 * SECOND + week)], [Ok(()); 2]);
    let not_after = |time_ns| Err(RejectReason::TimeNotAfter { time_ns, latest_ns: 5 * SECOND });
    assert_eq!([check(5 * SECOND), check(4 * SECOND)], [not_after(5 * SECOND), not_after(4 * SECOND)]);
    let jump = RejectReason::TimeJump { gap_s: 604_801.0, limit_s: 604_800.0 };
    assert_eq!(check(6 * SECOND + week), Err(jump));
    assert_eq!((stream.accept(sample(6 * SECOND, 1.0)), stream.latest_ns()), (Some(5 * SECOND), Some(6 * SECOND)));
}

#[test]
fn fifty_equal_samples_are_taken_and_no_more() {
    let mut stream = Stream::default();
    for k in 0..50 {
        assert_eq!(stream.check(&sample(k, 1.0), 2000.0, None, &Tuning::USED, || false), Ok(()), "{k}");
        stream.accept(sample(k, 1.0));
    }
    assert_eq!(
        stream.check(&sample(50, 1.0), 2000.0, None, &Tuning::USED, || false),
        Err(RejectReason::Stuck { repeats: 50 })
    );
    assert_eq!(stream.check(&sample(50, 1.1), 2000.0, None, &Tuning::USED, || false), Ok(()));
    // another one ends the row
    stream.accept(sample(50, 1.1));
    stream.accept(sample(51, 1.0));
    assert_eq!(stream.check(&sample(52, 1.0), 2000.0, None, &Tuning::USED, || false), Ok(()));
}

const LATE: RejectReason = RejectReason::TimeNotAfter { time_ns: 0, latest_ns: 0 };
const JUMP: RejectReason = RejectReason::TimeJump { gap_s: 1e6, limit_s: 604_800.0 };

/// After how many samples of such steps the clock is another one, of a hundred.
fn strays(mut step: impl FnMut(i64) -> (i64, RejectReason)) -> Option<i64> {
    let mut stream = Stream::default();
    (1..=100).find(|k| {
        let (time_ns, reason) = step(*k);
        stream.stray(time_ns, reason)
    })
}

#[test]
fn fifty_samples_in_a_row_that_follow_one_another_are_of_another_clock() {
    assert_eq!(strays(|k| (k * SECOND, LATE)), Some(50));
    assert_eq!(strays(|k| (k * SECOND, JUMP)), Some(50));
    // a week apart, and more than that; at one time, and backwards
    assert_eq!(strays(|k| (k * 604_800 * SECOND, LATE)), Some(50));
    assert_eq!(strays(|k| (k * 604_801 * SECOND, LATE)), None);
    assert_eq!(strays(|_| (SECOND, LATE)), None);
    assert_eq!(strays(|k| (-k * SECOND, LATE)), None);
    // one that does not follow begins the row anew
    assert_eq!(strays(|k| (if k == 20 { -SECOND } else { k * SECOND }, LATE)), Some(20 + 49));
    // a value that is wrong says nothing of the clock
    assert_eq!(strays(|k| (k * SECOND, RejectReason::NotFinite)), None);
}

#[test]
fn an_accepted_sample_ends_the_row() {
    let mut stream = Stream::default();
    (1..=49).for_each(|k| assert!(!stream.stray(k * SECOND, LATE)));
    stream.accept(sample(0, 1.0));
    assert!(!stream.stray(50 * SECOND, LATE));
}

#[test]
fn two_streams_are_equal_where_they_judge_alike() {
    let mut streams = [Stream::default(); 2];
    streams.iter_mut().for_each(|stream| _ = stream.accept(sample(0, 1.0)));
    streams[0].stray(SECOND, LATE);
    assert_eq!(streams[0], streams[1]);
    streams.iter_mut().zip([1.0, 2.0]).for_each(|(stream, x)| _ = stream.accept(sample(1, x)));
    assert_ne!(streams[0], streams[1]);
    streams.iter_mut().for_each(|stream| _ = stream.accept(sample(2, 1.0)));
    // the same sample now, but once more in a row
    assert_ne!(streams[0], streams[1]);
}

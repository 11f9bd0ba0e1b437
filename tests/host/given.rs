//! A calibration that was given with a standard deviation: the first headings err as their sigma says, with a gyroscope and
//! without, at rest and turning.

use magcomp::nalgebra::{Matrix3, Rotation3, Vector3};
use magcomp::{
    Calibration, Compensator, Config, Event, KeptCalibration, MagneticSample, Reading, RotationRateSample, UpSample,
};
use magcomp_tests::{METHODS, REF, Random, calibration};

const RUNS: u64 = 200;
const FIELD_UT: Vector3<f64> = Vector3::new(0.0, 24.0, -41.0);
/// Samples at which the heading is looked at; the first is the first with gravity.
const AT: [usize; 4] = [0, 20, 100, 300];

struct Run {
    gyroscope: bool,
    turning: bool,
    sigma_ut: f64,
    seed: u64,
}

impl Run {
    /// What is said at [`AT`], and the true heading there.
    fn readings(&self) -> Vec<(Reading, f64)> {
        let mut random = Random::new(9000 + self.seed);
        let truth = calibration(&REF.map(|v| v * 0.5 + 0.5 * f64::from(u8::from(v > 0.9))), FIELD_UT.norm());
        let off_ut = random.normal3() * self.sigma_ut;
        let given =
            Calibration::new(*truth.soft_iron(), truth.hard_iron_ut() + off_ut, truth.field_strength_ut()).unwrap();
        // half of them at once, half in the stream
        let at_once = self.seed.is_multiple_of(2);
        let config = Config { initial: at_once.then_some(given), initial_sigma_ut: self.sigma_ut, ..Config::default() };
        let mut compensator = Compensator::new(config).unwrap();
        let (yaw, tilt) = (random.between(-3.1, 3.1), random.normal3() * 0.3);
        let attitude = |t: f64| {
            let turned = if self.turning { 1.5 * t } else { 0.0 };
            let sway = if self.turning { 0.5 * (3.0 * t).sin() } else { 0.0 };
            Rotation3::from_axis_angle(&Vector3::z_axis(), yaw + turned)
                * Rotation3::new(Vector3::new(tilt.x + sway, tilt.y, 0.0))
        };
        let mut seen = Vec::new();
        let before = if at_once { 0 } else { 50 };
        for k in 0..before + 301 {
            let (time_ns, t) = ((k as i64 + 1) * 10_000_000, k as f64 * 0.01);
            let to_device = attitude(t).inverse();
            if self.gyroscope {
                let rate = (attitude(t - 0.005).inverse() * attitude(t + 0.005)).scaled_axis() / 0.01;
                let rate_rad_s = rate + random.normal3() * 0.003;
                compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s }).unwrap();
            }
            let up_m_s2 = to_device * Vector3::new(0.0, 0.0, 9.81) + random.normal3() * 0.02;
            compensator.push_up(UpSample { time_ns, up_m_s2 }).unwrap();
            if k == before && !at_once {
                compensator.adopt(&KeptCalibration::given(given, self.sigma_ut).unwrap(), None);
            }
            let field_ut = truth.distort(&(to_device * FIELD_UT)) + random.normal3() * 0.5;
            let reading = compensator.push(MagneticSample { time_ns, field_ut });
            if k >= before && AT.contains(&(k - before)) {
                let top = attitude(t) * Vector3::y();
                seen.push((reading, top.x.atan2(top.y).to_degrees()));
            }
        }
        seen
    }
}

#[test]
fn the_first_headings_err_as_their_sigma_says() {
    let mut wrong = Vec::new();
    for (gyroscope, turning) in [(true, false), (true, true), (false, false), (false, true)] {
        for sigma_ut in [4.0, 8.0] {
            let mut within = [[0_u64; 2]; AT.len()];
            let mut mean_deg = [0.0; AT.len()];
            let mut changes = 0;
            for seed in 0..RUNS {
                let run = Run { gyroscope, turning, sigma_ut, seed };
                for (at, (reading, true_deg)) in run.readings().into_iter().enumerate() {
                    let heading = reading.heading.expect("a calibration and gravity");
                    let sigma_deg = heading.heading_sigma_deg.expect("known");
                    let off_deg = ((heading.heading_deg - true_deg + 540.0).rem_euclid(360.0) - 180.0).abs();
                    mean_deg[at] += sigma_deg / RUNS as f64;
                    for (sigmas, count) in within[at].iter_mut().enumerate() {
                        *count += u64::from(off_deg < (sigmas as f64 + 1.0) * sigma_deg);
                    }
                    let event: Option<Event> = reading.event;
                    changes += u64::from(at == AT.len() - 1 && event.is_some());
                }
            }
            let shares = within.map(|counts| counts.map(|count| count as f64 / RUNS as f64));
            let run = format!("gyroscope {gyroscope}, turning {turning}, {sigma_ut} uT");
            println!(
                "{run}: within one and two {shares:?}, sigma \
                 {mean_deg:.1?} deg, {changes} changes told"
            );
            for (at, [one, two]) in AT.iter().zip(shares) {
                // 68 and 95 %, three standard deviations of 200 runs either way, and some points for a b that is off by a third of
                // the horizontal field. While it learns, sigma is too wide: docs/LIMITS.md.
                let learns = turning && *at > 0;
                // sigma also allows for frames of the sensors that differ, which these do not
                let most = if learns { [1.0, 1.0] } else { [0.88, 1.0] };
                if !(0.57..=most[0]).contains(&one) || !(0.86..=most[1]).contains(&two) {
                    wrong.push(format!("{run}, sample {at}: {one} {two}"));
                }
            }
            let shrinks = mean_deg[AT.len() - 1] < 0.5 * mean_deg[0];
            if shrinks != turning || changes > 0 {
                wrong.push(format!("{run}: sigma {mean_deg:?}, {changes} changes told"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn what_is_given_without_a_standard_deviation_in_range_is_refused() {
    let given = Calibration::new(Matrix3::identity(), Vector3::new(1.0, 2.0, 3.0), 48.0).unwrap();
    for sigma_ut in [0.0, -1.0, 1e9, f64::NAN] {
        for error in [KeptCalibration::given(given, sigma_ut), KeptCalibration::system(given, sigma_ut)] {
            let error = error.unwrap_err();
            assert_eq!((error.field, error.expected.as_str()), ("hard_iron_sigma_ut", "0.01 to 1000.0 uT"));
        }
    }
    for method in METHODS {
        let mut compensator = Compensator::new(Config { method, ..Config::default() }).unwrap();
        compensator.adopt(&KeptCalibration::given(given, 0.01).unwrap(), None);
        assert_eq!(compensator.calibration(), Some(given));
    }
}

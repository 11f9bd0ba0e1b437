//! What gravity says of the gyroscope's bias, with no magnet in it: a filter of u, gravity in the device frame in g, and of the bias b, rad/s.
//!
//! ```text
//! ten times a second:   u <- exp([G b]x) R u,   R: turn as read,   G <- R' G + dt I: what b adds to the turn;   u walks as the gyroscope does
//! a = u + n,   a: mean of the accelerometer meanwhile, turned to the latest sample, in g,   n ~ r / (0.1 s)
//! r = 2 max(mean, latest) of T (|change across u|^2 / 4 - P_bb T^2 / 2)     change: of the mean over T to the next, turned likewise
//! ```
//! What motion adds to gravity has no mean in the world for long, since speeds are bounded: it counts as white, with the density that it has at 1 / T. Changes
//! of the mean tell that, not what it differs from u by: a wrong u would have r grow until it stays wrong. Gravity shows nothing of a bias about the vertical;
//! the device turns, and so all axes are shown in time.
//!
//! Beforehand the device may be in a vehicle, whose accelerations last: that counts as a first change. The estimator is told the gain in information of b. Scale and axes of the gyroscope are not estimated here: what they
//! add goes one way for ten seconds, and counts as noise of the turn.

use super::pairing::{BiasInformation, Rotation};
use super::tilt::GRAVITY_M_S2;
use crate::math::gaussian::{Gaussian, Part};
use crate::math::turn::Turn;
use crate::priors::{BIAS_SD_RAD_S, GYROSCOPE_AXES, OUTLYING, SETTLED_S};
use nalgebra::{Matrix3, SMatrix, Vector3};

/// Data sheet: angle random walk of a gyroscope, rad/s^0.5: 1e-4 to 3e-4.
pub(crate) const ANGLE_WALK_RAD: f64 = 3e-4;
/// Choice: random walk of its bias as it warms, rad/s^1.5.
pub(crate) const BIAS_WALK_RAD_S: f64 = 5e-5;
/// Choice: share of gravity below which an accelerometer falls with the device, and shows no vertical.
pub(crate) const LEAST_PULL: f64 = 0.5;
/// Choice: the accelerometer is gathered for so long, s.
const GATHERED_S: f64 = 0.1;
/// Choice: T, s; the estimator is told as often.
const WINDOW_S: f64 = 0.5 * SETTLED_S;
/// Choice: so many changes of the mean are remembered: 20 s.
const WINDOWS: f64 = 8.0;
/// Choice: for so long the device turns one way, and what scale and axes of the gyroscope add does, too, s.
const LASTS_S: f64 = 2.0 * SETTLED_S;
/// Choice: half of r before anything is seen, g^2 s: a vehicle, which speeds up and brakes by 0.1 g for some seconds.
const VEHICLE_G2_S: f64 = 0.06;
/// Data sheet: least r, g^2 s: an accelerometer that drifts by 1e-2 g over a second.
const LEAST_G2_S: f64 = 1e-4;
/// Choice: variance of a first look at gravity, the least, g^2.
const FIRST_G2: f64 = 0.25;
/// Mathematics: variance of u where nothing is known of it, g^2.
const UNKNOWN_G2: f64 = 1.0;

// u and the bias
/// Mathematics: variance that rounding can carry.
const UP: Part<3> = Part::first(1e-12);
/// Mathematics: likewise.
const BIAS: Part<3> = UP.then(1e-14);

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gravity {
    known: Gaussian<6>,
    gathered: Gathered,
    motion: Motion,
    told: BiasInformation,
    told_s: f64,
}

/// Turns and accelerations since the latest measurement.
#[derive(Clone, Debug, PartialEq)]
struct Gathered {
    turn: Matrix3<f64>,
    by_bias: Matrix3<f64>,
    /// Variance of the turn per axis, rad^2.
    turn_rad2: f64,
    seconds: f64,
    /// Sum of the accelerometer times seconds, in g.
    up: Vector3<f64>,
    up_s: f64,
}

/// How much of what the accelerometer reads is motion: changes of its mean from window to window.
#[derive(Clone, Debug, PartialEq)]
struct Motion {
    /// The window in the making, and the mean of the one before.
    window: Vector3<f64>,
    seconds: f64,
    before: Option<Vector3<f64>>,
    /// Changes, the one that is believed beforehand among them.
    count: f64,
    /// r / 2: mean, and of the latest change, g^2 s.
    density: f64,
    latest: f64,
    /// a - u, low-passed over five seconds.
    off: Vector3<f64>,
}

impl Default for Motion {
    fn default() -> Self {
        Self {
            window: Vector3::zeros(),
            seconds: 0.0,
            before: None,
            count: 1.0,
            density: VEHICLE_G2_S,
            latest: 0.0,
            off: Vector3::zeros(),
        }
    }
}

impl Default for Gathered {
    fn default() -> Self {
        Self {
            turn: Matrix3::identity(),
            by_bias: Matrix3::zeros(),
            turn_rad2: 0.0,
            seconds: 0.0,
            up: Vector3::zeros(),
            up_s: 0.0,
        }
    }
}

impl Default for Gravity {
    fn default() -> Self {
        let mut known = Gaussian::default();
        known.add_variance(UP, UNKNOWN_G2);
        known.add_variance(BIAS, BIAS_SD_RAD_S.powi(2));
        Self {
            known,
            gathered: Gathered::default(),
            motion: Motion::default(),
            told: BiasInformation::default(),
            told_s: 0.0,
        }
    }
}

impl Gravity {
    /// One sample: the rotation since the one before, how long it took, s, and what the accelerometer reads, m/s^2. What is new of the bias, now and then.
    pub fn see(&mut self, rotation: &Rotation, span_s: f64, up_m_s2: Option<&Vector3<f64>>) -> Option<BiasInformation> {
        let it = &mut self.gathered;
        let turn = Turn::by(&-rotation.increment_rad).rotation;
        it.turn = turn * it.turn;
        it.by_bias = turn * it.by_bias + Matrix3::from_diagonal_element(span_s);
        let by_axes = GYROSCOPE_AXES.powi(2) * rotation.increment_rad.norm_squared() / span_s * LASTS_S;
        it.turn_rad2 += ANGLE_WALK_RAD.powi(2) * span_s + rotation.variance_rad2 + by_axes;
        it.seconds += span_s;
        it.up = turn * it.up;
        if let Some(up) = up_m_s2.map(|up| up / GRAVITY_M_S2).filter(|up| up.norm() >= LEAST_PULL) {
            it.up += up * span_s;
            it.up_s += span_s;
        }
        if it.seconds < GATHERED_S {
            return None;
        }
        let gathered = std::mem::take(it);
        self.predict(&gathered);
        if gathered.up_s > 0.0 {
            self.measure(gathered.up / gathered.up_s, gathered.up_s);
        }
        self.told_s += gathered.seconds;
        (self.told_s >= WINDOW_S).then(|| {
            self.told_s = 0.0;
            std::mem::take(&mut self.told)
        })
    }

    /// The chain of rotations broke: where up is, is lost.
    pub fn pause(&mut self) {
        self.lose_up();
        (self.gathered, self.motion) = (Gathered::default(), Motion::default());
    }

    fn lose_up(&mut self) {
        self.known.set_part(UP, &Vector3::zeros());
        self.known.isolate(UP, &Matrix3::from_diagonal_element(UNKNOWN_G2));
    }

    fn predict(&mut self, gathered: &Gathered) {
        let own = Turn::by(&(gathered.by_bias * self.known.part(BIAS)));
        let turn = own.rotation * gathered.turn;
        let u = turn * self.known.part(UP);
        self.known.set_part(UP, &u);
        let mut f = SMatrix::<f64, 6, 6>::identity();
        UP.block_mut(&mut f).copy_from(&turn);
        let by_bias = -(u.cross_matrix() * own.left_jacobian * gathered.by_bias);
        f.fixed_view_mut::<3, 3>(UP.start(), BIAS.start()).copy_from(&by_bias);
        self.known.covariance = f * self.known.covariance * f.transpose();
        let across = Matrix3::from_diagonal_element(u.norm_squared()) - u * u.transpose();
        self.known.add(UP, &(across * gathered.turn_rad2));
        self.known.add_variance(BIAS, BIAS_WALK_RAD_S.powi(2) * gathered.seconds);
        self.motion.turn(&turn);
    }

    fn measure(&mut self, a: Vector3<f64>, seconds: f64) {
        let density = self.motion.see(&a, seconds, self.known.variances(BIAS).sum() / 3.0);
        let p = self.known.own(UP);
        if p.trace() >= UNKNOWN_G2 {
            let first = (a.norm() - 1.0).powi(2).max(FIRST_G2);
            self.known.set_part(UP, &a);
            self.known.isolate(UP, &Matrix3::from_diagonal_element(first));
            return;
        }
        let u = self.known.part(UP);
        if self.motion.is_off(&(a - u), &u, &p, density, seconds) {
            return self.lose_up();
        }
        let before = self.known.own(BIAS).try_inverse().map(|it| (it, it * self.known.part(BIAS)));
        let Some(l) = (p + Matrix3::from_diagonal_element(density / seconds)).cholesky().map(|it| it.unpack()) else {
            return;
        };
        let Some(l_inverse) = l.solve_lower_triangular(&Matrix3::identity()) else { return };
        self.known.correct(self.known.columns(UP) * l_inverse.transpose(), &(l_inverse * (a - u)), &[]);
        self.known.raise(UP);
        self.known.raise(BIAS);
        let after = self.known.own(BIAS).try_inverse().map(|it| (it, it * self.known.part(BIAS)));
        if let (Some(before), Some(after)) = (before, after) {
            self.told.precision += after.0 - before.0;
            self.told.weighted += after.1 - before.1;
        }
    }
}

impl Motion {
    fn turn(&mut self, turn: &Matrix3<f64>) {
        for vector in [&mut self.window, &mut self.off] {
            *vector = turn * *vector;
        }
        self.before = self.before.map(|it| turn * it);
    }

    /// A mean of the accelerometer, in g, over so many seconds, where the bias has this variance: r, g^2 s.
    fn see(&mut self, a: &Vector3<f64>, seconds: f64, bias_variance: f64) -> f64 {
        self.window += a * seconds;
        self.seconds += seconds;
        if self.seconds + 0.5 * seconds >= WINDOW_S {
            let (mean, length_s) = (self.window / self.seconds, self.seconds);
            (self.window, self.seconds) = (Vector3::zeros(), 0.0);
            if let Some(before) = self.before.replace(mean)
                && let Some(up) = (mean + before).try_normalize(LEAST_PULL)
            {
                let drifted = bias_variance * length_s * length_s;
                self.latest = 0.5 * length_s * (across(&(mean - before), &up) - drifted).max(0.0);
                self.count += 1.0;
                self.density += (self.latest - self.density) / self.count.min(WINDOWS);
            }
        }
        2.0 * self.density.max(self.latest) + LEAST_G2_S
    }

    /// Whether u has been wrong for long.
    fn is_off(&mut self, off: &Vector3<f64>, u: &Vector3<f64>, p: &Matrix3<f64>, density: f64, seconds: f64) -> bool {
        self.off += (off - self.off) * (seconds / SETTLED_S);
        let Some(up) = u.try_normalize(0.5) else { return false };
        let expected = 0.5 * (p.trace() - up.dot(&(p * up))) + density / (2.0 * SETTLED_S);
        across(&self.off, &up) > OUTLYING * OUTLYING * expected
    }
}

/// Mean square of a vector across another of length 1, per axis.
fn across(v: &Vector3<f64>, up: &Vector3<f64>) -> f64 {
    0.5 * (v.norm_squared() - v.dot(up).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, UnitQuaternion};

    const DT_S: f64 = 0.01;
    const TRUE_BIAS: Vector3<f64> = Vector3::new(0.03, -0.02, 0.01);

    /// White noise of standard deviation 1, the same in every run.
    struct Noise(u64);

    impl Noise {
        fn next(&mut self) -> f64 {
            let uniform = || {
                self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            };
            std::iter::repeat_with(uniform).take(12).sum::<f64>() - 6.0
        }

        fn vector(&mut self) -> Vector3<f64> {
            Vector3::from_fn(|_, _| self.next())
        }
    }

    /// A device that turns at `rate` for so long, its gyroscope off by the bias, moved by white accelerations of `motion` g s^0.5; what was told in all.
    fn turned(
        gravity: &mut Gravity,
        seconds: f64,
        motion: f64,
        rate: impl Fn(f64) -> Vector3<f64>,
    ) -> (BiasInformation, UnitQuaternion<f64>) {
        let (mut noise, mut told) = (Noise(7), BiasInformation::default());
        let mut attitude = UnitQuaternion::identity();
        for k in 0..(seconds / DT_S) as usize {
            let rate = rate(k as f64 * DT_S);
            attitude *= UnitQuaternion::from_scaled_axis(rate * DT_S);
            let read = rate + TRUE_BIAS + noise.vector() * (ANGLE_WALK_RAD / DT_S.sqrt());
            let moved = noise.vector() * (motion / DT_S.sqrt());
            let up = attitude.inverse() * (Vector3::z() + moved) * GRAVITY_M_S2;
            let rotation = Rotation { increment_rad: read * DT_S, rate_rad_s: read, variance_rad2: 0.0 };
            if let Some(new) = gravity.see(&rotation, DT_S, Some(&up)) {
                told.precision += new.precision;
                told.weighted += new.weighted;
            }
        }
        (told, attitude)
    }

    fn by_hand(t: f64) -> Vector3<f64> {
        Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin()) * 0.6
    }

    #[test]
    fn a_device_that_is_turned_about_shows_its_bias_and_what_is_told_is_all_of_it() {
        let mut gravity = Gravity::default();
        let (told, attitude) = turned(&mut gravity, 120.0, 0.03, by_hand);
        let (off, p) = (gravity.known.part(BIAS) - TRUE_BIAS, gravity.known.own(BIAS));
        let z2 = off.dot(&(p.try_inverse().unwrap() * off));
        // chi-squared of three: 99.9 % are below 16
        assert!(z2 < 16.0 && (0.002..0.01).contains(&p.trace().sqrt()), "{off} {z2} {}", p.trace().sqrt());
        assert!((gravity.known.part(UP) - attitude.inverse() * Vector3::z()).norm() < 0.1);
        // what was told is what the prior lacks, but for the walk of the bias and what is not yet told
        let prior = Matrix3::from_diagonal_element(BIAS_SD_RAD_S.powi(-2));
        let all = (told.precision + prior).try_inverse().unwrap();
        assert!((all * told.weighted - TRUE_BIAS).norm() < 0.01);
        let ratio = p.trace() / all.trace();
        assert!((0.9..2.0).contains(&ratio), "{ratio}");
    }

    /// By an independent way: the same samples, fitted at once, by least squares.
    #[test]
    fn the_filter_is_as_good_as_a_fit_of_all_samples() {
        let mut gravity = Gravity::default();
        turned(&mut gravity, 90.0, 0.02, by_hand);
        let (mut noise, mut attitude, mut turn) = (Noise(7), UnitQuaternion::identity(), Rotation3::identity());
        let mut by_bias = Matrix3::zeros();
        let (mut normal, mut right) = (SMatrix::<f64, 6, 6>::zeros(), nalgebra::SVector::<f64, 6>::zeros());
        for k in 0..9000 {
            let rate = by_hand(k as f64 * DT_S);
            attitude *= UnitQuaternion::from_scaled_axis(rate * DT_S);
            let read = rate + TRUE_BIAS + noise.vector() * (ANGLE_WALK_RAD / DT_S.sqrt());
            let up = attitude.inverse() * (Vector3::z() + noise.vector() * (0.02 / DT_S.sqrt()));
            // about the true bias: far from it gravity is not linear in it
            let step = Rotation3::from_scaled_axis((TRUE_BIAS - read) * DT_S);
            turn = step * turn;
            by_bias = step * by_bias + Matrix3::from_diagonal_element(DT_S);
            // up = exp([G b]x) R u0
            let mut j = SMatrix::<f64, 3, 6>::zeros();
            j.fixed_view_mut::<3, 3>(0, 0).copy_from(turn.matrix());
            j.fixed_view_mut::<3, 3>(0, 3).copy_from(&-((turn * Vector3::z()).cross_matrix() * by_bias));
            normal += j.transpose() * j;
            right += j.transpose() * up;
        }
        let fitted = normal.try_inverse().unwrap() * right;
        let off = gravity.known.part(BIAS) - TRUE_BIAS - fitted.fixed_rows::<3>(3);
        // scale and axes, which it allows for and which are right here, make it follow less
        assert!(off.norm() < 0.012, "{off} {fitted}");
    }

    #[test]
    fn turns_about_the_vertical_show_nothing_of_a_bias_about_it() {
        let mut gravity = Gravity::default();
        let (told, _) = turned(&mut gravity, 90.0, 0.01, |t| Vector3::z() * (0.5 * t).sin());
        let sd = |axis: usize| gravity.known.own(BIAS)[(axis, axis)].sqrt();
        assert!(sd(2) > 0.9 * BIAS_SD_RAD_S && sd(0) < 0.2 * BIAS_SD_RAD_S, "{} {}", sd(2), sd(0));
        assert!(told.precision[(2, 2)] < 0.05 * told.precision[(0, 0)]);
    }

    #[test]
    fn a_break_of_the_chain_loses_up_and_keeps_the_bias() {
        let mut gravity = Gravity::default();
        turned(&mut gravity, 30.0, 0.02, by_hand);
        let (bias, p) = (gravity.known.part(BIAS), gravity.known.own(BIAS));
        gravity.pause();
        assert_eq!((gravity.known.part(BIAS), gravity.known.own(BIAS)), (bias, p));
        assert_eq!(gravity.known.own(UP), Matrix3::identity() * UNKNOWN_G2);
    }

    /// The density of what motion adds, from changes of the mean, whatever u is.
    #[test]
    fn the_density_of_the_motion_is_found() {
        for motion in [0.02, 0.06] {
            let mut gravity = Gravity::default();
            turned(&mut gravity, 120.0, motion, by_hand);
            let ratio = gravity.motion.density / (0.5 * motion * motion);
            assert!((0.4..2.5).contains(&ratio), "{motion}: {ratio}");
        }
    }

    /// A push at the first sample makes u wrong by half a radian: it is found out, and the bias does not follow for long.
    #[test]
    fn a_wrong_first_look_is_found_out() {
        let mut gravity = Gravity::default();
        let still = Rotation { increment_rad: Vector3::zeros(), rate_rad_s: Vector3::zeros(), variance_rad2: 0.0 };
        for _ in 0..11 {
            gravity.see(&still, DT_S, Some(&(Vector3::new(0.5, 0.0, 0.85) * GRAVITY_M_S2)));
        }
        turned(&mut gravity, 90.0, 0.02, by_hand);
        let off = gravity.known.part(BIAS) - TRUE_BIAS;
        assert!(off.norm() < 0.015, "{off}");
    }
}

//! Disturbed or changed? In the frame of the device a change of the device is constant, one of the place turns; and gravity
//! says how the device is turned. While a change is undecided two small filters compete on the samples as the calibration
//! from before corrects them, c = T (u - beta) (field strengths), with n = c / |c| and `up` (unit vector):
//!     place:   |c| = 1 + f,  up.c = v + w                             unknown f, w: another field, the same calibration
//!     device:  |c - d| = 1,  up.(c - d) = v                           unknown d: the same field, b moved by d
//! v, the vertical part, is learned while nothing is in doubt and the device is turned. Both unknowns walk, quickly at first: a
//! change may take half a second. Each sums its log likelihood, -(z^2 / S + log S) / 2; their difference decides. Without `up` the
//! magnitude alone does, later. The vertical part's error is that of `aided/magnitude`.

use super::noise::Noise;
use super::parameters::{Vector9, centre, see, shape};
use super::{Adaptive, Trial};
use crate::estimator::aided::magnitude::{TILT_CORRELATION, TILT_SD};
use crate::reading::ModelOrder;
use crate::snapshot::{checked, is_covariance};
use nalgebra::{SMatrix, SVector, Vector3};
use serde::{Deserialize, Serialize};

/// Gravity, m/s^2.
const GRAVITY_M_S2: f64 = 9.806_65;
/// How much another place differs, and b after a change, before anything is seen: field strengths.
const PLACE_SD: f64 = 0.4;
const DEVICE_SD: f64 = 0.6;
/// A change takes so long, s, and moves so far in it; from then on things walk this much per square root of a second.
const RAMP_S: f64 = 0.5;
const RAMP_SD: f64 = 0.5;
const WALK: f64 = 0.03;
/// Difference of the log likelihoods that decides, and what is kept of it at most.
const DECIDED: f64 = 4.0;
const LARGEST: f64 = 20.0;
/// Without a decision new parameters wait no longer than this, s.
const UNDECIDED_S: f64 = 3.0;
/// A place that differs by less than this, beyond a room's own unevenness and what v is uncertain by, field strengths, is the one from before.
const NOTICEABLE: f64 = 0.03;
/// So is one with this share of the largest difference there was: the calibration may have moved a little with it.
const REMAINDER: f64 = 0.25;
/// So long it must be that again, s.
const BACK_S: f64 = 0.2;
/// Samples over which the curvature of |c - d| stays the same error.
const BEND_CORRELATION: f64 = 2.0;
/// Mean z^2 / S above which a hypothesis does not fit, and its memory, measurements.
const FITS: f64 = 3.0;
const MEMORY: f64 = 20.0;
/// z^2 / S of a spike.
const SPIKE: f64 = 25.0;
/// A place that has changed for so long is the new one, s, as for the aided method.
const NEW_PLACE_S: f64 = 30.0;
/// Direction error (rad^2), that of 3 deg, above which a calibration is no witness: its own error turns with the device, too.
const KNOWN_RAD2: f64 = 0.003;
/// Standard deviation of v at the start, below which it is known, and its walk per square root of a second.
const VERTICAL_SD: f64 = 1.0;
const VERTICAL_KNOWN: f64 = 0.05;
const VERTICAL_WALK: f64 = 0.005;

/// A hypothesis: a few unknowns by a Kalman filter, and how likely it has made the samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
struct Filter<const N: usize> {
    x: SVector<f64, N>,
    p: SMatrix<f64, N, N>,
    log: f64,
    /// Mean of z^2 / S.
    misfit: f64,
    count: f64,
}

checked!(Filter<const N>, |it| is_covariance(&it.p) && it.misfit >= 0.0 && it.count >= 1.0);

/// A measurement of a hypothesis: innovation z, gradient, variance; and the share of a white error in that.
struct Row<const N: usize>(f64, SVector<f64, N>, f64, f64);

impl<const N: usize> Filter<N> {
    fn new(sd: f64) -> Self {
        Self { x: SVector::zeros(), p: SMatrix::from_diagonal_element(sd * sd), log: 0.0, misfit: 1.0, count: 1.0 }
    }

    fn walk(&mut self, variance: f64) {
        (0..N).for_each(|i| self.p[(i, i)] += variance);
    }

    fn expected(&self, row: &Row<N>) -> (SVector<f64, N>, f64) {
        let pg = self.p * row.1;
        (pg, row.1.dot(&pg) + row.2)
    }

    fn square(&self, row: &Row<N>) -> f64 {
        row.0 * row.0 / self.expected(row).1
    }

    fn take(&mut self, row: &Row<N>) {
        let (pg, s) = self.expected(row);
        let square = (row.0 * row.0 / s).min(SPIKE);
        // correlated samples are fewer, in the likelihood too
        let white = s - row.2 * (1.0 - row.3);
        self.log -= 0.5 * row.3 * ((row.0 * row.0 / white).min(SPIKE) + white.ln());
        self.count = (self.count + 1.0).min(MEMORY);
        self.misfit += (square - self.misfit) / self.count;
        self.x += pg * (row.0 / s);
        self.p -= pg * pg.transpose() / s;
    }
}

/// A change that is not decided yet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
struct Doubt {
    /// Names the change.
    change_ns: i64,
    since_ns: i64,
    latest_ns: i64,
    /// The calibration from before, its expected direction error, rad^2, and variance of white noise of the same weight and the share of it that is white.
    tau: Vector9,
    known: f64,
    noise: (f64, f64),
    noticeable: f64,
    largest: f64,
    place: Filter<2>,
    device: Filter<3>,
    levelled: bool,
    /// The filters began anew: another change on top.
    began_ns: i64,
    /// It has been the place's at some time.
    declared: bool,
    /// The filters have begun anew since.
    renewed: bool,
    /// Since when the field is what it was.
    back_ns: Option<i64>,
}

checked!(Doubt, |it| it.noise.0 > 0.0 && (0.0..=1.0).contains(&it.noise.1) && it.known >= 0.0 && it.largest >= 0.0);

/// See the module.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Witness {
    up_m_s2: Option<Vector3<f64>>,
    /// v and its variance.
    vertical: f64,
    variance: f64,
    /// Expected direction error when nothing was in doubt, rad^2.
    known: f64,
    latest_ns: Option<i64>,
    doubt: Option<Doubt>,
}

checked!(Witness, |it| it.variance >= 0.0 && it.known >= 0.0);

/// A sample as the calibration corrects it: c, its size, variance of the size, of the vertical part, and `up`.
struct Corrected {
    c: Vector3<f64>,
    size: f64,
    variance: f64,
    white: f64,
    level: Option<(Vector3<f64>, f64, f64)>,
}

impl Witness {
    pub fn new() -> Self {
        let variance = VERTICAL_SD * VERTICAL_SD;
        Self { up_m_s2: None, vertical: 0.0, variance, known: f64::MAX, latest_ns: None, doubt: None }
    }

    /// What the accelerometer says with the next sample.
    pub fn level(&mut self, up_m_s2: Option<Vector3<f64>>) {
        self.up_m_s2 = up_m_s2;
    }

    /// Unit vector; `None` without an accelerometer.
    pub fn up(&self) -> Option<Vector3<f64>> {
        self.up_m_s2?.try_normalize(0.1 * GRAVITY_M_S2)
    }

    fn corrected(&self, tau: &Vector9, u: &Vector3<f64>, (noise, white): (f64, f64)) -> Option<Corrected> {
        let seen = see(tau, u)?;
        let c = shape(tau) * (u - centre(tau));
        let variance = noise * seen.slope * seen.slope;
        let level = self.up_m_s2.zip(self.up()).map(|(up_m_s2, up)| {
            let size_g = up_m_s2.norm() / GRAVITY_M_S2;
            let tilt = TILT_SD.powi(2) + (size_g - 1.0).powi(2);
            let tilted = ((c - up * up.dot(&c)).norm_squared() + 0.01) * tilt;
            let lasting = variance + TILT_CORRELATION * tilted;
            (up, lasting, (white * variance + tilted) / lasting)
        });
        Some(Corrected { c, size: seen.radius, variance, white, level })
    }

    /// One sample u; `doubtful` since when a change is undecided, `known` the expected direction error of what is in force (rad^2).
    pub fn look(
        &mut self,
        time_ns: i64,
        u: &Vector3<f64>,
        tau: &Vector9,
        known: f64,
        doubtful: Option<i64>,
        noise: &Noise,
    ) {
        let seconds =
            self.latest_ns.map_or(0.0, |latest| time_ns.saturating_sub(latest) as f64 * 1e-9).clamp(0.0, 10.0);
        self.latest_ns = Some(time_ns);
        self.variance = (self.variance + VERTICAL_WALK * VERTICAL_WALK * seconds).min(VERTICAL_SD * VERTICAL_SD);
        let uneven = noise.unevenness();
        // correlated errors as white ones of the same weight
        let weighed = noise.variance * noise.correlation();
        let noise = (weighed, noise.total().min(weighed) / weighed);
        let Some(change_ns) = doubtful else {
            (self.doubt, self.known) = (None, known);
            if known < KNOWN_RAD2
                && let Some(Corrected { c, level: Some((up, variance, _)), .. }) = self.corrected(tau, u, noise)
            {
                let s = self.variance + variance + known;
                let z = up.dot(&c) - self.vertical;
                if z * z < SPIKE * s {
                    self.vertical += self.variance / s * z;
                    self.variance -= self.variance * self.variance / s;
                }
            }
            return;
        };
        self.doubt = self.doubt.filter(|doubt| doubt.change_ns == change_ns);
        // what is in doubt now was known that well before
        let known = self.known;
        if self.doubt.is_none() && known < KNOWN_RAD2 {
            self.doubt = Some(Doubt {
                noticeable: NOTICEABLE + uneven + self.variance.sqrt(),
                change_ns,
                ..Doubt::new(time_ns, tau, known, noise)
            });
        }
        let Some(mut doubt) = self.doubt else { return };
        if let Some(corrected) = self.corrected(&doubt.tau, u, doubt.noise) {
            let vertical = (self.variance < VERTICAL_KNOWN * VERTICAL_KNOWN).then_some((self.vertical, self.variance));
            doubt.compare(time_ns, seconds, &corrected, vertical);
        }
        if doubt.age_s() > NEW_PLACE_S {
            self.variance = VERTICAL_SD * VERTICAL_SD;
        }
        self.doubt = Some(doubt);
    }

    /// Coordinates move.
    pub fn shift(&mut self, by: &Vector3<f64>) {
        if let Some(doubt) = &mut self.doubt {
            (0..3).for_each(|i| doubt.tau[6 + i] += by[i]);
        }
    }

    /// Since when the place is another one, where that is what the samples say.
    pub fn disturbed(&self) -> Option<i64> {
        let doubt = self.doubt.as_ref().filter(|doubt| doubt.declared && doubt.ratio() < 0.0)?;
        Some(doubt.since_ns).filter(|_| doubt.age_s() < NEW_PLACE_S)
    }

    /// Whether new parameters have to wait: it may be the place.
    pub fn holds(&self, order: ModelOrder) -> bool {
        let waiting = |doubt: &Doubt| doubt.age_s() < NEW_PLACE_S && doubt.holds();
        order != ModelOrder::Nothing && self.doubt.as_ref().is_some_and(waiting)
    }

    /// Whether a disturbed place has become what it was; asked once.
    pub fn is_back(&mut self) -> bool {
        let back =
            |doubt: &Doubt| doubt.back_ns.is_some_and(|at| doubt.latest_ns.saturating_sub(at) as f64 > BACK_S * 1e9);
        let is_back = self.doubt.as_ref().is_some_and(back);
        if is_back {
            self.doubt = None;
        }
        is_back
    }
}

impl Doubt {
    fn new(since_ns: i64, tau: &Vector9, known: f64, noise: (f64, f64)) -> Self {
        let (place, device) = (Filter::new(PLACE_SD), Filter::new(DEVICE_SD));
        Self {
            change_ns: since_ns,
            since_ns,
            latest_ns: since_ns,
            tau: *tau,
            known,
            noise,
            noticeable: NOTICEABLE,
            largest: 0.0,
            place,
            device,
            levelled: false,
            began_ns: since_ns,
            declared: false,
            renewed: false,
            back_ns: None,
        }
    }

    fn age_s(&self) -> f64 {
        self.latest_ns.saturating_sub(self.since_ns) as f64 * 1e-9
    }

    /// Log likelihood of the device hypothesis less that of the place.
    fn ratio(&self) -> f64 {
        self.device.log - self.place.log
    }

    fn is_ramp(&self) -> bool {
        (self.latest_ns.saturating_sub(self.began_ns) as f64) < RAMP_S * 1e9
    }

    fn differs(&self) -> bool {
        self.place.x.amax() > self.noticeable.max(REMAINDER * self.largest)
    }

    fn is_place(&self) -> bool {
        self.ratio() < -DECIDED && self.place.misfit < FITS && self.differs()
    }

    /// New parameters have to wait.
    fn holds(&self) -> bool {
        let differs = self.is_ramp() || self.differs();
        let may_be_place = self.levelled && self.age_s() < UNDECIDED_S && self.place.misfit < FITS && differs;
        self.ratio() < DECIDED && (self.declared || may_be_place)
    }

    fn compare(&mut self, time_ns: i64, seconds: f64, at: &Corrected, vertical: Option<(f64, f64)>) {
        self.latest_ns = time_ns;
        let known = self.known;
        let ramp = self.is_ramp();
        let walked = if ramp { RAMP_SD * RAMP_SD / RAMP_S } else { WALK * WALK } * seconds;
        self.place.walk(walked);
        self.device.walk(walked);
        let h = at.c - self.device.x;
        let (size, Some(n)) = (h.norm(), h.try_normalize(1e-3)) else { return };
        // |c - d| bends upwards across n by |d - x|^2 / 2: its mean and variance
        let p = self.device.p;
        let across = p - (p * n) * n.transpose() - n * (n.transpose() * p) + n * n.transpose() * n.dot(&(p * n));
        let (lift, bend) = (across.trace() / (2.0 * size), across.norm_squared() / (2.0 * size * size));
        let level = at.level.as_ref().zip(vertical);
        let noise = at.variance + known;
        let place = Row(at.size - 1.0 - self.place.x[0], SVector::from([1.0, 0.0]), noise, at.white);
        // as long as the device points the same way it is the same error
        let device = Row(size + lift - 1.0, n, noise + BEND_CORRELATION * bend, at.white);
        if self.place.square(&place) > SPIKE && self.device.square(&device) > SPIKE {
            self.place.walk(RAMP_SD * RAMP_SD * 0.01);
            self.device.walk(RAMP_SD * RAMP_SD * 0.01);
            return;
        }
        let logs = (self.place.log, self.device.log);
        self.place.take(&place);
        self.device.take(&device);
        if BEND_CORRELATION * bend > noise {
            // d is hardly known yet: what that costs its likelihood is no evidence
            (self.place.log, self.device.log) = logs;
        }
        if let Some(((up, variance, white), (v, unsure))) = level {
            self.levelled = true;
            let z = up.dot(&at.c) - v;
            let noise = variance + known;
            self.place.take(&Row(z - self.place.x[1], SVector::from([0.0, 1.0]), noise, *white));
            self.device.take(&Row(z - up.dot(&self.device.x), *up, noise + unsure, *white));
        }
        let ratio = if ramp { 0.0 } else { self.ratio().clamp(-LARGEST, LARGEST) };
        (self.device.log, self.place.log) = (ratio, 0.0);
        self.declared |= self.is_place();
        if self.is_place() {
            self.largest = self.largest.max(self.place.x.amax());
        }
        // what contradicts an established place is likelier its end than a change of the device: both anew
        if self.declared && !self.renewed && self.ratio() > 0.0 {
            (self.place, self.device) = (Filter::new(PLACE_SD), Filter::new(DEVICE_SD));
            (self.began_ns, self.renewed) = (time_ns, true);
        }
        self.renewed &= !self.is_place();
        let back = self.declared && !ramp && self.place.misfit < FITS && !self.differs();
        self.back_ns = if back { self.back_ns.or(Some(time_ns)) } else { None };
    }
}

impl Adaptive {
    /// What gravity says with the next sample, m/s^2.
    pub fn level(&mut self, up_m_s2: Option<Vector3<f64>>) {
        self.witness.level(up_m_s2);
    }

    /// Whether it is the place that changed.
    pub(super) fn attest(&mut self, time_ns: i64, raw_ut: &Vector3<f64>, rests: bool) {
        let Some(published) = self.published else { return };
        // that nothing has changed may be released too early: it is no decision
        let open = |trial: &Trial| trial.base.is_some() && (!trial.released || self.order == ModelOrder::Nothing);
        let doubtful = self.trial.filter(open).map(|trial| trial.since_ns);
        if rests && doubtful.is_none() {
            // it has told of its place already
            self.witness.doubt = None;
            return;
        }
        let known = self.direction_sigma_deg.to_radians().powi(2);
        let u = self.unit(raw_ut);
        self.witness.look(time_ns, &u, &published.tau, known, doubtful, &self.noise);
        if self.witness.is_back()
            && let Some(Trial { base: Some(mut base), .. }) = self.trial
        {
            // what the samples of the disturbance say is not wanted
            base.shift(&((self.centre_ut - raw_ut) / self.unit_ut));
            self.move_centre(raw_ut);
            self.compete(time_ns, Some(base));
            self.samples.add(raw_ut);
            self.fit();
        }
    }
}

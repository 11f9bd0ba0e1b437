//! The numbers of the aided estimator that no application has a reason to set: unit, effect, and where each comes from.

/// Largest standard deviation to which steps may raise an element of M - I. Small: slow after
/// a soft iron step. Large: flexible hypotheses. The prototype: 0.10.
pub(super) const IRON_SD_MAX: f64 = 0.12;
/// Random walk of the delay, s per square root of a second. Constant for a device, but not exactly.
pub(super) const DELAY_WALK: f64 = 2e-5;
/// Random walk of the field of the place in the device frame beyond gyroscope noise, uT per square root of a second.
/// Large: the carried field follows the place sooner, is noisier. The prototype: 0.05.
pub(super) const FIELD_WALK_UT: f64 = 0.015;
/// What is left of the gyroscope's scale error once it is estimated (cross axis, timing), as noise in proportion to
/// the rate, square root of a second. Large: f is noisier.
pub(super) const SCALE_WALK: f64 = 0.001;
/// Random walk of the soft iron, per square root of a second. Small: never relearned without a step.
/// Large: noisier. The prototype: 5e-4.
pub(super) const IRON_WALK: f64 = 1e-4;
/// Least random walk of the hard iron, uT per square root of a second: what it falls to while nothing drifts.
/// 0.25 uT in a minute.
pub(super) const OFFSET_WALK_MIN_UT: f64 = 0.03;
/// Random walk of the hard iron at the start, uT per square root of a second. Small: drift is noticed late.
/// Large: a noisy first minute. The prototype: 0.4, always.
pub(super) const OFFSET_WALK_UT: f64 = 0.25;
/// Time over which corrections of the hard iron are gathered to judge its random walk, s. Small: noise is taken for
/// drift. Large: drift is noticed late.
pub(super) const OFFSET_WALK_TIME_S: f64 = 2.0;
/// Memory of the noise estimate, s. Small: it scatters. Large: a change is noticed late. A gain of 0.02 at 100 Hz.
pub(super) const NOISE_TIME_S: f64 = 0.5;
/// Correlation time of the local field, s: the time it takes to walk through an unevenness. Small: the
/// unevenness goes into m and b. Large: steps are swallowed for longer. The prototype.
pub(super) const LOCAL_TIME_S: f64 = 1.0;
/// Standard deviation of the local field at the start, uT. Small: an uneven room spoils the
/// first calibration. Large: it takes longer.
pub(super) const LOCAL_START_UT: f64 = 1.0;
/// Least standard deviation of the local field, uT.
pub(super) const LOCAL_MIN_UT: f64 = 0.01;
/// Jitter of the sample times, s: adds noise in proportion to the rate of turn.
pub(super) const JITTER_S: f64 = 0.001;
/// Gate on v^T S^-1 v (three degrees of freedom): a sample above it is not used. Small: good samples
/// lost, false suspicion. Large: spikes get in, steps are noticed late. 1 in 900.
pub(super) const GATE: f64 = 16.0;
/// Time constant of the share of gated samples, s. Small: a few spikes raise suspicion. Large: late.
pub(super) const GATED_TIME_S: f64 = 0.6;
/// Time constant with which that share falls while hypotheses run, s: how soon a disturbance is over.
/// Small: a chance fit ends it. Large: it is told for too long.
pub(super) const CLEAR_TIME_S: f64 = 0.25;
/// Share of gated samples below which the hypothesis "nothing happened" has won.
pub(super) const CLEAR_SHARE: f64 = 0.08;
/// Time since the onset before a hypothesis may win, s.
pub(super) const DECIDE_TIME_S: f64 = 0.4;
/// Log likelihood ratio at which a hypothesis wins. Small: eager. Large: late.
pub(super) const DECIDE_LOG_RATIO: f64 = 6.0;
/// Weight of a 10 ms sample's log likelihood: residuals of a real field are not white. The prototype.
pub(super) const LIKELIHOOD_WEIGHT: f64 = 0.2;
/// A hypothesis that explains less than this share of the recent samples (0.25 s) has failed.
pub(super) const FIT_SHARE: f64 = 0.5;
/// Both hypotheses failing for this long since the onset is `erratic`, s.
pub(super) const ERRATIC_TIME_S: f64 = 1.0;
/// Rotation without which a device step is not believed within an erratic field, rad.
pub(super) const ERRATIC_ROTATION_RAD: f64 = 1.5;
/// Standard deviation given to the gyroscope's bias when the field turns erratic, rad/s.
pub(super) const ERRATIC_BIAS_RAD_S: f64 = 0.03;
/// Time for which a hypothesis must hold to win within an erratic field, s.
pub(super) const ERRATIC_SETTLE_S: f64 = 3.0;
/// Standard deviation of an erratic field about the earth's, uT.
pub(super) const ERRATIC_SD_UT: f64 = 10.0;
/// Correlation time of an erratic field, s: how slowly the carried field is drawn to erratic samples.
pub(super) const ERRATIC_CORRELATION_S: f64 = 2.0;
/// Time constant of the deviation of |c| from its running median, s.
pub(super) const STRENGTH_TIME_S: f64 = 0.05;
/// Pace of the running median of |c|, uT/s.
pub(super) const STRENGTH_PACE_UT_S: f64 = 0.2;
/// Standard deviation of the hard iron (root of the trace) at which the filter starts anew about its own first
/// answer, uT.
pub(super) const RESTART_SD_UT: f64 = 8.0;
/// Share of the rate of rest by which the rate may scatter at rest while the bias is not known yet.
pub(super) const REST_SCATTER: f64 = 0.35;
/// Most of the slow difference between c and f that counts, uT; also its value at the start.
pub(super) const UNEVEN_MAX_UT: f64 = 0.58;
/// Memory of the power of that difference, s; shorter at the start, by its age.
pub(super) const UNEVEN_TIME_S: f64 = 5.0;

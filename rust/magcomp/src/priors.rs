//! What is believed of phones and places before a stream is seen, and what counts as chance: the choices that more than one part of the core makes.

// Phones.

/// Choice: noise of a magnetometer, per axis, uT: a Nexus 5 has 0.48, iPhones 0.7 to 1.1.
pub(crate) const NOISE_UT: f64 = 0.5;
/// Choice: hard iron of a phone, standard deviation per axis, and of the largest change of it, uT: a magnet in a cover.
pub(crate) const LARGEST_UT: f64 = 150.0;
/// Choice: standard deviation of an axis of b from one day to the next where nothing changed, uT: temperature and currents.
pub(crate) const DAYS_UT: f64 = 2.0;
/// Choice: changes of a device's disturbance an hour while it is in use: covers, chargers.
pub(crate) const DEVICES_PER_H: f64 = 6.0;
/// Choice: how far a hand turns a device in a second, rad: walks with motion capture.
pub(crate) const HAND_RAD: f64 = 0.3;
/// Choice: how far a hand, or a bias that is not known, tilts the vertical while the device moves, rad.
pub(crate) const TILT_RAD: f64 = 0.03;
/// Choice: how far M changes with b, relative, for each uT: covers; a steel plate with a magnet.
pub(crate) const IRON_PER_UT: f64 = 0.003;
/// Choice: how far an element of M is off where M was never measured: phones have up to 10 %.
pub(crate) const UNSEEN_IRON: f64 = 0.08;

// Places, and how long things last.

/// Choice: standard deviation of a room's field about its mean, per axis, uT: walks with motion capture have 2.1.
pub(crate) const ROOM_UT: f64 = 2.0;
/// Choice: for so long another place is a disturbance, s; then it is what is usual: a room.
pub(crate) const ROOM_S: f64 = 30.0;
/// Choice: a change of the device takes so long, s: a cover is put on; and what fits for less passes.
pub(crate) const RAMP_S: f64 = 0.3;
/// Choice: a pedestrian's step, s: for so long a tilt, the place's unevenness and a rate last.
pub(crate) const STEP_S: f64 = 0.5;
/// Choice: memory of what changes slowly, s: where up is, how deep the field dips, how uneven a place is; ten steps.
pub(crate) const SETTLED_S: f64 = 5.0;

// Chance, and what is good enough.

/// Choice: standard deviations beyond which a miss is no chance: one in 400.
pub(crate) const BEYOND_CHANCE: f64 = 3.0;
/// Choice: standard deviations beyond which a sample is none of those that are expected: one in 16 000.
pub(crate) const OUTLYING: f64 = 4.0;
/// Choice: share of what is rare: a spike among samples, a vertical that contradicts the field, a wrong decision.
pub(crate) const RARE: f64 = 0.01;
/// Choice: log odds below which a hypothesis is given up.
pub(crate) const HOPELESS: f64 = 30.0;
/// Choice: standard deviation of a direction from which on it is of use, degrees: less than half of a compass rose's sector.
pub(crate) const OF_USE_DEG: f64 = 10.0;
/// Choice: mean square turn of the device from which samples show more than one side of it, rad^2: 6 degrees about their mean.
pub(crate) const SHOWN_RAD2: f64 = 0.01;

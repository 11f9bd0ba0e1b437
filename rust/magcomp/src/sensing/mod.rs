//! Events of the sensors on their way to an estimator: put in the order of their times (`order`), brought together
//! by time (`pairing`), how far gravity is to be trusted while the device moves (`tilt`), and a camera's turns where
//! the gyroscope is missing (`stand_in`), and whether gravity (`axes`) and the field (`turning`) turn as the gyroscope says,
//! whether the two keep their angle (`dip`), and whether one that repeats its reading hangs (`hang`). Neighbouring samples are taken as one (`frame`).

pub(crate) mod axes;
pub(crate) mod dip;
pub(crate) mod frame;
pub(crate) mod hang;
pub(crate) mod order;
pub(crate) mod pairing;
pub(crate) mod stand_in;
pub(crate) mod tilt;
pub(crate) mod turning;

//! Events of the sensors on their way to an estimator: put in the order of their times (`order`), brought together
//! by time (`pairing`), and how far gravity is to be trusted while the device moves (`tilt`).

pub(crate) mod order;
pub(crate) mod pairing;
pub(crate) mod tilt;
mod tuning;

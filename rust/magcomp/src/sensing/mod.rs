//! Events of the sensors on their way to an estimator: put in the order of their times (`order`), brought together
//! by time (`pairing`), how far gravity is to be trusted while the device moves (`tilt`), and a camera's turns where
//! the gyroscope is missing (`stand_in`). Neighbouring samples are taken as one (`frame`). `witnesses` asks once a sample whether gravity (`axes`) and
//! the field (`turning`) turn as the gyroscope says, and whether a sensor that repeats its reading hangs (`hang`).

mod axes;
pub(crate) mod frame;
pub(crate) mod hang;
pub(crate) mod order;
pub(crate) mod pairing;
pub(crate) mod stand_in;
pub(crate) mod tilt;
mod turning;
pub(crate) mod witnesses;

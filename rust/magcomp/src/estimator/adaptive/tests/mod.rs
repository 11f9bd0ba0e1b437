//! Tests of the adaptive estimator that look inside it.

mod derivatives;
mod rate;

//! A small neural network trained on reference directions while there are any (after Wang and Gao, who train on headings
//! from GPS), then left to itself: raw sample in, direction of the field out.
//!     y = V tanh(U x + u) + v + S x,   16 hidden units, Adam (D. Kingma, J. Ba, 2015), one step a sample
//! 178 weights: written here, since the crates for networks bring a hundred others along.

use super::method::Baseline;
use crate::random::{Purpose, Random};
use magcomp::MagneticSample;
use magcomp::nalgebra::{SMatrix, SVector, Vector3};

const HIDDEN: usize = 16;
const WEIGHTS: usize = HIDDEN * 4 + 3 * HIDDEN + 3 + 9;
/// Decay of Adam's two averages.
const BETA: (f64, f64) = (0.9, 0.999);

/// The network; it learns from the directions that it is taught.
#[derive(Clone, Debug)]
pub struct Network {
    weights: SVector<f64, WEIGHTS>,
    first: SVector<f64, WEIGHTS>,
    second: SVector<f64, WEIGHTS>,
    steps: i32,
    rate: f64,
    /// The true direction at the next sample, while there are any.
    taught: Option<Vector3<f64>>,
    /// The first sample; none before it.
    origin_ut: Option<Vector3<f64>>,
}

/// Views of the weights: U with u, V, v, S.
struct Layers {
    hidden: SMatrix<f64, HIDDEN, 4>,
    out: SMatrix<f64, 3, HIDDEN>,
    bias: Vector3<f64>,
    straight: SMatrix<f64, 3, 3>,
}

impl Layers {
    fn of(w: &SVector<f64, WEIGHTS>) -> Self {
        let w = w.as_slice();
        let (hidden, rest) = w.split_at(HIDDEN * 4);
        let (out, rest) = rest.split_at(3 * HIDDEN);
        Self {
            hidden: SMatrix::from_column_slice(hidden),
            out: SMatrix::from_column_slice(out),
            bias: Vector3::from_column_slice(&rest[..3]),
            straight: SMatrix::from_column_slice(&rest[3..]),
        }
    }
}

impl Network {
    /// Untaught; `rate` is Adam's step.
    pub fn new(rate: f64, seed: u64) -> Self {
        let mut random = Random::new(seed, Purpose::Bootstrap);
        let weights = SVector::from_fn(|_, _| random.normal() * 0.3);
        let none = SVector::zeros();
        Self { weights, first: none, second: none, steps: 0, rate, taught: None, origin_ut: None }
    }

    fn learn(&mut self, x: &Vector3<f64>, target: &Vector3<f64>) {
        let layers = Layers::of(&self.weights);
        let input = x.push(1.0);
        let hidden = (layers.hidden * input).map(f64::tanh);
        let error = layers.out * hidden + layers.bias + layers.straight * x - target;
        let back = (layers.out.transpose() * error).component_mul(&hidden.map(|h| 1.0 - h * h));
        let mut gradient = SVector::<f64, WEIGHTS>::zeros();
        let parts = [
            (back * input.transpose()).as_slice().to_vec(),
            (error * hidden.transpose()).as_slice().to_vec(),
            error.as_slice().to_vec(),
            (error * x.transpose()).as_slice().to_vec(),
        ];
        gradient.as_mut_slice().copy_from_slice(&parts.concat());
        self.steps += 1;
        self.first = self.first * BETA.0 + gradient * (1.0 - BETA.0);
        self.second = self.second * BETA.1 + gradient.component_mul(&gradient) * (1.0 - BETA.1);
        let (a, b) = (1.0 - BETA.0.powi(self.steps), 1.0 - BETA.1.powi(self.steps));
        self.weights -= self.first.zip_map(&self.second, |m, v| self.rate * (m / a) / ((v / b).sqrt() + 1e-8));
    }
}

impl Baseline for Network {
    fn teach(&mut self, direction: Vector3<f64>) {
        self.taught = Some(direction);
    }

    fn push(&mut self, sample: &MagneticSample) {
        let x = input(&sample.field_ut, self.origin_ut.get_or_insert(sample.field_ut));
        if let Some(target) = self.taught.take().filter(|_| x.norm() < 10.0) {
            self.learn(&x, &target);
        }
    }

    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>> {
        let layers = Layers::of(&self.weights);
        let x = input(raw_ut, self.origin_ut.as_ref()?);
        let found = layers.out * (layers.hidden * x.push(1.0)).map(f64::tanh) + layers.bias + layers.straight * x;
        Some(found * 50.0)
    }
}

fn input(raw_ut: &Vector3<f64>, origin_ut: &Vector3<f64>) -> Vector3<f64> {
    (raw_ut - origin_ut) / 50.0
}

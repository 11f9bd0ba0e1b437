//! The least-squares ellipsoid (eq. 9, 10) by Levenberg-Marquardt on the moments of a window.
//!
//! (9) (u - beta)^T A (u - beta) - 1 = d.p with p = [A11, A22, A33, A12, A13, A23, -2 g, g.beta - 1], g = A beta, and
//! A = T^2, T = M^-1 in units of the field. Two residuals, both costs in closed form:
//!     Algebraic, (10) as written:              C(theta) = p^T S p / n
//!     Corrected, divided by its own gradient:  C / D, D = p^T N p / n    (the mean square of distances in raw units:
//!         E[S] = S0 + s^2 N for noise s, see `moments`, so the noise does not move its minimum up to s^4)
//! Jacobian J = dp/dtheta = diag(1 1 1 1 1 1 -2 -2 -2) and a last row r = [-beta_i^2, -2 beta_i beta_j, 2 beta].
//! With Q = S or S - (C/D) N the half gradient is J^T Q p and the Hessian J^T Q J (exact at the minimum of the second,
//! Gauss-Newton for the first). An iteration costs the same for 100 samples as for 2000.

use super::ldl;
use super::moments::Moments;
use super::report::EllipsoidFit;
use super::start::{Shape, closed_form};
use crate::calibration::Calibration;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use serde::{Deserialize, Serialize};

type Matrix9 = SMatrix<f64, 9, 9>;
type Vector9 = SVector<f64, 9>;
type Matrix10 = SMatrix<f64, 10, 10>;
type Vector10 = SVector<f64, 10>;

/// Nine parameters need nine samples.
pub const SMALLEST_SAMPLE_COUNT: usize = 9;

/// What is squared and summed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Residual {
    /// Eq. (10) as written. Biased in scale by about 3 s^2 (s: noise over field strength), and in everything when the
    /// sphere is only partly covered.
    Algebraic,
    /// Divided by its own gradient: a distance in raw units, free of the noise bias. The default.
    #[default]
    Corrected,
}

/// What a fit accepts and how it iterates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitOptions {
    /// What is squared and summed. Default [`Residual::Corrected`].
    pub residual: Residual,
    /// |h| in uT, 1 to 1000, where it is known (the paper sets it to 1; a world magnetic model gives it): then M carries the
    /// sensor's scale. Every method listens to it. None (the default): |h| is the geometric mean of the half axes, so
    /// det M = 1; for the aided method tr M = 3.
    pub field_strength_ut: Option<f64>,
    /// Half axes' geometric mean that is accepted, uT, within 1 to 1000. Default 22 to 67: what the Earth's field spans.
    pub field_range_ut: (f64, f64),
    /// Largest rms direction error, degrees, 0.001 to 180, that is accepted, as predicted from the coverage for the residual found or
    /// `error_floor_ut`, whichever is larger. Default 10; larger accepts poorer coverage.
    pub max_direction_sigma_deg: f64,
    /// White noise, uT, 0 to 1000, that does as much harm as the errors which are not white. Default 5: rooms bend the field by 1
    /// to 2 uT over half a second, some 20 samples. Smaller accepts poorer coverage where the residual is small; 0 trusts
    /// the residual alone, for simulated data.
    pub error_floor_ut: f64,
    /// Largest residual rms that is accepted, as a share of the field strength, 0.0001 to 1000. Default 0.05: 30 dB of noise is 0.032, rooms
    /// stay below 0.04; a window across a change of the disturbance lies above. Larger accepts more noise.
    pub max_residual_share: f64,
    /// Iterations at the most, 1 to 1000. Default 50; warm or closed-form starts take 2 to 6.
    pub max_iterations: usize,
    /// The iteration has converged when no parameter would change by more than this (field strengths), 1e-16 to 0.1. Default
    /// 1e-10.
    pub tolerance: f64,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            residual: Residual::Corrected,
            field_strength_ut: None,
            field_range_ut: (22.0, 67.0),
            max_direction_sigma_deg: 10.0,
            error_floor_ut: 5.0,
            max_residual_share: 0.05,
            max_iterations: 50,
            tolerance: 1e-10,
        }
    }
}

/// Why the iteration stopped. Each is an answer; `Stalled` and `MaxIterations` say how good.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Termination {
    /// The last step was below the tolerance.
    Converged,
    /// No step lowers the cost any more: rounding decides.
    Stalled,
    /// The number of iterations ran out first.
    MaxIterations,
}

/// Why there is no ellipsoid to report.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, Serialize, Deserialize)]
pub enum FitError {
    /// Fewer samples than parameters.
    #[error("{have} samples are too few for an ellipsoid: {SMALLEST_SAMPLE_COUNT} are needed, more are better")]
    TooFewSamples {
        /// How many there are.
        have: usize,
    },
    /// All samples lie near one plane, as they do when the device turns about a single axis or not at all.
    #[error("samples lie within {thickness_ut:.2} uT of one plane; turn the device about a second axis")]
    Planar {
        /// Standard deviation of the samples across their thinnest direction, uT.
        thickness_ut: f64,
    },
    /// The directions do not determine the ellipsoid well enough.
    #[error(
        "predicted direction error {direction_sigma_deg:.1} deg exceeds {limit_deg:.1} deg; turn the device to more directions"
    )]
    PoorCoverage {
        /// Predicted rms direction error, degrees.
        direction_sigma_deg: f64,
        /// The limit it exceeds, degrees.
        limit_deg: f64,
    },
    /// The samples do not lie on one ellipsoid.
    #[error(
        "samples lie {residual_ut:.1} uT off the best ellipsoid, more than {limit_ut:.1} uT; the disturbance or the place changed meanwhile"
    )]
    Inconsistent {
        /// Residual rms, uT.
        residual_ut: f64,
        /// The limit it exceeds, uT.
        limit_ut: f64,
    },
    /// The best quadric is not an ellipsoid.
    #[error(
        "samples are fitted best by a surface that is no ellipsoid; the disturbance changed meanwhile, or too few directions were seen"
    )]
    NotAnEllipsoid,
    /// The field is too weak or too strong to be the Earth's.
    #[error(
        "field strength {field_ut:.1} uT is outside {low_ut} to {high_ut} uT; the place is disturbed or the sensor's unit is not microtesla"
    )]
    FieldOutOfRange {
        /// Strength found, uT: the geometric mean of the half axes, or |m| with the gyroscope.
        field_ut: f64,
        /// Smallest accepted, uT.
        low_ut: f64,
        /// Largest accepted, uT.
        high_ut: f64,
    },
    /// A sample was NaN or infinite, or the numbers overflowed.
    #[error("a sample is not finite; leave out NaN and infinite values")]
    NotFinite,
}

/// Batch fit of a slice of raw samples, uT (section III of the paper).
///
/// # Errors
/// [`FitError`] says what is wrong with the samples.
pub fn fit_ellipsoid(points_ut: &[Vector3<f64>], options: &FitOptions) -> Result<EllipsoidFit, FitError> {
    if !points_ut.iter().all(|p| p.iter().all(|v| v.is_finite())) {
        return Err(FitError::NotFinite);
    }
    let rough = Moments::of(points_ut);
    let fit = rough.fit(options)?;
    // a cap of the sphere lies off its own centre: once more about the centre that was found
    let mut moments = Moments::new(*fit.calibration.hard_iron_ut(), fit.calibration.field_strength_ut());
    points_ut.iter().for_each(|p| moments.add(p));
    moments.fit(options)
}

impl Moments {
    /// The least-squares ellipsoid of the samples in the set, from the closed-form start.
    ///
    /// # Errors
    /// [`FitError`] says what is wrong with the samples.
    pub fn fit(&self, options: &FitOptions) -> Result<EllipsoidFit, FitError> {
        self.fit_from(None, options)
    }

    /// The iteration alone, from a previous calibration: what a sample costs in a stream, without covariance and checks.
    ///
    /// # Errors
    /// [`FitError`] when there are too few samples or no ellipsoid.
    pub fn refine(&self, previous: &Calibration, options: &FitOptions) -> Result<Calibration, FitError> {
        let solution = self.problem(options)?.solve(Some(self.shape_of(previous)), options);
        let solution = solution.ok_or_else(|| self.why_no_ellipsoid(0.0))?;
        self.calibration_of(&solution, options).map(|(calibration, _)| calibration)
    }

    /// The fit of a stream: the iteration starts from `previous` where that has the lower cost, else from the closed form.
    pub(crate) fn fit_from(
        &self,
        previous: Option<&Calibration>,
        options: &FitOptions,
    ) -> Result<EllipsoidFit, FitError> {
        let problem = self.problem(options)?;
        let solution = problem.solve(previous.map(|calibration| self.shape_of(calibration)), options);
        self.report(&problem, &solution.ok_or_else(|| self.why_no_ellipsoid(0.0))?, options)
    }

    /// The cost of these samples.
    fn problem(&self, options: &FitOptions) -> Result<Problem, FitError> {
        if self.count() < SMALLEST_SAMPLE_COUNT {
            return Err(FitError::TooFewSamples { have: self.count() });
        }
        let (s, n) = self.scatter();
        if !self.is_finite() || !s.iter().all(|v| v.is_finite()) {
            return Err(FitError::NotFinite);
        }
        Ok(Problem { s, n, residual: options.residual })
    }

    /// Where the centre seems to be, uT, however poor the coverage: for showing directions, not for correcting.
    pub(crate) fn provisional_centre_ut(&self) -> Vector3<f64> {
        let start = closed_form(&self.scatter().0).and_then(|shape| shape.centre());
        let centre = start.map(|beta| self.centre_ut() + beta * self.scale_ut());
        centre.filter(|c| c.iter().all(|v| v.is_finite())).unwrap_or(*self.centre_ut())
    }

    /// A calibration, seen in these coordinates: the warm start.
    pub(crate) fn shape_of(&self, calibration: &Calibration) -> Shape {
        let t = calibration.soft_iron_inverse() * (self.scale_ut() / calibration.field_strength_ut());
        let a = t * t;
        let beta = (calibration.hard_iron_ut() - self.centre_ut()) / self.scale_ut();
        Shape { a: (a + a.transpose()) * 0.5, g: a * beta }
    }
}

/// The cost of one window: moments and which residual.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    s: Matrix10,
    n: Matrix10,
    residual: Residual,
}

/// The problem at one ellipsoid.
#[derive(Clone, Debug)]
struct Point {
    shape: Shape,
    beta: Vector3<f64>,
    p: Vector10,
    /// p^T S p / n and p^T N p / n.
    c: f64,
    d: f64,
    cost: f64,
}

/// A minimum of the problem.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    point: Point,
    pub iterations: usize,
    pub termination: Termination,
}

impl Solution {
    /// C / D: mean squared distance from the ellipsoid, in scaled units.
    pub fn distance_squared(&self) -> f64 {
        (self.point.c / self.point.d).max(0.0)
    }

    /// The ellipsoid found: (A, its centre beta), scaled units.
    pub fn ellipsoid(&self) -> (&Matrix3<f64>, &Vector3<f64>) {
        (&self.point.shape.a, &self.point.beta)
    }
}

impl Problem {
    /// The minimum, from `warm` where that has the lower cost, else from the closed form.
    pub fn solve(&self, warm: Option<Shape>, options: &FitOptions) -> Option<Solution> {
        let starts = [warm, closed_form(&self.s)].into_iter().flatten().filter_map(|shape| self.at(shape));
        Some(self.minimise(starts.min_by(|a, b| a.cost.total_cmp(&b.cost))?, options))
    }

    /// J^T (S - s^2 N) J / D with s^2 = C / D: the information of one sample about theta, times s^2, the noise's own
    /// share taken off. Lower triangle.
    pub fn information(&self, solution: &Solution) -> Matrix9 {
        solution.point.hessian(&(self.s - self.n * solution.distance_squared())) / solution.point.d
    }

    /// None where the shape is no ellipsoid.
    fn at(&self, shape: Shape) -> Option<Point> {
        let beta = shape.centre()?;
        let (a, g) = (&shape.a, &shape.g);
        let p = Vector10::from_column_slice(&[
            a.m11,
            a.m22,
            a.m33,
            a.m12,
            a.m13,
            a.m23,
            -2.0 * g.x,
            -2.0 * g.y,
            -2.0 * g.z,
            g.dot(&beta) - 1.0,
        ]);
        let c = (self.s * p).dot(&p).max(0.0);
        let d = (self.n * p).dot(&p);
        let cost = match self.residual {
            Residual::Algebraic => c,
            Residual::Corrected => c / d,
        };
        (d > 0.0 && cost.is_finite()).then_some(Point { shape, beta, p, c, d, cost })
    }

    /// Levenberg-Marquardt: Hessian + mu diag(J^T S J), mu from 0 upwards only when a step does not lower the cost.
    ///
    /// Close to the minimum steps shrink by a factor rho from one to the next, and what is left after a step of this
    /// size is rho * size: when that is below the tolerance, another iteration would change nothing.
    fn minimise(&self, start: Point, options: &FitOptions) -> Solution {
        let mut point = start;
        let mut damping = 0.0;
        let mut previous_size: Option<f64> = None;
        for iteration in 1..=options.max_iterations.max(1) {
            let q = match self.residual {
                Residual::Algebraic => self.s,
                Residual::Corrected => self.s - self.n * point.cost,
            };
            let gradient = point.gradient(&q);
            let mut hessian = point.hessian(&q);
            if self.residual == Residual::Algebraic {
                hessian += point.curvature(&q);
            }
            let theta = point.shape.theta();
            let mut taken = None;
            for _ in 0..MAX_DAMPINGS {
                let mut damped = hessian;
                if damping > 0.0 {
                    let diagonal = point.hessian(&self.s).diagonal();
                    (0..9).for_each(|i| damped[(i, i)] += damping * diagonal[i]);
                }
                let step = ldl::solve(&damped, &-gradient);
                let next = step.and_then(|step| Some((step.amax(), self.at(Shape::from_theta(&(theta + step)))?)));
                if let Some((size, next)) = next
                    && (next.cost <= point.cost || (damping == 0.0 && next.cost <= point.cost * (1.0 + ROUNDING)))
                {
                    point = next;
                    taken = Some(size);
                    break;
                }
                damping = if damping == 0.0 { FIRST_DAMPING } else { damping * 10.0 };
            }
            let Some(size) = taken else {
                return Solution { point, iterations: iteration, termination: Termination::Stalled };
            };
            let rho = previous_size.filter(|_| damping == 0.0).map_or(1.0, |previous| (size / previous).min(1.0));
            if size * rho <= options.tolerance {
                return Solution { point, iterations: iteration, termination: Termination::Converged };
            }
            previous_size = Some(size);
            damping = if damping > FIRST_DAMPING { damping * 0.1 } else { 0.0 };
        }
        Solution { point, iterations: options.max_iterations, termination: Termination::MaxIterations }
    }
}

/// A Newton step that raises the cost by no more than its rounding (relative) is taken: closer to the minimum than
/// the root of this the cost says nothing any more, the gradient still does.
const ROUNDING: f64 = 1e-11;
/// Damping of the first step after one that did not lower the cost.
const FIRST_DAMPING: f64 = 1e-4;
/// Factors of 10 in the damping before an iteration gives up.
const MAX_DAMPINGS: usize = 16;

impl Point {
    /// Last row of J: d(g.beta - 1)/d theta, with beta = A^-1 g.
    fn last_row(&self) -> Vector9 {
        let b = &self.beta;
        Vector9::from_column_slice(&[
            -b.x * b.x,
            -b.y * b.y,
            -b.z * b.z,
            -2.0 * b.x * b.y,
            -2.0 * b.x * b.z,
            -2.0 * b.y * b.z,
            2.0 * b.x,
            2.0 * b.y,
            2.0 * b.z,
        ])
    }

    /// J^T Q p: half the gradient of the cost (times D for the corrected one).
    fn gradient(&self, q: &Matrix10) -> Vector9 {
        let qp = q * self.p;
        let mut gradient = qp.fixed_rows::<9>(0).component_mul(&DIAGONAL) + self.last_row() * qp[9];
        gradient.apply(|v| *v = if v.is_finite() { *v } else { 0.0 });
        gradient
    }

    /// What J^T Q J leaves out of the Hessian: (Q p)_10 times the second derivative of g.A^-1 g - 1, 2 V^T A^-1 V with
    /// V = [-E_k beta, I]. Zero at the minimum of the corrected cost, where Q p = 0; without it the algebraic cost's
    /// iteration converges only linearly.
    fn curvature(&self, q: &Matrix10) -> Matrix9 {
        let b = &self.beta;
        let mut v = SMatrix::<f64, 3, 9>::zeros();
        for (k, (i, j)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
            v[(i, k)] = -b[j];
            v[(j, k)] = -b[i];
        }
        v.fixed_view_mut::<3, 3>(0, 6).fill_with_identity();
        let inverse = self.shape.a.try_inverse().unwrap_or_else(Matrix3::zeros);
        v.transpose() * inverse * v * (2.0 * q.row(9).transpose().dot(&self.p))
    }

    /// Lower triangle of J^T Q J.
    fn hessian(&self, q: &Matrix10) -> Matrix9 {
        let r = self.last_row();
        let edge = q.fixed_view::<9, 1>(0, 9).component_mul(&DIAGONAL);
        let half = edge + r * (0.5 * q[(9, 9)]);
        let mut hessian = Matrix9::zeros();
        for j in 0..9 {
            for i in j..9 {
                let value = q[(i, j)] * DIAGONAL[i] * DIAGONAL[j] + r[i] * half[j] + half[i] * r[j];
                hessian[(i, j)] = value;
            }
        }
        hessian
    }
}

/// Diagonal part of J.
const DIAGONAL: Vector9 =
    Vector9::from_array_storage(nalgebra::ArrayStorage([[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -2.0, -2.0, -2.0]]));

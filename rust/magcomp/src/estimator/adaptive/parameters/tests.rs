use super::*;

fn example() -> (Tau, Vector3<f64>) {
    let tau = Tau::from_column_slice(&[1.1, 0.9, 1.05, 0.07, -0.04, 0.06, 0.3, -0.5, 0.8, 0.2]);
    (tau, Vector3::new(0.9, -0.2, 1.3))
}

#[test]
fn derivatives_agree_with_finite_differences() {
    let (tau, u) = example();
    let seen = see(&tau, &u).unwrap();
    let along = [seen.direction, Vector3::x(), Vector3::y(), Vector3::z()];
    let [g, x, y, z] = along.map(|along| gradient(&tau, &along, &seen.offset, 0.0));
    for k in 0..9 {
        let moved = |by: f64| {
            let mut moved = tau;
            moved[k] += by;
            moved
        };
        let (above, below) = (moved(1e-5), moved(-1e-5));
        let (a, b) = (see(&above, &u).unwrap(), see(&below, &u).unwrap());
        assert!(((a.radius - b.radius) / 2e-5 - g[k]).abs() < 1e-9, "r, column {k}");
        let dv = (a.direction * a.radius - b.direction * b.radius) / 2e-5;
        assert!((dv - Vector3::new(x[k], y[k], z[k])).amax() < 1e-9, "T (u - beta), column {k}");
    }
    let slope = |by: Vector3<f64>| see(&tau, &(u + by)).unwrap().radius;
    let numeric = Vector3::from_fn(|i, _| {
        let by = Vector3::ith(i, 1e-5);
        (slope(by) - slope(-by)) / 2e-5
    });
    assert!((numeric.norm() - seen.slope).abs() < 1e-9);
}

#[test]
fn bounds_hold_the_eigenvalues() {
    let with = |d: f64| tau_of(&Matrix3::from_diagonal(&Vector3::new(1.0, d, 1.0)), &Vector3::zeros());
    assert!(is_bounded(&with(1.0)) && is_bounded(&with(0.3)) && is_bounded(&with(3.3)));
    assert!(!is_bounded(&with(0.2)) && !is_bounded(&with(-0.5)) && !is_bounded(&with(3.6)));
}

/// The mean over the corners of an icosahedron is that of the sphere for everything even up to the fifth degree.
#[test]
fn the_error_is_the_mean_square_angle_over_the_sphere() {
    let (tau, _) = example();
    let root = TauMatrix::from_fn(|i, j| ((i * 5 + j * 3) as f64).sin());
    let (short, long) = (0.525_731_112_119_133_6, 0.850_650_808_352_039_9);
    let mut square = 0.0;
    for k in 0..12 {
        let signed = |value: f64, bit: usize| if k >> bit & 1 == 0 { value } else { -value };
        let (a, b) = (signed(short, 0), signed(long, 1));
        let n = [Vector3::new(a, b, 0.0), Vector3::new(0.0, a, b), Vector3::new(b, 0.0, a)][k / 4];
        let u = centre(&tau) + shape(&tau).try_inverse().unwrap() * n;
        for column in root.column_iter() {
            let turned = |by: f64| see(&(tau + column * by), &u).unwrap().direction;
            square += ((turned(1e-6) - turned(-1e-6)) / 2e-6).norm_squared() / 12.0;
        }
    }
    let error = Gaussian { mean: tau, covariance: root * root.transpose() }.error();
    assert!((error / square - 1.0).abs() < 1e-6, "{error} against {square}");
}

/// 18 to 72 uT are taken for the Earth's; the mean half axis of a trace of 3 is one unit.
#[test]
fn a_field_is_beyond_the_earths_by_its_share() {
    let beyond = |trace: f64, unit_ut: f64| {
        beyond_earth(&tau_of(&(Matrix3::identity() * (trace / 3.0)), &Vector3::zeros()), unit_ut)
    };
    assert_eq!([beyond(3.0, 18.0), beyond(3.0, 45.0), beyond(3.0, 72.0)], [0.0; 3]);
    assert!((beyond(1.5, 45.0) - (1.0 - 72.0 / 90.0)).abs() < 1e-12);
    assert!((beyond(6.0, 27.0) - (1.0 - 13.5 / 18.0)).abs() < 1e-12);
}

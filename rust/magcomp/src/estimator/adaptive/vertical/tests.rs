use super::*;

#[test]
fn the_cost_is_the_sum_of_squares_and_its_derivatives_are_right() {
    let tau = Tau::from_column_slice(&[1.1, 0.9, 1.05, 0.07, -0.04, 0.06, 0.3, -0.5, 0.8, 0.2]);
    let about = Vector3::new(0.5, -0.7, 0.4);
    let mut moments = VerticalMoments::new();
    let samples: Vec<_> = (0..40)
        .map(|k| {
            let k = f64::from(k);
            let u = Vector3::new((k * 1.3).sin(), (k * 0.7).cos(), (k * 2.1).sin());
            (u + about, Vector3::new((k * 0.3).cos(), (k * 0.9).sin(), 0.4).normalize())
        })
        .collect();
    for (u, up) in &samples {
        moments.add(&(u - about), up, 1);
    }
    let direct = |tau: &Tau| samples.iter().map(|(u, up)| miss(tau, u, up).0.powi(2)).sum::<f64>() / (0.04 * 3.0);
    let likelihood = moments.likelihood(&about, 0.04, 3.0);
    assert!((likelihood.cost(&tau) / direct(&tau) - 1.0).abs() < 1e-9);
    let (gradient, _) = likelihood.derivatives(&tau);
    let (u, up) = samples[7];
    let (_, by_tau) = miss(&tau, &u, &up);
    for k in 0..COUNT {
        let moved = |by: f64| {
            let mut moved = tau;
            moved[k] += by;
            moved
        };
        let slope = (direct(&moved(1e-6)) - direct(&moved(-1e-6))) / 2e-6;
        assert!((slope / 2.0 - gradient[k]).abs() < 1e-4 * gradient.amax(), "cost, column {k}");
        let slope = (miss(&moved(1e-6), &u, &up).0 - miss(&moved(-1e-6), &u, &up).0) / 2e-6;
        assert!((slope - by_tau[k]).abs() < 1e-8, "miss, column {k}");
    }
}

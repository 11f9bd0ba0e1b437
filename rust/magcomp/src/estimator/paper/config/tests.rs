use super::*;

#[test]
fn a_stream_is_fitted_as_the_settings_say() {
    let config = WindowedConfig { noise_floor_ut: 0.3, ..WindowedConfig::default() };
    let usual =
        FitOptions { noise_floor_ut: 0.3, field_strength_ut: Some(45.0), tolerance: 1e-6, ..FitOptions::default() };
    assert_eq!(config.fit_options(Some(45.0)), usual);
    // as the paper has it a window is fitted however far its samples lie off
    let written = WindowedConfig { residual: Residual::Algebraic, ..config };
    let expected = FitOptions { residual: Residual::Algebraic, max_residual_share: f64::INFINITY, ..usual };
    assert_eq!(written.fit_options(Some(45.0)), expected);
}

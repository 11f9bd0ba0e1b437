use super::{CELLS, Coverage, Guidance};
use crate::calibration::Calibration;
use nalgebra::Vector3;

#[test]
fn every_cell_holds_its_middle() {
    for cell in 0..CELLS {
        assert_eq!(Coverage::cell(&Coverage::middle(cell)), cell);
    }
}

#[test]
fn cells_have_equal_areas() {
    let mut counts = [0_u32; CELLS];
    let (rows, columns) = (600, 600);
    for i in 0..rows {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(rows);
        for j in 0..columns {
            let phi = (f64::from(j) + 0.5) / f64::from(columns) * std::f64::consts::TAU;
            let flat = (1.0 - z * z).sqrt();
            counts[Coverage::cell(&Vector3::new(flat * phi.cos(), flat * phi.sin(), z))] += 1;
        }
    }
    let even = f64::from(rows * columns) / CELLS as f64;
    for count in counts {
        assert!((f64::from(count) / even - 1.0).abs() < 0.02, "{count} against {even}");
    }
}

/// By latitude and longitude: bands of 4, 8, 12, 12, 8, 4 cells of one area, counted anticlockwise from the west.
#[test]
fn cells_are_those_of_latitude_and_longitude() {
    let bands = [(0_i32, 4_i32), (4, 8), (12, 12), (24, 12), (36, 8), (44, 4)];
    for k in 0..20_000 {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / 20_000.0;
        let phi = (f64::from(k) * 2.399_963).rem_euclid(std::f64::consts::TAU);
        let (first, cells) = *bands.iter().find(|(first, cells)| (1.0 - z) * 24.0 < f64::from(first + cells)).unwrap();
        let along = (phi + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
        let expected = first + (along * f64::from(cells)) as i32;
        let length = 0.01 + f64::from(k % 7);
        let flat = length * (1.0 - z * z).sqrt();
        let direction = Vector3::new(flat * phi.cos(), flat * phi.sin(), length * z);
        assert_eq!(Coverage::cell(&direction), expected as usize, "{direction}");
    }
}

#[test]
fn unseen_shrinks_as_cells_fill() {
    let mut coverage = Coverage::default();
    assert_eq!(coverage.unseen_directions().len(), CELLS);
    coverage.see(Some(&Vector3::new(0.0, 3.0, 0.1)));
    assert_eq!(coverage.unseen_directions().len(), CELLS - 1);
    assert!((coverage.share() - 1.0 / 48.0).abs() < 1e-15);
}

#[test]
fn the_share_is_that_of_the_cells_that_are_not_unseen() {
    let mut coverage = Coverage::default();
    for k in 0..4000_u32 {
        coverage.count_latest([3, 400, 40, usize::MAX][k as usize / 100 % 4]);
        let t = f64::from(k);
        coverage.see(Some(&Vector3::new((1.7 * t).sin(), (2.3 * t).cos(), (0.37 * t).sin())));
        let seen = CELLS - coverage.unseen_directions().len();
        assert_eq!(coverage.share(), seen as f64 / CELLS as f64, "{k}");
    }
}

#[test]
fn a_direction_counts_until_it_has_left_the_window() {
    let mut coverage = Coverage::default();
    coverage.count_latest(3);
    coverage.see(Some(&Vector3::x()));
    coverage.see(Some(&Vector3::z()));
    coverage.see(None);
    assert_eq!(coverage.share(), 2.0 / 48.0);
    coverage.see(None);
    assert_eq!(coverage.share(), 1.0 / 48.0);
    // a longer window has it again
    coverage.count_latest(4);
    assert_eq!(coverage.share(), 2.0 / 48.0);
    coverage.see(Some(&Vector3::x()));
    coverage.count_latest(1);
    assert_eq!(coverage.share(), 1.0 / 48.0);
}

/// Cells of the latest samples, counted one by one.
fn share_of(latest: &[Vector3<f64>]) -> f64 {
    let seen: std::collections::BTreeSet<usize> = latest.iter().map(Coverage::cell).collect();
    seen.len() as f64 / CELLS as f64
}

#[test]
fn the_share_is_that_of_a_count_over_the_window() {
    let mut coverage = Coverage::default();
    let directions: Vec<_> = (0..300)
        .map(|k| f64::from(k) * 0.37)
        .map(|t| Vector3::new(t.sin(), (1.7 * t).cos(), (0.3 * t).sin()))
        .collect();
    for end in 1..=directions.len() {
        coverage.see(Some(&directions[end - 1]));
        let window = (13 * end) % 80 + 1;
        coverage.count_latest(window);
        assert_eq!(coverage.share(), share_of(&directions[end.saturating_sub(window)..end]), "{end}");
    }
}

fn turned(k: usize) -> Vector3<f64> {
    let t = k as f64 * 0.21;
    Vector3::new(t.sin() * (0.37 * t).cos(), t.cos() * (0.37 * t).cos(), (0.37 * t).sin()) * 50.0
}

#[test]
fn guidance_looks_from_the_centre_of_the_samples_before_there_is_a_calibration() {
    let b = Vector3::new(300.0, -200.0, 100.0);
    let mut guidance = Guidance::new(2000, None);
    (0..200).for_each(|k| guidance.see(&(turned(k) + b), None, k + 1));
    let fields: Vec<_> = (0..200).map(turned).collect();
    // seen from zero all of them lie in a few cells
    let raw: Vec<_> = fields.iter().map(|field| field + b).collect();
    assert!(share_of(&raw) < 0.2 && share_of(&fields) > 0.5);
    assert!((guidance.coverage.share() - share_of(&fields)).abs() < 0.05);
}

#[test]
fn guidance_sees_anew_through_a_calibration_that_has_moved_and_only_then() {
    let b = Vector3::new(300.0, -200.0, 100.0);
    let through = |off_ut: f64| Calibration::about(b + Vector3::x() * off_ut, 50.0);
    let mut guidance = Guidance::new(2000, Some(50.0));
    (0..200).for_each(|k| guidance.see(&(turned(k) + b), Some(&through(0.0)), k + 1));
    let seen = guidance.coverage.clone();
    guidance.look_through(Some(&through(9.9)), 200);
    assert_eq!(guidance.coverage, seen);
    guidance.look_through(Some(&through(10.1)), 200);
    let fields: Vec<_> = (0..200).map(|k| turned(k) - Vector3::x() * 10.1).collect();
    assert_eq!(guidance.coverage.share(), share_of(&fields));
    assert_ne!(guidance.coverage, seen);
}

#[test]
fn a_long_rest_before_the_first_calibration_is_forgotten() {
    let b = Vector3::new(300.0, -200.0, 100.0);
    let mut guidance = Guidance::new(500, None);
    (0..5000).for_each(|k| guidance.see(&(Vector3::z() * 50.0 + b), None, k.min(499) + 1));
    (0..1000).for_each(|k| guidance.see(&(turned(k) + b), None, 500));
    let fields: Vec<_> = (500..1000).map(turned).collect();
    assert!((guidance.coverage.share() - share_of(&fields)).abs() < 0.1);
}

#[test]
fn after_a_restart_guidance_is_as_new() {
    let mut guidance = Guidance::new(200, Some(50.0));
    (0..120).for_each(|k| guidance.see(&turned(k), None, k + 1));
    assert_ne!(guidance, Guidance::new(200, Some(50.0)));
    guidance.restart();
    assert_eq!(guidance, Guidance::new(200, Some(50.0)));
}

/// The first of the samples that count is the only one of its direction.
#[test]
fn the_oldest_sample_that_counts_is_seen_anew_too() {
    let mut guidance = Guidance::new(200, Some(50.0));
    let through = |off_ut: f64| Calibration::about(Vector3::x() * off_ut, 50.0);
    let field = |k: usize| if k == 10 { Vector3::z() * -50.0 } else { Vector3::z() * 50.0 };
    (0..30).for_each(|k| guidance.see(&field(k), Some(&through(0.0)), 20));
    assert_eq!(guidance.coverage.share(), 2.0 / 48.0);
    guidance.look_through(Some(&through(10.1)), 20);
    assert_eq!(guidance.coverage.share(), 2.0 / 48.0);
    guidance.look_through(Some(&through(0.0)), 19);
    assert_eq!(guidance.coverage.share(), 1.0 / 48.0);
}

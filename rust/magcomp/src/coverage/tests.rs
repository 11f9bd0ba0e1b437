use super::*;

#[test]
fn every_cell_holds_its_middle() {
    for cell in 0..CELLS {
        assert_eq!(Coverage::cell(&Coverage::middle(cell)), cell);
    }
}

#[test]
fn cells_have_equal_areas() {
    let mut coverage = Coverage::default();
    let (rows, columns) = (600, 600);
    for i in 0..rows {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(rows);
        for j in 0..columns {
            let phi = (f64::from(j) + 0.5) / f64::from(columns) * std::f64::consts::TAU;
            let flat = (1.0 - z * z).sqrt();
            coverage.add(Some(Coverage::cell(&Vector3::new(flat * phi.cos(), flat * phi.sin(), z)) as u8), 1);
        }
    }
    let even = f64::from(rows * columns) / CELLS as f64;
    for count in &coverage.counts {
        assert!((f64::from(*count) / even - 1.0).abs() < 0.02, "{count} against {even}");
    }
}

#[test]
fn unseen_shrinks_as_cells_fill() {
    let mut coverage = Coverage::default();
    assert_eq!(coverage.unseen_directions().len(), CELLS);
    coverage.add(Some(Coverage::cell(&Vector3::new(0.0, 3.0, 0.1)) as u8), 1);
    assert_eq!(coverage.unseen_directions().len(), CELLS - 1);
    assert!((coverage.share() - 1.0 / 48.0).abs() < 1e-15);
    coverage.add(Some(Coverage::cell(&Vector3::new(0.0, 3.0, 0.1)) as u8), -1);
    assert_eq!(coverage.share(), 0.0);
}

//! Simulated phones as recordings, whole or spoilt.

use magcomp::nalgebra::Vector3;
use magcomp_lab::catalogue::{Variant, find};
use magcomp_lab::simulate::Simulation;
use std::fmt::Write as _;

/// A change of a value, and one of the field by the number of its sample.
pub type Change = fn(Vector3<f64>) -> Vector3<f64>;
pub type FieldChange = fn(usize, Vector3<f64>) -> Vector3<f64>;

/// A phone of a minute, and what is wrong with its file.
pub struct Phone {
    pub simulation: Simulation,
    /// Changes of the field, the acceleration, the rate.
    pub field: FieldChange,
    pub up: Change,
    pub rate: Change,
    /// How much later the field's stamps are, s.
    pub late_s: f64,
    /// So many times slower than it was simulated.
    pub slower: i64,
}

impl Phone {
    pub fn new(seed: u64) -> Self {
        Self::of("phone-steady", seed)
    }

    pub fn of(variant: &str, seed: u64) -> Self {
        let variant = Variant { duration_s: 60.0, ..find(variant).unwrap().in_an_even_place() };
        Self { simulation: variant.stream(seed), field: |_, m| m, up: |a| a, rate: |g| g, late_s: 0.0, slower: 1 }
    }
}

/// Its rows: each sensor with its own times.
pub fn rows(phone: &Phone) -> String {
    let mut lines: Vec<(i64, String)> = Vec::new();
    let cells = |v: Vector3<f64>| format!("{:.6},{:.6},{:.6}", v.x, v.y, v.z);
    for (k, sample) in phone.simulation.magnetic.iter().enumerate() {
        let time_ns = phone.slower * sample.time_ns + (phone.late_s * 1e9) as i64;
        lines.push((4 * time_ns, format!("{},,,,,,", cells((phone.field)(k, sample.field_ut)))));
    }
    for event in &phone.simulation.ups {
        lines.push((4 * phone.slower * event.time_ns + 1, format!(",,,{},,,", cells((phone.up)(event.up_m_s2)))));
    }
    for event in &phone.simulation.rotation_rates {
        lines.push((
            4 * phone.slower * event.time_ns + 2,
            format!(",,,,,,{}", cells((phone.rate)(event.rate_rad_s / phone.slower as f64))),
        ));
    }
    lines.sort_by_key(|line| line.0);
    let mut text = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n".to_owned();
    for (time, cells) in lines {
        // no two sensors at one time
        writeln!(text, "{:.9},{cells}", (time / 4) as f64 / 1e9 + (time % 4) as f64 * 1e-7).unwrap();
    }
    text
}

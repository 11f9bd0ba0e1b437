//! README's code, word for word, on a simulated phone: it prints the lines that README shows, and they are right.

use magcomp::{Compensator, MagneticSample, RotationRateSample, UpSample, nalgebra::Vector3};

/// What gyroscope (rad/s), accelerometer (m/s^2) and magnetometer (uT) read at a time in nanoseconds.
fn follow(compensator: &mut Compensator, time_ns: i64, sensors: [Vector3<f64>; 3]) -> String {
    let [rate_rad_s, up_m_s2, field_ut] = sensors;
    // a sample that cannot be used is refused, says why, and changes nothing
    let _ = compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s });
    let _ = compensator.push_up(UpSample { time_ns, up_m_s2 });
    let reading = compensator.push(MagneticSample { time_ns, field_ut });
    match reading.heading {
        Some(h) => {
            format!("{:.0} deg +- {:.1}, {}", h.heading_deg, h.heading_sigma_deg.unwrap_or(180.0), reading.status)
        }
        None => reading.status.to_string(), // a sentence that says what is missing
    }
}

#[test]
fn the_readmes_code_prints_its_lines() {
    use magcomp::nalgebra::Rotation3;
    // a hand sways the phone while its owner turns left; after 8.7 s a magnetic cover goes on
    let attitude = |t: f64| Rotation3::from_euler_angles(0.6 * (2.0 * t).sin(), 0.5 * (1.4 * t).cos(), 0.5 * t);
    let carried_ut =
        |t: f64| if t < 8.7 { Vector3::new(150.0, -70.0, 280.0) } else { Vector3::new(130.0, -90.0, 300.0) };
    let mut compensator = Compensator::new(magcomp::Config::default()).unwrap();
    let mut printed = String::new();
    for k in 1..=1200_i64 {
        let t = k as f64 / 100.0;
        let (to_device, turn) = (attitude(t).inverse(), attitude(t - 0.005).inverse() * attitude(t + 0.005));
        let field_ut = to_device * Vector3::new(0.0, 25.0, -43.0) + carried_ut(t);
        let sensors = [turn.scaled_axis() / 0.01, to_device * Vector3::new(0.0, 0.0, 9.81), field_ut];
        let line = follow(&mut compensator, k * 10_000_000, sensors);
        if k % 180 != 0 {
            continue;
        }
        printed += &format!("{t:.1} s: {line}\n");
        if let (true, Some((heading, rest))) = (t > 3.0, line.split_once(" deg +- ")) {
            let top = attitude(t) * Vector3::y();
            let off_deg = (heading.parse::<f64>().unwrap() - top.x.atan2(top.y).to_degrees() + 540.0) % 360.0 - 180.0;
            let sigma_deg: f64 = rest.split(',').next().unwrap().parse().unwrap();
            assert!(off_deg.abs() < sigma_deg, "{line}: {off_deg}");
        }
    }
    let readme = include_str!("../../README.md");
    assert!(readme.contains(&format!("```text\n{printed}```")), "README shows other lines than these:\n{printed}");
    let own = include_str!("readme.rs");
    let code = &own[own.find("use magcomp").unwrap()..own.find("\n#[test]").unwrap()];
    assert!(readme.contains(&format!("```rust\n{code}```")), "README's code is not that of this test");
    let registry = include_str!("../../rust/magcomp/README.md");
    assert!(registry.contains(&format!("```rust\n{code}```")), "the crate's README has other code");
}

//! A compass of a stream of events: `zcat EVENTS.gz | cargo run --release -p magcomp --example compass`.
//!
//! A line of stdin is one event: m (magnetometer, uT), g (gyroscope, rad/s) or a (accelerometer, m/s^2), the time in ns of one clock, x, y, z. Each
//! magnetic sample gives a line; at the end stderr has the calibration for the next launch. `c/examples/stream.c` is the same in C.

use magcomp::nalgebra::Vector3;
use magcomp::{Compensator, Config, MagneticSample, RotationRateSample, UpSample};
use std::time::{SystemTime, UNIX_EPOCH};

/// The sensor, the time in ns and the three values.
fn event(line: &str) -> Option<(&str, i64, Vector3<f64>)> {
    let mut words = line.split_whitespace();
    let (sensor, time_ns) = (words.next()?, words.next()?.parse().ok()?);
    let mut value = || words.next()?.parse().ok();
    Some((sensor, time_ns, Vector3::new(value()?, value()?, value()?)))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut config = Config::default();
    config.heading.declination_deg = Some(2.5); // of the place: from magnetic to true north
    let mut compensator = Compensator::new(config)?;
    for line in std::io::stdin().lines() {
        let line = line?;
        let (sensor, time_ns, value) = event(&line).ok_or_else(|| format!("not an event: {line}"))?;
        // an event that cannot be used is refused, says why, and changes nothing
        let _ = match sensor {
            "g" => compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s: value }),
            "a" => compensator.push_up(UpSample { time_ns, up_m_s2: value }),
            _ => {
                let reading = compensator.push(MagneticSample { time_ns, field_ut: value });
                let heading_deg = reading.heading.and_then(|it| it.true_heading_deg).unwrap_or(f64::NAN);
                let sigma_deg = reading.heading.and_then(|it| it.heading_sigma_deg).unwrap_or(f64::NAN);
                // NaN until there is a heading; the status says what is missing
                println!("{heading_deg:.2} +- {sigma_deg:.2} deg, {}", reading.status);
                continue;
            }
        };
    }
    if let Some(kept) = compensator.keep(SystemTime::now().duration_since(UNIX_EPOCH)?.as_secs() as i64) {
        eprintln!("{}", kept.to_json());
    }
    Ok(())
}

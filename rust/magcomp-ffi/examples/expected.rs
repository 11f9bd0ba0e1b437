//! What the core itself says of a shared recording and of the golden vectors, every number by its bits, for the tests
//! of the wrappers: `cargo run --example expected -- tests/recordings/NAME.csv.gz tests/vectors`.
//!
//! Lines: `reading TIME LABEL BITS...` (field, total field, heading, its sigma, inclination, attitude w x y z, its
//! sigma, sigma_T, window, coverage), `fit NAME BITS...` (b, M, field strength) and `heading NUMBER BITS...` (for each axis, each screen rotation); `-` for
//! what is not known.

use magcomp::nalgebra::Vector3;
use magcomp::{
    Compensator, Config, FitOptions, MagneticSample, Reading, ReferenceAxis, RotationRateSample, ScreenRotation,
    UpSample,
};
use std::fmt::Write;
use std::io::Read;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, recording, vectors] = arguments.as_slice() else { return Err("usage: expected RECORDING VECTORS".into()) };
    let mut out = String::new();
    readings(Path::new(recording), &mut out)?;
    fits(&Path::new(vectors).join("ellipsoid.json"), &mut out)?;
    headings(&Path::new(vectors).join("headings.json"), &mut out)?;
    print!("{out}");
    Ok(())
}

fn readings(path: &Path, out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let mut text = String::new();
    flate2::read::GzDecoder::new(std::fs::File::open(path)?).read_to_string(&mut text)?;
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().ok_or("no header")?.split(',').collect();
    let column = |name: &str| header.iter().position(|column| *column == name).ok_or(format!("no column {name}"));
    let triple = |a, b, c| Ok::<_, String>([column(a)?, column(b)?, column(c)?]);
    let (time, rate, up, field) =
        (column("t_s")?, triple("gx", "gy", "gz")?, triple("ax", "ay", "az")?, triple("mx", "my", "mz")?);
    let mut config = Config::default();
    // the border's default
    config.heading.axis = ReferenceAxis::Auto;
    let mut compensator = Compensator::new(config)?;
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let vector = |at: [usize; 3]| -> Result<_, std::num::ParseFloatError> {
            Ok(Vector3::new(cells[at[0]].parse()?, cells[at[1]].parse()?, cells[at[2]].parse()?))
        };
        let time_ns = (cells[time].parse::<f64>()? * 1e9).round() as i64;
        // what is not used is not used in Kotlin either
        let _ = compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s: vector(rate)? });
        let _ = compensator.push_up(UpSample { time_ns, up_m_s2: vector(up)? });
        write_reading(&compensator.push(MagneticSample { time_ns, field_ut: vector(field)? }), out)?;
    }
    Ok(())
}

fn write_reading(reading: &Reading, out: &mut String) -> std::fmt::Result {
    write!(out, "reading {} {}", reading.time_ns, reading.status.label())?;
    for axis in 0..3 {
        bits(reading.field_ut.map(|field| field[axis]), out)?;
    }
    bits(reading.total_field_ut, out)?;
    bits(reading.heading.map(|heading| heading.heading_deg), out)?;
    bits(reading.heading.and_then(|heading| heading.heading_sigma_deg), out)?;
    bits(reading.heading.and_then(|heading| heading.inclination_deg), out)?;
    for k in [3, 0, 1, 2] {
        bits(reading.attitude.map(|attitude| attitude.to_world.coords[k]), out)?;
    }
    bits(reading.attitude.and_then(|attitude| attitude.sigma_deg), out)?;
    bits(reading.sigma_t, out)?;
    bits(Some(reading.window as f64), out)?;
    bits(Some(reading.coverage), out)?;
    writeln!(out)
}

fn bits(value: Option<f64>, out: &mut String) -> std::fmt::Result {
    match value {
        Some(value) => write!(out, " {:x}", value.to_bits()),
        None => write!(out, " -"),
    }
}

fn fits(path: &Path, out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let vectors: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    for case in vectors["cases"].as_array().ok_or("no cases")? {
        let mut session = magcomp::ConstantField::new(1);
        for point in case["points_ut"].as_array().ok_or("no points")? {
            session.add(&vector(point)?)?;
        }
        write!(out, "fit {}", case["name"].as_str().ok_or("no name")?.replace(' ', "_"))?;
        match session.finish(&FitOptions::default()) {
            Ok(fit) => {
                let (b, m) = (fit.calibration.hard_iron_ut(), fit.calibration.soft_iron());
                for value in [b.x, b.y, b.z, m.m11, m.m22, m.m33, m.m12, m.m13, m.m23] {
                    bits(Some(value), out)?;
                }
                bits(Some(fit.calibration.field_strength_ut()), out)?;
            }
            Err(_) => bits(None, out)?,
        }
        writeln!(out)?;
    }
    Ok(())
}

fn headings(path: &Path, out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let vectors: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    for (number, case) in vectors["attitudes"].as_array().ok_or("no attitudes")?.iter().enumerate() {
        let (field_ut, up) = (vector(&case["field_ut"])?, vector(&case["up"])?);
        write!(out, "heading {number}")?;
        for axis in [ReferenceAxis::TopEdge, ReferenceAxis::Camera, ReferenceAxis::Auto] {
            for rotation in
                [ScreenRotation::Deg0, ScreenRotation::Deg90, ScreenRotation::Deg180, ScreenRotation::Deg270]
            {
                bits(magcomp::heading(&field_ut, &up, axis, rotation).map(|heading| heading.heading_deg), out)?;
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

fn vector(value: &serde_json::Value) -> Result<Vector3<f64>, Box<dyn std::error::Error>> {
    let component = |k: usize| value[k].as_f64().ok_or("not three numbers");
    Ok(Vector3::new(component(0)?, component(1)?, component(2)?))
}

//! throw-away: plays many flat files; out: rows of f64 t,hd,sg,status,f3,b3 at magnetometer rows; events in .ev
use magcomp::nalgebra::Vector3;
use magcomp::{Compensator, Config, MagneticSample, RotationRateSample, Status, UpSample};
use std::sync::atomic::{AtomicUsize, Ordering};
fn play(path: &str, out: &str, no_gyro: bool) {
    let bytes = std::fs::read(path).unwrap();
    let v: Vec<f64> = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let mut config = Config::default();
    let base = path.rsplit('/').next().unwrap();
    if base.starts_with('f') {
        config.heading.axis = magcomp::ReferenceAxis::Auto;
    }
    let mut c = Compensator::new(config).unwrap();
    let mut o: Vec<u8> = vec![];
    let mut ev = String::new();
    let mut last = None;
    for r in v.chunks_exact(10) {
        let three = |i: usize| {
            let x = Vector3::new(r[i], r[i + 1], r[i + 2]);
            x.iter().all(|y| y.is_finite()).then_some(x)
        };
        let time_ns = (r[0] * 1e9).round() as i64;
        if let Some(rate_rad_s) = three(7).filter(|_| !no_gyro) {
            let _ = c.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s });
        }
        if let Some(up_m_s2) = three(4) {
            let _ = c.push_up(UpSample { time_ns, up_m_s2 });
        }
        let mut row = [f64::NAN; 10];
        row[0] = r[0];
        let Some(field_ut) = three(1) else {
            if !base.starts_with('f') {
                for x in row {
                    o.extend(x.to_le_bytes());
                }
            }
            continue;
        };
        let a = c.push(MagneticSample { time_ns, field_ut });
        if let Some(h) = a.heading {
            row[1] = h.heading_deg;
            row[2] = h.heading_sigma_deg.unwrap_or(f64::NAN);
        }
        row[3] = match a.status {
            Status::Collecting(_) => 0.,
            Status::Tracking => 1.,
            Status::Suspect { .. } => 2.,
            Status::Held(_) => 3.,
            Status::Disturbed { .. } => 4.,
            _ => 5.,
        };
        if let Some(f) = a.filtered_field_ut {
            row[4] = f.x;
            row[5] = f.y;
            row[6] = f.z;
        }
        if let Some(k) = c.calibration() {
            let b = k.hard_iron_ut();
            row[7] = b.x;
            row[8] = b.y;
            row[9] = b.z;
        }
        if let Some(e) = a.event
            && Some(e) != last
        {
            last = Some(e);
            ev += &format!("{:?} {} {}\n", e.kind, e.since_ns as f64 / 1e9, e.decided_ns as f64 / 1e9);
        }
        for x in row {
            o.extend(x.to_le_bytes());
        }
    }
    std::fs::write(out, o).unwrap();
    std::fs::write(format!("{out}.ev"), ev).unwrap();
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let no_gyro = a[2] == "nogyro";
    let files: Vec<String> = std::fs::read_to_string(&a[3]).unwrap().lines().map(String::from).collect();
    let next = AtomicUsize::new(0);
    std::thread::scope(|s| {
        for _ in 0..2 {
            s.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let Some(f) = files.get(i) else { break };
                    let base = f.rsplit('/').next().unwrap().trim_end_matches(".bin").to_string();
                    play(f, &format!("{}/{}.o", a[1], base), no_gyro);
                }
            });
        }
    });
}

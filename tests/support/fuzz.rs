//! Work of a fuzzer: bytes become a config and a stream of events, or a kept text, and what must hold whatever they are is asserted. `host/fuzz.rs`
//! runs them as a plain loop, `fuzz/` under libFuzzer.

use arbitrary::{Arbitrary, Result, Unstructured};
use magcomp::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use magcomp::{
    AttitudeSample, Calibration, Compensator, Config, HeadedAxis, HeadingConfig, HeadingSample, KeptCalibration,
    MagneticSample, Method, NorthReference, Reading, ReferenceAxis, RotationRateSample, ScreenRotation, Status,
    UpSample, Yaw,
};

/// A stream of events with a config. A reading is finite and in its range; what is refused changes nothing; equal compensators answer alike.
///
/// # Panics
/// When one of that does not hold.
pub fn stream(data: &[u8]) {
    let mut bytes = Unstructured::new(data);
    // where the bytes end, the stream does
    let _ = events(&mut bytes);
}

/// A text as one of `KeptCalibration::to_json`: refused, or taken and then kept again as the same.
///
/// # Panics
/// When it does not hold.
pub fn kept(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    match KeptCalibration::from_json(&text) {
        Err(why) => assert!(!why.to_string().is_empty()),
        Ok(kept) => {
            assert_eq!(KeptCalibration::from_json(&kept.to_json()).as_ref(), Ok(&kept));
            let mut compensator = Compensator::new(Config::default()).expect("the default");
            compensator.adopt(&kept, Some(0));
            assert!(compensator.calibration().is_some());
        }
    }
}

/// A number: of the usual size mostly, else hostile.
fn number(bytes: &mut Unstructured<'_>, size: f64) -> Result<f64> {
    const HOSTILE: [f64; 10] =
        [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN_POSITIVE, 5e-324, -0.0, 1e300, -1e-300, 1e16];
    Ok(match u8::arbitrary(bytes)? {
        0..=9 => f64::arbitrary(bytes)?,
        10..=19 => *bytes.choose(&HOSTILE)?,
        20..=29 => 0.0,
        _ => size * f64::from(i16::arbitrary(bytes)?) / f64::from(i16::MAX),
    })
}

fn vector(bytes: &mut Unstructured<'_>, size: f64) -> Result<Vector3<f64>> {
    Ok(Vector3::new(number(bytes, size)?, number(bytes, size)?, number(bytes, size)?))
}

fn config(bytes: &mut Unstructured<'_>) -> Result<Config> {
    let method = *bytes.choose(&[Method::Auto, Method::Auto, Method::Adaptive, Method::Windowed, Method::Constant])?;
    let mut config = Config { method, heading: heading(bytes)?, ..Config::default() };
    if bool::arbitrary(bytes)? {
        config.range_ut = number(bytes, 3000.0)?;
        config.initial_sigma_ut = number(bytes, 20.0)?;
    }
    if bool::arbitrary(bytes)? {
        config.rail_ut = Some(number(bytes, 2000.0)?);
        config.field_strength_ut = Some(number(bytes, 80.0)?);
    }
    if bool::arbitrary(bytes)? {
        (config.windowed.n_min, config.windowed.n_max) =
            (usize::arbitrary(bytes)? % 200, usize::arbitrary(bytes)? % 600);
        config.windowed.sigma_th = number(bytes, 1.0)?;
        config.windowed.noise_floor_ut = number(bytes, 2.0)?;
    }
    Ok(config)
}

fn heading(bytes: &mut Unstructured<'_>) -> Result<HeadingConfig> {
    use ScreenRotation::{Deg0, Deg90, Deg180, Deg270};
    Ok(HeadingConfig {
        axis: *bytes.choose(&[ReferenceAxis::TopEdge, ReferenceAxis::Camera, ReferenceAxis::Auto])?,
        screen_rotation: *bytes.choose(&[Deg0, Deg90, Deg180, Deg270])?,
        declination_deg: bool::arbitrary(bytes)?.then(|| number(bytes, 30.0)).transpose()?,
        ..HeadingConfig::default()
    })
}

/// The device that the events are about, so that many are plausible.
struct Device {
    time_ns: i64,
    attitude: UnitQuaternion<f64>,
    rate_rad_s: Vector3<f64>,
    hard_iron_ut: Vector3<f64>,
}

impl Device {
    /// Its time, mostly: else another clock, or any.
    fn time(&self, bytes: &mut Unstructured<'_>) -> Result<i64> {
        Ok(match u8::arbitrary(bytes)? {
            0..=5 => i64::arbitrary(bytes)?,
            6..=12 => self.time_ns.saturating_sub(i64::from(u32::arbitrary(bytes)?)),
            13..=19 => self.time_ns.saturating_add(i64::from(u32::arbitrary(bytes)?) * 3),
            _ => self.time_ns,
        })
    }
}

fn events(bytes: &mut Unstructured<'_>) -> Result<()> {
    let config = config(bytes)?;
    let valid = config.validate();
    let made = Compensator::new(config);
    assert_eq!(made.is_ok(), valid.is_ok());
    let mut it = made.unwrap_or_else(|_| Compensator::new(Config::default()).expect("the default"));
    let mut device = Device {
        time_ns: i64::from(i32::arbitrary(bytes)?),
        attitude: UnitQuaternion::identity(),
        rate_rad_s: Vector3::zeros(),
        hard_iron_ut: vector(bytes, 300.0)?,
    };
    while !bytes.is_empty() {
        match u8::arbitrary(bytes)? {
            // most of a stream is a device that moves: a few bytes lead far
            0..=149 => steady(&mut it, &mut device, bytes)?,
            150..=179 => {
                let sample = MagneticSample { time_ns: device.time(bytes)?, field_ut: vector(bytes, 100.0)? };
                push(&mut it, sample);
            }
            180..=194 => {
                let sample = RotationRateSample { time_ns: device.time(bytes)?, rate_rad_s: vector(bytes, 5.0)? };
                unchanged_if_refused(&mut it, |it| it.push_rotation_rate(sample).is_err());
            }
            195..=209 => {
                let sample = UpSample { time_ns: device.time(bytes)?, up_m_s2: vector(bytes, 15.0)? };
                unchanged_if_refused(&mut it, |it| it.push_up(sample).is_err());
            }
            210..=219 => {
                let axis =
                    if bool::arbitrary(bytes)? { HeadedAxis::Vehicle } else { HeadedAxis::Device(vector(bytes, 1.0)?) };
                let reference = if bool::arbitrary(bytes)? { NorthReference::True } else { NorthReference::Magnetic };
                let (heading_deg, sigma_deg) = (number(bytes, 360.0)?, number(bytes, 20.0)?.abs());
                let sample = HeadingSample { time_ns: device.time(bytes)?, heading_deg, sigma_deg, reference, axis };
                unchanged_if_refused(&mut it, |it| it.push_heading(sample).is_err());
            }
            220..=226 => {
                let (v, w) = (vector(bytes, 1.0)?, number(bytes, 1.0)?);
                let to_world = UnitQuaternion::new_unchecked(Quaternion::new(w, v.x, v.y, v.z));
                let yaw = if bool::arbitrary(bytes)? {
                    Yaw::Relative
                } else {
                    Yaw::Absolute { sigma_deg: number(bytes, 10.0)?, reference: NorthReference::Magnetic }
                };
                let sample = AttitudeSample { time_ns: device.time(bytes)?, to_world, yaw };
                unchanged_if_refused(&mut it, |it| it.push_attitude(sample).is_err());
            }
            227..=231 => {
                let heading = heading(bytes)?;
                unchanged_if_refused(&mut it, |it| it.set_heading(heading).is_err());
            }
            232..=236 => {
                let hidden_s = number(bytes, 1e5)?;
                unchanged_if_refused(&mut it, |it| it.push_gap(hidden_s).is_err());
            }
            237..=241 => {
                let unix_time_s = i64::arbitrary(bytes)?;
                if let Some(kept) = it.keep(unix_time_s) {
                    let again = KeptCalibration::from_json(&kept.to_json());
                    assert_eq!(again.as_ref(), Ok(&kept));
                    it.adopt(&kept, bool::arbitrary(bytes)?.then_some(i64::arbitrary(bytes)?));
                }
            }
            242..=246 => {
                let soft_iron = magcomp::nalgebra::Matrix3::from_diagonal(&vector(bytes, 2.0)?);
                let given = Calibration::from_any(soft_iron, vector(bytes, 300.0)?, number(bytes, 60.0)?);
                let sigma_ut = number(bytes, 20.0)?;
                if let Some(Ok(kept)) = given.ok().map(|(given, _)| KeptCalibration::given(given, sigma_ut)) {
                    it.adopt(&kept, None);
                }
            }
            247..=249 => it.reset(),
            250..=252 => device.hard_iron_ut = vector(bytes, 300.0)?,
            _ => device.time_ns = device.time_ns.saturating_add(i64::from(u32::arbitrary(bytes)?) * 1000),
        }
    }
    Ok(())
}

/// Some hundred samples of a moving device, with all its sensors or without some.
fn steady(it: &mut Compensator, device: &mut Device, bytes: &mut Unstructured<'_>) -> Result<()> {
    let [has_gyroscope, has_accelerometer] = [u8::arbitrary(bytes)? > 60, u8::arbitrary(bytes)? > 30];
    let (samples, period_ns) = (u8::arbitrary(bytes)?, i64::from(u16::arbitrary(bytes)? % 100) * 500_000 + 2_000_000);
    device.rate_rad_s = Vector3::new(
        f64::from(i8::arbitrary(bytes)?) / 40.0,
        f64::from(i8::arbitrary(bytes)?) / 40.0,
        f64::from(i8::arbitrary(bytes)?) / 40.0,
    );
    for k in 0..samples {
        let dt_s = period_ns as f64 * 1e-9;
        device.time_ns = device.time_ns.saturating_add(period_ns);
        device.attitude *= UnitQuaternion::from_scaled_axis(device.rate_rad_s * dt_s);
        let (time_ns, to_device) = (device.time_ns, device.attitude.inverse());
        if has_gyroscope {
            let _ = it.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s: device.rate_rad_s });
        }
        if has_accelerometer {
            let _ = it.push_up(UpSample { time_ns, up_m_s2: to_device * Vector3::new(0.0, 0.0, 9.81) });
        }
        // some noise that needs no bytes
        let noise = Vector3::from_fn(|axis, _| 0.4 * (f64::from(k) * (12.9898 + 3.1 * axis as f64)).sin());
        push(
            it,
            MagneticSample {
                time_ns,
                field_ut: to_device * Vector3::new(0.0, 20.0, -43.0) + device.hard_iron_ut + noise,
            },
        );
    }
    Ok(())
}

fn push(it: &mut Compensator, sample: MagneticSample) {
    // a copy is dear: one in eight, by the sample itself
    let before = (sample.time_ns & 7 == 0).then(|| it.clone());
    let refused = it.check(&sample).err();
    let reading = it.push(sample);
    finite(&reading);
    if let (Status::Rejected(why), Some(before)) = (reading.status, &before) {
        // axes are told by many samples together, of which this is one
        let is_of_many = matches!(why, magcomp::RejectReason::Axes { .. });
        assert!(is_of_many || Some(why) == refused, "{why} is told and not {refused:?}");
        // at the sensor's full scale the gyroscope carries on
        let is_carried = matches!(why, magcomp::RejectReason::Saturated { .. });
        assert!(is_carried || is_of_many || *it == *before, "a sample that was rejected has changed something: {why}");
    } else if let Some(mut before) = before {
        assert!(before.push(sample) == reading && before == *it, "a copy answers otherwise");
    }
}

fn unchanged_if_refused(it: &mut Compensator, act: impl FnOnce(&mut Compensator) -> bool) {
    let before = it.clone();
    if act(it) {
        assert!(*it == before, "what was refused has changed something");
    }
}

/// Every number of a reading is finite and in its range.
fn finite(reading: &Reading) {
    let fine = |value: Option<f64>, low: f64, high: f64| value.is_none_or(|value| (low..=high).contains(&value));
    let vector = |v: Option<Vector3<f64>>| v.is_none_or(|v| v.iter().all(|value| value.is_finite()));
    assert!(vector(reading.field_ut) && vector(reading.filtered_field_ut), "{reading:?}");
    assert!(fine(reading.field_sigma_ut, 0.0, f64::MAX) && fine(reading.total_field_ut, 0.0, f64::MAX), "{reading:?}");
    assert!(
        fine(reading.direction_sigma_deg, f64::MIN_POSITIVE, 180.0) && fine(reading.sigma_t, 0.0, f64::MAX),
        "{reading:?}"
    );
    assert!((0.0..=1.0).contains(&reading.coverage), "{reading:?}");
    if let Some(heading) = reading.heading {
        assert!((0.0..360.0).contains(&heading.heading_deg), "{heading:?}");
        assert!(
            fine(heading.heading_sigma_deg, 0.0, 180.0) && fine(heading.true_heading_deg, 0.0, 360.0),
            "{heading:?}"
        );
        assert!(heading.inclination_deg.is_none_or(|dip_deg| (-90.0..=90.0).contains(&dip_deg)), "{heading:?}");
    }
    if let Some(attitude) = reading.attitude {
        assert!((attitude.to_world.norm() - 1.0).abs() < 1e-9 && fine(attitude.sigma_deg, 0.0, 180.0), "{attitude:?}");
    }
}

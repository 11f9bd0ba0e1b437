//! What `magcomp check` finds in a recording that was spoilt, and that it finds nothing in others.

use crate::folder;
use crate::simulated::{Change, FieldChange, Phone, rows};
use magcomp::nalgebra::Vector3;

/// Runs `check`; exit code, kinds of findings and their texts.
fn checked(text: &str, options: &[&str]) -> (i32, Vec<String>, String) {
    let folder = folder(&[("r.csv", text)]);
    let path = folder.path().join("r.csv");
    let (code, out, error) = crate::run(&[&["check", path.to_str().unwrap(), "--json"], options].concat());
    let told: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out} {error}"));
    let findings = told["findings"].as_array().unwrap();
    let of = |name: &str| findings.iter().map(|finding| finding[name].as_str().unwrap().to_owned()).collect::<Vec<_>>();
    (code, of("kind"), of("text").join("\n"))
}

/// The option that a text names behind its last `--` of this name.
fn option(text: &str, name: &str) -> String {
    let rest = text.rsplit_once(name).unwrap_or_else(|| panic!("{name} in {text}")).1;
    rest.split_whitespace().next().unwrap().trim_end_matches([')', ';', ',']).to_owned()
}

const PHONES: [&str; 3] = ["phone-steady", "phone-walk-steady", "phone-planar"];

#[test]
fn nothing_is_amiss_where_nothing_was_spoilt() {
    for (k, name) in PHONES.into_iter().enumerate() {
        for seed in 0..3 {
            let (code, kinds, text) = checked(&rows(&Phone::of(name, 20 + seed + k as u64)), &[]);
            assert!(code == 0 && kinds.is_empty(), "{name} {seed}: {text}");
        }
    }
}

#[test]
fn every_wrong_axis_of_the_magnetometer_is_found_and_mended() {
    let turns: [(FieldChange, &str); 4] = [
        (|_, m| Vector3::new(m.y, -m.x, m.z), "m=-y,x,z"),
        (|_, m| Vector3::new(-m.x, m.y, m.z), "m=-x,y,z"),
        (|_, m| Vector3::new(m.y, m.x, m.z), "m=y,x,z"),
        (|_, m| Vector3::new(m.x, m.z, m.y), "m=x,z,y"),
    ];
    for (field, expected) in turns {
        let spoilt = rows(&Phone { field, ..Phone::of("phone-steady", 31) });
        let (code, kinds, text) = checked(&spoilt, &[]);
        assert!(code == 3 && kinds == ["field_axes"] && text.contains(&format!("--frame {expected} ")), "{text}");
        let (code, kinds, text) = checked(&spoilt, &["--frame", expected]);
        assert!(code == 0 && kinds.is_empty(), "{expected}: {text}");
    }
}

#[test]
fn every_wrong_unit_and_sign_is_found_and_mended() {
    let phone = || Phone::of("phone-steady", 32);
    let spoilt = [
        (Phone { rate: |g| g * 57.295_779_5, slower: 4, ..phone() }, "gyroscope_unit", "g=deg/s"),
        (Phone { field: |_, m| m * 10.0, ..phone() }, "field_unit", "m=mG"),
        (Phone { up: |a| -a, ..phone() }, "accelerometer_sign", "a=-m/s2"),
    ];
    for (phone, kind, units) in spoilt {
        let text = rows(&phone);
        let place = if kind == "accelerometer_sign" { &["--place", "45,5"][..] } else { &[] };
        let (code, kinds, told) = checked(&text, place);
        assert!(code == 3 && kinds.iter().any(|found| found == kind), "{kind}: {kinds:?} {told}");
        assert_eq!(option(told.lines().next().unwrap(), "--units "), units);
        let (code, kinds, told) = checked(&text, &[&["--units", units], place].concat());
        assert!(code == 0 && kinds.is_empty(), "{kind}: {told}");
    }
    // the gyroscope's own axes: swapped, flipped; and turned, which the field's could be as well
    let spoilt: [(Change, &str); 2] =
        [(|g| Vector3::new(g.y, g.x, g.z), "g=y,x,z"), (|g| Vector3::new(g.x, g.y, -g.z), "g=x,y,-z")];
    for (rate, axes) in spoilt {
        let text = rows(&Phone { rate, ..phone() });
        let (code, kinds, told) = checked(&text, &[]);
        assert!(code == 3 && kinds == ["gyroscope_axes"] && told.contains(&format!("--frame {axes}")), "{told}");
        assert!(checked(&text, &["--frame", axes]).1.is_empty());
    }
    let turned = Phone { rate: |g| Vector3::new(g.y, -g.x, g.z), ..phone() };
    let (code, kinds, told) = checked(&rows(&turned), &[]);
    assert!(code == 3 && kinds.iter().any(|kind| kind == "gyroscope_axes" || kind == "field_axes"), "{told}");
}

#[test]
fn other_clocks_delays_and_samples_are_told() {
    let early = rows(&Phone { late_s: -0.15, ..Phone::of("phone-steady", 33) });
    let (_, kinds, text) = checked(&early, &[]);
    assert!(kinds == ["field_delay"] && text.contains("ms too early"), "{text}");
    let shift = option(&text, "--shift ");
    let (_, kinds, text) = checked(&early, &["--shift", &shift]);
    assert!(kinds.is_empty(), "{shift}: {text}");
    let clock = rows(&Phone { late_s: 1000.0, ..Phone::of("phone-steady", 33) });
    let (code, kinds, text) = checked(&clock, &[]);
    assert!(code == 3 && kinds == ["clock", "clock"] && text.contains("another clock"), "{text}");
    let mixed = Phone {
        field: |k, m| if k % 2 == 0 { m } else { m + Vector3::new(20.0, -15.0, 25.0) },
        ..Phone::of("phone-steady", 33)
    };
    let (code, kinds, text) = checked(&rows(&mixed), &[]);
    assert!(code == 0 && kinds == ["two_kinds"], "{text}");
    // a field of the mains, which is the place's: it turns with the device and beats
    let hum = Phone {
        field: |k, m| m + Vector3::new(1.2, -1.4, 0.8) * 2.0 * (std::f64::consts::PI * 0.998 * k as f64 + 1.0).sin(),
        ..Phone::of("phone-steady", 33)
    };
    let (code, kinds, text) = checked(&rows(&hum), &[]);
    assert!(code == 0 && kinds == ["hum"], "{text}");
    let dead = Phone { field: |_, m| Vector3::new(m.x, m.y, 0.0), ..Phone::of("phone-steady", 33) };
    let (code, kinds, text) = checked(&rows(&dead), &[]);
    assert!(
        code == 3
            && kinds.iter().any(|kind| kind == "dead_axis")
            && text.contains("the magnetometer's z never changes"),
        "{text}"
    );
    let broken = Phone {
        field: |k, m| if k % 10 == 0 { Vector3::repeat(f64::NAN) } else { m },
        ..Phone::of("phone-steady", 33)
    };
    let (code, kinds, text) = checked(&rows(&broken), &[]);
    assert!(
        code == 0 && kinds == ["no_numbers"] && text.contains("10 % of the magnetometer's samples are no numbers"),
        "{text}"
    );
}

/// Each question's answer, as `check --json` has it.
fn answers(text: &str, options: &[&str]) -> Vec<(String, String, String)> {
    let folder = folder(&[("r.csv", text)]);
    let path = folder.path().join("r.csv");
    let (_, out, error) = crate::run(&[&["check", path.to_str().unwrap(), "--json"], options].concat());
    let told: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out} {error}"));
    let word = |value: &serde_json::Value| value.as_str().unwrap().to_owned();
    let tested = told["tested"].as_array().unwrap().iter();
    tested.map(|it| (word(&it["what"]), word(&it["answer"]), word(&it["how"]))).collect()
}

#[test]
fn a_question_is_sound_wrong_or_could_not_be_tested() {
    let of = |answers: &[(String, String, String)], what: &str| {
        let found = answers.iter().find(|it| it.0 == what).unwrap_or_else(|| panic!("{what}: {answers:?}"));
        (found.1.clone(), found.2.clone())
    };
    let whole = rows(&Phone::of("phone-steady", 34));
    let turned = answers(&whole, &[]);
    for what in ["unit of the field", "axes of the magnetometer", "clocks", "samples", "unit and axes of the gyroscope"]
    {
        assert_eq!(of(&turned, what).0, "sound", "{turned:?}");
    }
    // two axes swapped, in a device that turns about the vertical alone: nothing tells it, and nothing is called sound
    let flat = rows(&Phone { field: |_, m| Vector3::new(m.y, m.x, m.z), ..Phone::of("phone-steady", 34) });
    let swapped = answers(&flat, &[]);
    assert_eq!(of(&swapped, "axes of the magnetometer").0, "wrong", "{swapped:?}");
    // without a gyroscope, and without anything else
    let cut = |text: &str, cells: usize| {
        text.lines().map(|line| line.split(',').take(cells).collect::<Vec<_>>().join(",") + "\n").collect::<String>()
    };
    let header = whole.lines().next().unwrap();
    assert!(header.starts_with("t_s,mx,my,mz,ax,ay,az,gx,gy,gz"), "{header}");
    let alone = answers(&cut(&whole, 4), &[]);
    let (answer, how) = of(&alone, "axes of the magnetometer");
    assert!(answer == "untested" && how == "record the gyroscope too", "{alone:?}");
    assert_eq!(of(&alone, "samples").0, "sound");
    let folder = folder(&[("r.csv", &cut(&whole, 4))]);
    let (code, table, _) = crate::run(&["check", folder.path().join("r.csv").to_str().unwrap()]);
    assert!(
        code == 0 && table.contains("questions could not be tested") && !table.contains("Nothing is amiss.\n"),
        "{table}"
    );
}

/// Glued askew: turned about the screen's normal by an angle that no axes are.
#[test]
fn a_magnetometer_that_is_askew_is_found_and_mended_by_its_angle() {
    let askew: [(FieldChange, f64); 3] = [
        (|_, m| magcomp::nalgebra::Rotation3::from_euler_angles(0.0, 0.0, 12_f64.to_radians()) * m, 12.0),
        (|_, m| magcomp::nalgebra::Rotation3::from_euler_angles(0.0, 0.0, (-25_f64).to_radians()) * m, -25.0),
        (|_, m| m, 0.0),
    ];
    for (field, deg) in askew {
        let text = rows(&Phone { field, ..Phone::of("phone-steady", 35) });
        let (code, kinds, told) = checked(&text, &[]);
        if deg == 0.0 {
            assert!(code == 0 && kinds.is_empty(), "{told}");
            continue;
        }
        assert!(code == 3 && kinds == ["field_askew"], "{deg}: {told}");
        let frame = option(&told, "--frame ");
        let back: f64 = frame.rsplit(',').next().unwrap().parse().unwrap();
        assert!((back + deg).abs() <= 3.0, "{frame}");
        let (code, kinds, told) = checked(&text, &["--frame", &frame]);
        assert!(code == 0 && kinds.is_empty(), "{frame}: {told}");
    }
}

/// Without a gyroscope the angle between gravity and field is the only witness.
#[test]
fn gravity_in_other_axes_is_found_without_a_gyroscope() {
    let without = |text: &str| {
        let line = |line: &str| line.split(',').take(7).collect::<Vec<_>>().join(",") + "\n";
        text.lines().map(line).collect::<String>()
    };
    let up: Change = |a| Vector3::new(a.y, -a.x, a.z);
    let spoilt = without(&rows(&Phone { up, ..Phone::of("phone-steady", 36) }));
    let (code, kinds, told) = checked(&spoilt, &[]);
    assert!(code == 3 && kinds == ["dip_axes"], "{told}");
    let frame = option(told.split(", or").next().unwrap(), "--frame ");
    assert_eq!(frame, "a=-y,x,z");
    let (code, kinds, told) = checked(&spoilt, &["--frame", &frame]);
    assert!(code == 0 && kinds.is_empty(), "{told}");
    let sound = without(&rows(&Phone::of("phone-steady", 36)));
    let (code, kinds, told) = checked(&sound, &[]);
    assert!(code == 0 && kinds.is_empty(), "{told}");
}

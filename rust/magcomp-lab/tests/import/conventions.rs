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
            assert!(code == 0 && kinds.iter().all(|kind| kind == "axis_vertical"), "{name} {seed}: {text}");
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
    assert!(code == 3 && kinds[0] == "two_kinds", "{text}");
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

//! Times that are too coarse, too far away, or that tell a date.

use crate::bag::bag;
use crate::{folder, imported, refused, run_in};
use std::fs;

#[test]
fn matlab_times_without_milliseconds_say_how_to_write_them() {
    let rows = |times: &dyn Fn(usize) -> String| {
        let rows = (0..300).map(|k| format!("{},20,{},-40\n", times(k), k % 7));
        format!("Timestamp,X,Y,Z\n{}", rows.collect::<String>())
    };
    let coarse = rows(&|k| format!("22-Nov-2026 10:11:{:02}", k / 100));
    let fine = rows(&|k| format!("22-Nov-2026 10:11:{:02}.{:02}0", k / 100, k % 100));
    let folder = folder(&[("MagneticField.csv", coarse.as_bytes())]);
    let error = refused(folder.path(), ".", &[]);
    assert!(
        error.contains("MagneticField.csv: line 2, column 1 (Timestamp): expected times with milliseconds"),
        "{error}"
    );
    assert!(error.contains("MagneticField.Timestamp.Format = \"dd-MMM-yyyy HH:mm:ss.SSS\""), "{error}");
    fs::write(folder.path().join("MagneticField.csv"), fine).unwrap();
    fs::write(folder.path().join("Acceleration.csv"), coarse).unwrap();
    let (text, warnings) = imported(folder.path(), ".", &[]);
    assert!(text.lines().count() == 301 && warnings.contains("Acceleration.Timestamp.Format"), "{warnings}");
}

#[test]
fn times_that_wrap_are_refused() {
    let rows = |first: &str, last: &str| {
        let rows = (0..40).map(|k| format!("{},20,{},-40\n", k * 10_000_000, k % 7)).collect::<String>();
        format!("t,mx,my,mz\n{first},20,30,-40\n{rows}{last},20,30,-40\n")
    };
    let options = ["--columns", "t=t", "--units", "t=ns"];
    for (first, last) in
        [("-9000000000000000000", "1"), ("0", "9000000000000000000"), ("-5000000000000000000", "5000000000000000000")]
    {
        let folder = folder(&[("r.csv", rows(first, last).as_bytes())]);
        let error = refused(folder.path(), "r.csv", &options);
        assert!(error.contains("expected a time within 146 years of zero"), "{error}");
    }
    let folder = folder(&[
        ("r.csv", b"t_s,mx,my,mz\n-8e9,20,30,-40\n0,20,30,-40\n8e9,20,30,-41\n"),
        ("b.mcap", &bag(5, None, u64::MAX - 10)),
        ("MagneticField.csv", b"Timestamp,X,Y,Z\n22-Nov-2190 10:11:12.340,20,30,-40\n"),
    ]);
    let (code, _, error) = run_in(folder.path(), &["replay", "r.csv"]);
    assert!(code == Some(1) && error.contains("r.csv: line 2, column 1 (t_s): expected a time in seconds"), "{error}");
    let error = refused(folder.path(), "b.mcap", &[]);
    assert!(
        error.contains("b.mcap: line 1, column 1 (/mag log_time): expected a time within 146 years of 1970"),
        "{error}"
    );
    assert!(refused(folder.path(), "MagneticField.csv", &[]).contains("expected a time such as"));
}

#[test]
fn a_place_takes_the_sessions_own_date() {
    // `date -u -d @1767225600` and so on; the model of the field begins with 2020
    for (unix_s, day) in [(1_767_225_600_u64, "2026-01-01"), (1_325_376_000, "2012-01-01")] {
        let rows = |from: u64| {
            let rows = (0..50).map(|k| format!("{from}.{k:02},20,{},-40\n", k % 7));
            format!("t_s,mx,my,mz\n{}", rows.collect::<String>())
        };
        let logger =
            format!("time,seconds_elapsed,z,y,x\n{unix_s}000000000,0,-40,30,20\n{unix_s}010000000,0.01,-40,30,20\n");
        let phyphox = "\"Time (s)\",\"Field x (µT)\",\"Field y (µT)\",\"Field z (µT)\"\n0,20,30,-40\n0.01,20,30,-41\n";
        let clock = format!(
            "\"event\",\"experiment time\",\"system time\",\"system time text\"\n\"START\",0,{unix_s}.25,\"\"\n"
        );
        let gnss = format!("UncalMag,{unix_s}000,65972055195160,221.5,89.5,-21.25,213.5,180.25,5.5\n");
        let place = folder(&[
            ("own.csv", rows(unix_s).as_bytes()),
            ("none.csv", rows(100).as_bytes()),
            ("gnss.txt", gnss.as_bytes()),
            ("Magnetometer.csv", logger.as_bytes()),
        ]);
        let inside = place.path().join("phyphox");
        fs::create_dir(&inside).unwrap();
        fs::write(inside.join("Magnetometer.csv"), phyphox).unwrap();
        fs::write(inside.join("time.csv"), clock).unwrap();
        let replay = |input: &str, date: &[&str]| {
            let (code, _, error) = run_in(place.path(), &[&["replay", input, "--place=-33.9,18.4"], date].concat());
            (code, error)
        };
        for input in ["own.csv", "gnss.txt", "phyphox", "Magnetometer.csv"] {
            let (code, error) = replay(input, &[]);
            if day > "2020" {
                assert_eq!((code, error.as_str()), (Some(0), ""), "{input}");
            } else {
                let told = format!("the recording is of {day}: total field and dip are those of 2020-01-01");
                assert!(code == Some(0) && error.contains(&told), "{error}");
            }
            assert_eq!(replay(input, &["--date", "2025-06-01"]).0, Some(0), "{input}");
        }
        let (code, error) = replay("none.csv", &[]);
        let why = "none.csv: its times do not say the date that --place needs; add --date YYYY-MM-DD";
        assert_eq!((code, error), (Some(2), format!("magcomp: {why}\n")));
        assert_eq!(replay("none.csv", &["--date", "2025-06-01"]).0, Some(0));
    }
}

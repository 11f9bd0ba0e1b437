//! Plain CSV: names, units, axes, and what is refused.

use crate::{RAW, folder, imported, refused, run};
use std::fs;

#[test]
fn plain_csv_by_names_units_and_axes() {
    let folder = folder(&[
        ("m.csv", "ms,right,up,out\n0,1,2,-4\n10,1.5,2.5,-4\n"),
        ("g.csv", "ms;p;q;r\n5;180;90;0\n"),
        ("own.csv", "t_s,mx,my,mz,gx,gy,gz\n0,20,30,40,,,\n0.005,,,,1,2,3\n0.01,21,30,40,,,\n"),
    ]);
    let path = |name: &str| folder.path().join(name);
    let columns = ["--columns", "t=ms,mx=right,my=up,mz=out,gx=p,gy=q,gz=r"];
    let units = ["--units", "t=ms,m=G,g=deg/s", "--frame", "y,-x,z"];
    let found =
        imported(&[&path("m.csv"), &path("g.csv")], &[columns, [units[0], units[1]], [units[2], units[3]]].concat());
    let half = std::f64::consts::FRAC_PI_2;
    let expected = format!(
        "t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n0.000000000,200,-100,-400,,,,,,\n0.005000000,,,,,,,{half},{},0\n0.010000000,250,-150,-400,,,,,,\n",
        -2.0 * half
    );
    assert_eq!(found, expected);
    // a recording's own names need no option
    assert_eq!(imported(&[&path("own.csv")], &[]).lines().nth(2).unwrap(), "0.005000000,,,,,,,1,2,3");
    let error = refused(&[&path("m.csv")], &[]);
    assert!(
        error.contains("line 1: expected a header of Sensor Logger") && error.contains("--columns t=NAME"),
        "{error}"
    );
    assert!(error.ends_with("found 'ms,right,up,out'\n"), "{error}");
    let error = refused(&[&path("g.csv")], &columns);
    assert!(error.contains("no magnetometer event"), "{error}");
    let error = refused(&[&path("m.csv")], &["--columns", "t=ms,mx=left,my=up,mz=out"]);
    assert!(error.contains("expected a header with the column 'left'"), "{error}");
}

#[test]
fn a_wrong_unit_is_told_with_the_option_that_mends_it() {
    let cases = [
        ("0,20,30,40", "10000000,21,30,40", "column 1 (t)", "time looks like nanoseconds: --units t=ns"),
        ("0,20,30,40", "10000,21,30,40", "column 1 (t)", "time looks like microseconds: --units t=us"),
        ("0,20,30,40", "10,21,30,40", "column 1 (t)", "time looks like milliseconds: --units t=ms"),
        ("0,0.2,0.3,0.4", "0.01,0.2,0.3,0.4", "column 2 (mx)", "mostly 0.539; it looks like G: --units m=G"),
        ("0,20000,30000,40000", "0.01,20000,30000,40000", "column 2 (mx)", "it looks like nT: --units m=nT"),
        ("0,2e-5,3e-5,4e-5", "0.01,2e-5,3e-5,4e-5", "column 2 (mx)", "it looks like T: --units m=T"),
    ];
    for (first, second, place, hint) in cases {
        let folder = folder(&[("r.csv", &format!("t,mx,my,mz\n{first}\n{second}\n"))]);
        let path = folder.path().join("r.csv");
        let error = refused(&[&path], &["--columns", "t=t"]);
        assert!(error.contains(&format!("r.csv: line 2, {place}: expected ")) && error.contains(hint), "{error}");
        // what the message says to do works
        let option = hint.rsplit_once("--units ").unwrap().1;
        assert_eq!(imported(&[&path], &["--columns", "t=t", "--units", option]).lines().count(), 3);
    }
    let inertial = |cells: &str| {
        folder(&[("r.csv", &format!("t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n0,20,30,40,{cells}\n0.01,21,30,40,{cells}\n"))])
    };
    let (g, degrees) = (inertial("0,0.1,1,0,0,1"), inertial("0,0.1,9.8,0,0,100"));
    assert!(refused(&[&g.path().join("r.csv")], &["--frame", "x,y,z"]).contains("it looks like g: --units a=g"));
    assert!(
        refused(&[&degrees.path().join("r.csv")], &["--frame", "x,y,z"])
            .contains("it looks like deg/s: --units g=deg/s")
    );
}

#[test]
fn a_recordings_own_units_and_marks_are_looked_at_too() {
    let rows = |row: &dyn Fn(u32) -> String| (0..50).map(row).collect::<String>();
    let cases = [
        (rows(&|k| format!("{},20,{},-40\n", 10 * k, k % 5)), "column 1 (t_s)", "--units t=ms"),
        (rows(&|k| format!("{},20000,{},-40000\n", f64::from(k) / 100.0, k % 5)), "column 2 (mx)", "--units m=nT"),
    ];
    for (text, place, hint) in cases {
        let folder = folder(&[("r.csv", &format!("t_s,mx,my,mz\n{text}"))]);
        let path = folder.path().join("r.csv");
        let (code, out, error) = run(&["replay", path.to_str().unwrap()]);
        assert!(code == 1 && out.is_empty() && error.contains(place) && error.trim_end().ends_with(hint), "{error}");
        let option = hint.split_once(' ').unwrap().1;
        assert_eq!(run(&["replay", path.to_str().unwrap(), "--units", option]).0, 0);
    }
    let nanoseconds = folder(&[("r.csv", "t_s,mx,my,mz\n1700000000000000000,20,3,-40\n")]);
    let (code, _, error) = run(&["replay", nanoseconds.path().join("r.csv").to_str().unwrap()]);
    let place =
        "r.csv: line 2, column 1 (t_s): expected a time in seconds; name another unit by --units t=ms, us or ns";
    assert!(code == 1 && error.contains(place), "{error}");
    // semicolons and decimal commas under a recording's own names
    let german = rows(&|k| format!("{};20;{};-40,5\n", f64::from(k) / 100.0, k % 5)).replace('.', ",");
    let folder = self::folder(&[("g.csv", &format!("t_s;mx;my;mz\n{german}"))]);
    let (code, out, error) = run(&["replay", folder.path().join("g.csv").to_str().unwrap()]);
    assert!(code == 0 && out.contains("plain CSV session"), "{error}");
    // decimal commas between commas make rows longer than the header
    let (folder, columns) = (self::folder(&[("c.csv", "t,mx,my,mz\n0,01,20,5,3,-40\n")]), ["--columns", "t=t"]);
    let error = refused(&[&folder.path().join("c.csv")], &columns);
    let place = "c.csv: line 2, column 5: expected 4 cells as in the header; a decimal comma needs semicolons or tabs";
    assert!(error.contains(place) && error.ends_with("found 6 cells\n"), "{error}");
    // which of two columns of a name?
    let folder = self::folder(&[("d.csv", "t,mx,mx,my,mz\n0,20,20,3,-40\n")]);
    let error = refused(&[&folder.path().join("d.csv")], &columns);
    assert!(error.contains("d.csv: line 1: expected column 'mx' once"), "{error}");
}

#[test]
fn what_is_no_text_and_two_sessions_at_once_are_refused() {
    let folder = folder(&[("Magnetometer.csv", RAW)]);
    let again = self::folder(&[("Magnetometer.csv", RAW)]);
    let error = refused(&[folder.path(), again.path()], &[]);
    assert!(error.contains("are of the same sensor: these are several recordings; give one at a time"), "{error}");
    for (bytes, hint) in [
        (&b"MATLAB 5.0 MAT-file\0\0"[..], "writetimetable"),
        (
            b"\x89MCAP0\r\n\0\0",
            if cfg!(feature = "formats") { "cannot be read: MCAP file ended" } else { "does not read" },
        ),
        (b"\xff\xfet\0,\0", "save it as UTF-8"),
        (b"\x7fELF\0\0\0\0", "this is no text file"),
    ] {
        let path = folder.path().join("session.bin");
        fs::write(&path, bytes).unwrap();
        let error = refused(&[&path], &[]);
        assert!(error.contains("session.bin: ") && error.contains(hint), "{error}");
    }
    let empty = tempfile::tempdir().unwrap();
    assert!(refused(&[empty.path()], &[]).contains("no file there ends in .csv, .txt, .csv.gz"));
    let cut = folder.path().join("cut.zip");
    fs::write(&cut, b"PK\x03\x04 and no more").unwrap();
    assert!(refused(&[&cut], &[]).contains("cut.zip: cannot be read"));
}

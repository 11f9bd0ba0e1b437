//! Loss is loud, and a damaged last line costs itself alone.

use crate::{folder, import, refused};
use std::fmt::Write as _;
use std::fs;

#[test]
fn a_cut_last_line_costs_itself_in_every_format() {
    let gnss = |count: usize| {
        let row = |k: usize| {
            format!("UncalMag,1663164669{k:03},65972{:03}055160,221.5,89.5,-21.25,213.5,180.25,5.5\n", 20 * k)
        };
        (0..count).map(row).collect::<String>()
    };
    let ipin = |count: usize| {
        (0..count).map(|k| format!("MAGN;0.{:03};5.{:03};20.5;30;-40.25;3\n", 20 * k, 20 * k)).collect::<String>()
    };
    let table = |header: &'static str| {
        move |count: usize| {
            let rows = (0..count).map(|k| format!("0.{k:02},20.5,30,-40.25\n")).collect::<String>();
            format!("{header}\n{rows}")
        }
    };
    let own = table("t_s,mx,my,mz");
    let phyphox = table("\"Time (s)\",\"Field x (µT)\",\"Field y (µT)\",\"Field z (µT)\"");
    let words = table("time (s),mag_x (uT),mag_y (uT),mag_z (uT)");
    type Rows<'a> = &'a dyn Fn(usize) -> String;
    let forms: [(&str, Rows<'_>, &str); 5] = [
        ("gnss.txt", &gnss, ","),
        ("ipin.txt", &ipin, ";"),
        ("r.csv", &own, ","),
        ("Magnetometer.csv", &phyphox, ","),
        ("w.csv", &words, ","),
    ];
    for (name, rows, delimiter) in forms {
        let whole = rows(30);
        // cut within its last number but one
        let last = whole.trim_end().rfind('\n').unwrap();
        let line = &whole[last + 1..];
        let value = line.match_indices(delimiter).nth(if name.ends_with("txt") { 3 } else { 1 }).unwrap().0;
        let cut = whole[..last + 1 + value + 3].to_owned();
        for text in [cut.clone(), format!("{cut}\n")] {
            let folder = folder(&[(name, &text)]);
            let (code, told, error, recording) = import(&[&folder.path().join(name)], &[]);
            assert_eq!((code, error.as_str()), (0, ""), "{name}");
            let rows = recording.unwrap().lines().skip(1).filter(|line| !line.starts_with(",")).count();
            assert_eq!(rows, 29, "{name}");
            assert!(told.contains("the last row was left out"), "{name}: {told}");
        }
        // the same in the middle is an error
        let damaged = format!("{cut}\n{line}");
        let folder = folder(&[(name, &damaged)]);
        assert!(refused(&[&folder.path().join(name)], &[]).contains("expected a number"), "{name}");
    }
}

#[test]
fn a_quotation_mark_costs_no_other_row() {
    let mut own = "t_s,mx,my,mz,note\n".to_owned();
    let mut gnss = String::new();
    for k in 0..100 {
        let note = if k == 20 {
            "\"broken"
        } else if k == 60 {
            "closed\""
        } else {
            "\"a, b\""
        };
        writeln!(own, "{},20,30,-40,{note}", f64::from(k) / 50.0).unwrap();
        writeln!(gnss, "UncalMag,1663164669{k:03},65972{:04}05516,221.5,89.5,-21.25,213.5,180.25,5.5", 20 * k).unwrap();
        if k == 20 || k == 60 {
            gnss.push_str("NAV,1,2,\"3,0\n");
        }
    }
    let folder = folder(&[("r.csv", &own), ("gnss.txt", &gnss)]);
    for name in ["r.csv", "gnss.txt"] {
        let (code, _, error, recording) = import(&[&folder.path().join(name)], &[]);
        assert_eq!((code, error.as_str(), recording.unwrap().lines().count()), (0, "", 101), "{name}");
    }
    let (code, out, _) =
        crate::run(&["replay", folder.path().join("r.csv").to_str().unwrap(), "--output", "/dev/stdout"]);
    assert!(code == 0 && out.lines().filter(|line| line.starts_with(char::is_numeric)).count() == 100, "{out}");
}

#[test]
fn rounded_times_are_spread_with_a_warning_and_lost_events_are_an_error() {
    let table = |times: &dyn Fn(u32) -> String| {
        (0..600).fold("t_s,mx,my,mz\n".to_owned(), |text, k| text + &format!("{},20.{k:03},30,-40\n", times(k)))
    };
    // as a spreadsheet shows them: three digits
    let rounded = table(&|k| format!("{:.1}", 10.0 + f64::from(k) * 0.02));
    // all events of a batch at one time
    let batches = table(&|k| format!("{}", f64::from(k / 10) * 0.3));
    let folder = folder(&[("rounded.csv", &rounded), ("batches.csv", &batches)]);
    let [rounded, batches] = ["rounded.csv", "batches.csv"].map(|name| folder.path().join(name));
    let (code, out, error, recording) = import(&[&rounded], &[]);
    assert!(
        code == 0
            && error.contains("the times are rounded to 0.1 s: ")
            && error.contains("save the times with more digits"),
        "{error}"
    );
    assert_eq!(recording.unwrap().lines().count(), 601, "{out}");
    let (code, _, error) = crate::run(&["replay", rounded.to_str().unwrap()]);
    assert!(code == 0 && error.contains("the times are rounded to 0.1 s"), "{error}");
    let error = refused(&[&batches], &[]);
    assert!(
        error.contains("540 events had the time of another")
            && error.contains("90 % of 600")
            && error.contains("--force"),
        "{error}"
    );
    assert_eq!(import(&[&batches], &["--force"]).3.unwrap().lines().count(), 61);
}

/// The file of an app that was ended while it wrote, packed: what is before the cut is read.
#[test]
fn a_packed_file_that_is_cut_off_gives_what_is_before_the_cut() {
    let mut text = "t_s,mx,my,mz,note\n".to_owned();
    (0..5000).for_each(|k| {
        text += &format!("{},{},{},-4{},\"a, \"\"b\"\"\"\n", f64::from(k) * 0.02, 20 + k * 7919 % 13, 30 + k % 5, k % 7)
    });
    let mut zip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    std::io::Write::write_all(&mut zip, text.as_bytes()).unwrap();
    let whole = zip.finish().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv.gz");
    for bytes in [&whole[..whole.len() / 2], &whole[..whole.len() - 4]] {
        fs::write(&path, bytes).unwrap();
        let (code, told, error, recording) = import(&[&path], &[]);
        assert!(code == 0 && told.contains("the file is cut off"), "{told}{error}");
        let rows = recording.unwrap().lines().count();
        assert!((1000..=5001).contains(&rows), "{rows}");
        let (code, table, error) = crate::run(&["check", path.to_str().unwrap()]);
        assert!(code == 0 && table.contains("the file is cut off"), "{table}{error}");
    }
    fs::write(&path, &whole[..5]).unwrap();
    assert!(refused(&[&path], &[]).contains("the file is cut off"));
}

//! Tables in Parquet and Arrow.

use crate::{folder, imported, refused, run, session};
use std::fs;

const TABLE: [&str; 2] = ["--columns", "t=time,mx=bx,my=by,mz=bz,gx=rate_x,gy=rate_y,gz=rate_z"];

const TABLE_READ: &str = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n\
                          0.000000000,20.5,-5,-40,,,,0.125,0.25,0.5\n\
                          0.010000000,21.5,-5.5,-41,,,,0.125,0.25,0.5\n\
                          0.020000000,,,,,,,0.125,0.25,0.5\n\
                          0.030000000,22.5,-6,-42,,,,0.125,0.25,0.5\n";

#[test]
fn a_table_in_parquet_or_arrow() {
    let whole_numbers = [TABLE.as_slice(), &["--units", "t=ns"]].concat();
    for name in ["table.parquet", "table_numbers.feather"] {
        assert_eq!(imported(&[&session(name)], &whole_numbers), TABLE_READ, "{name}");
        // the unit, the column and the form are named
        let error = refused(&[&session(name)], &TABLE);
        assert!(
            error.contains(&format!("{name} as CSV: line 2, column 1 (time)"))
                && error.contains("--units t=s, ms, us or ns"),
            "{error}"
        );
        let note = ["--columns", "t=time,mx=note,my=by,mz=bz", "--units", "t=ns"];
        let error = refused(&[&session(name)], &note);
        let place = format!("{name} as CSV: line 2, column 8 (note): expected a number, found 'a'");
        assert!(error.contains(&place), "{error}");
    }
    for name in ["table_timestamps.parquet", "table_nanoseconds.parquet", "table.feather", "table.arrow"] {
        assert_eq!(imported(&[&session(name)], &TABLE), TABLE_READ, "{name}");
        let (code, text, error) = run(&[&["replay", session(name).to_str().unwrap()], TABLE.as_slice()].concat());
        assert!(code == 0 && text.contains("answered"), "{name}: {error}");
    }
    let folder = folder(&[]);
    for name in ["table.parquet", "table.feather", "table.arrow"] {
        let cut = folder.path().join(name);
        fs::write(&cut, &fs::read(session(name)).unwrap()[..200]).unwrap();
        assert!(refused(&[&cut], &TABLE).contains(&format!("{name}: cannot be read: ")), "{name}");
    }
    let old = folder.path().join("old.feather");
    fs::write(&old, b"FEA1\0\0").unwrap();
    assert!(refused(&[&old], &TABLE).contains("pandas.read_feather(IN).to_feather(OUT)"));
}

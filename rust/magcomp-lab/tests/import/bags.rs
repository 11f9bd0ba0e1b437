//! A bag of ROS 2.

use crate::{folder, import, imported, refused, run, session};
use std::fs;

#[test]
fn a_bag_of_ros_2() {
    let line = |k: usize| {
        let (mag, imu) = (format!("0.0{k}0000000,{},-5,-40", 20 + k), format!("0.0{k}4000000"));
        format!("{mag},,,,,,\n{imu},,,,0.5,-0.25,9.75,0.1,0.2,{}\n", 0.25 * k as f64)
    };
    let lines = |text: &str| -> Vec<Vec<String>> {
        let cell = |cell: &str| cell.parse::<f64>().map_or_else(|_| cell.to_owned(), |v| format!("{v:.9}"));
        text.lines().map(|line| line.split(',').map(cell).collect()).collect()
    };
    let expected = format!("t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n{}", (0..5).map(line).collect::<String>());
    assert_eq!(lines(&imported(&[&session("ros2.mcap")], &[])), lines(&expected));
    // as ROS 2 writes it: a folder with metadata.yaml
    let folder = folder(&[("metadata.yaml", "rosbag2_bagfile_information:\n")]);
    fs::copy(session("ros2.mcap"), folder.path().join("bag_0.mcap")).unwrap();
    assert_eq!(lines(&imported(&[folder.path()], &[])), lines(&expected));
    let turned = imported(&[&session("ros2.mcap")], &["--frame=-y,x,z"]);
    assert_eq!(lines(&turned)[1][1..4], ["5.000000000", "20.000000000", "-40.000000000"]);
    let (code, text, error) = run(&["replay", session("ros2.mcap").to_str().unwrap()]);
    assert_eq!(code, 0, "{error}");
    assert!(text.contains("ROS 2 session") && text.contains("--frame=-y,x,z"), "{text}");

    // no stamps: the recorder's time; two topics of one kind
    let two = session("ros2_two_topics.mcap");
    let error = refused(&[&two], &[]);
    assert!(error.contains("MagneticField is on /gps/mag and /imu/mag; name one by --topics"), "{error}");
    let (code, text, error, recording) = import(&[&two], &["--topics", "/gps/mag,/imu/data_raw"]);
    assert_eq!((code, error.as_str()), (0, ""));
    assert!(text.contains("10 messages had no stamp"), "{text}");
    assert_eq!(lines(&recording.unwrap()), lines(&expected));
    // not tesla; cut off; of SQLite
    let error = refused(&[&session("ros2.mcap")], &["--units", "m=mT"]);
    assert!(error.contains("line 2, column 1 (/imu/mag magnetic_field): expected a field of 5 to 5000 uT"), "{error}");
    let bytes = fs::read(session("ros2.mcap")).unwrap();
    // cut before its first message
    let cut = folder.path().join("cut.mcap");
    fs::write(&cut, &bytes[..200]).unwrap();
    assert!(refused(&[&cut], &[]).contains("cut.mcap: cannot be read: "));
    let database = folder.path().join("bag.db3");
    fs::write(&database, b"SQLite format 3\0").unwrap();
    assert!(refused(&[&database], &[]).contains("`ros2 bag convert` makes an mcap file of it"));
}

use super::*;
use nalgebra::Vector3;

#[test]
fn another_version_of_the_library_reads_the_calibration_alone() {
    let calibration = Calibration::about(Vector3::new(1.0, -2.0, 0.1), 45.0);
    let ours = seal(Some(calibration), &7_u8);
    assert_eq!(open(&ours).unwrap().state(), Ok(Some(7_u8)));
    let (_, body) = ours.split_once("\"library\"").unwrap();
    let body = format!("\"library\"{body}").replacen(LIBRARY, "0.0.9", 1);
    let theirs = format!("{MARK}2,\"crc32\":\"{:08x}\",{body}", crc32fast::hash(body.as_bytes()));
    for other in [theirs, ours.replacen(":2,", ":1,", 1)] {
        let opened = open(&other).unwrap();
        assert_eq!(opened.calibration, Some(calibration));
        assert_eq!(opened.state::<u8>(), Ok(None));
    }
}

#[test]
fn the_checksum_is_that_of_the_catalogue() {
    assert_eq!(crc32fast::hash(b"123456789"), 0xcbf4_3926);
}

#[test]
fn a_state_that_is_too_long_or_too_short_is_damaged() {
    let text = seal(None, &[1_u16, 2]);
    assert_eq!(open(&text).unwrap().state(), Ok(Some([1_u16, 2])));
    assert_eq!(open(&text).unwrap().state::<[u16; 1]>(), Err(SnapshotError::Damaged));
    assert_eq!(open(&text).unwrap().state::<[u16; 3]>(), Err(SnapshotError::Damaged));
}

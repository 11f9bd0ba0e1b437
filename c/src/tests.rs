//! The header against these sources, the layout of the structs against `abi.txt`, a panic. The rest is tested from C and C++ (`tests/c.sh`).

use crate::calibration::Calibration;
use crate::compensator::Compensator;
use crate::error::Error;
use crate::fit::Fit;
use crate::grows::{Grows, fill, room};
use crate::reading::Reading;
use crate::settings::{Config, members};
use crate::status::{Event, HeadingAid, told};
use magcomp_core as core;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

/// `MAGCOMP_WRITE_HEADER=1 cargo test -p magcomp-c` writes it.
#[test]
fn header_is_that_of_the_sources() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut made = Vec::new();
    let config = cbindgen::Config::from_file(here.join("cbindgen.toml")).unwrap();
    cbindgen::generate_with_config(here, config).unwrap().write(&mut made);
    let (made, file) = (String::from_utf8(made).unwrap(), here.join("include/magcomp.h"));
    if std::env::var_os("MAGCOMP_WRITE_HEADER").is_some() {
        std::fs::write(&file, &made).unwrap();
    }
    let found = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(
        found == made,
        "include/magcomp.h is not what cbindgen writes: MAGCOMP_WRITE_HEADER=1 cargo test -p magcomp-c"
    );
}

/// `NAME SIZE`, then `NAME.MEMBER OFFSET SIZE` of every member: the compiler says where one is left out.
macro_rules! layout {
    ($lines:ident, $c:literal, $type:ident { $($member:ident),+ }) => {
        let size_of_member = |it: &$type| {
            let $type { $($member),+ } = it;
            [$((stringify!($member), size_of_val($member))),+]
        };
        let offsets = [$(std::mem::offset_of!($type, $member)),+];
        // SAFETY: numbers, and enums of which 0 is a case
        let sizes = size_of_member(&unsafe { std::mem::zeroed() });
        $lines.push(format!("struct {} {}", $c, size_of::<$type>()));
        for ((name, size), offset) in sizes.iter().zip(offsets) {
            $lines.push(format!("member {} {name} {offset} {size}", $c));
        }
    };
}

#[test]
#[cfg(target_pointer_width = "64")]
fn layout_is_that_of_abi_txt() {
    let mut lines = Vec::new();
    layout!(lines, "magcomp_calibration", Calibration { size, soft_iron, hard_iron_ut, field_strength_ut });
    members!(layout, lines, "magcomp_config");
    layout!(lines, "magcomp_fit", Fit { size, covariance, residual_rms_ut, direction_sigma_deg, problem });
    layout!(
        lines,
        "magcomp_reading",
        Reading {
            size,
            time_ns,
            field_ut,
            filtered_field_ut,
            field_sigma_ut,
            total_field_ut,
            heading_deg,
            heading_sigma_deg,
            true_heading_deg,
            inclination_deg,
            attitude,
            attitude_sigma_deg,
            sigma_t,
            coverage,
            direction_sigma_deg,
            worst_sigma_deg,
            window,
            status_since_ns,
            event_since_ns,
            event_decided_ns,
            status,
            reason,
            fit_problem,
            event,
            mode,
            model_order
        }
    );
    let of_abi = |line: &&str| line.starts_with("struct") || line.starts_with("member");
    let listed: Vec<&str> = include_str!("../abi.txt").lines().filter(of_abi).collect();
    assert!(lines == listed, "abi.txt lists another layout than\n{}", lines.join("\n"));
}

/// The codes of the header, by the example of `tests/vectors/statuses.json` that has each.
#[test]
fn every_status_has_its_codes() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/vectors/statuses.json");
    let all: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let list = |key: &str| all[key].as_array().unwrap().iter();
    let mut codes = ["STATUS", "REASON", "FIT_PROBLEM", "EVENT", "HEADING_AID"].map(|of| (of, BTreeSet::from([0])));
    for case in list("statuses") {
        let status: core::Status = ron::from_str(case["status"].as_str().unwrap()).unwrap();
        let (kind, reason, problem, since_ns) = told(&status);
        let its = [kind as i32, reason as i32, problem as i32];
        assert_eq!(json!(its), case["c"], "{status:?}");
        let since = matches!(status, core::Status::Suspect { .. } | core::Status::Disturbed { .. });
        assert_eq!(since_ns, if since { case["whole"][0].as_i64().unwrap() } else { 0 }, "{status:?}");
        its.into_iter().zip(&mut codes).for_each(|(code, (_, seen))| _ = seen.insert(code));
    }
    for case in list("events") {
        let kind: core::EventKind = ron::from_str(case["kind"].as_str().unwrap()).unwrap();
        assert_eq!(case["c"], Event::from(kind) as i32);
        codes[3].1.insert(Event::from(kind) as i32);
    }
    for case in list("heading_aids") {
        let aid: core::HeadingAid = ron::from_str(case["name"].as_str().unwrap()).unwrap();
        assert_eq!(case["c"], HeadingAid::from(aid) as i32);
        codes[4].1.insert(HeadingAid::from(aid) as i32);
    }
    for (of, seen) in codes {
        let its = |line: &str| line.strip_prefix(&format!("case MAGCOMP_{of}_"))?.rsplit_once(' ')?.1.parse().ok();
        let listed: BTreeSet<i32> = include_str!("../abi.txt").lines().filter_map(its).collect();
        assert_eq!(seen, listed, "{of}: statuses.json and abi.txt");
    }
}

/// A struct to which a later version appended `later`.
#[derive(Clone, Copy)]
#[repr(C)]
struct Grown {
    size: usize,
    first: u64,
    later: u64,
}

// SAFETY: numbers, of which the first is the size
unsafe impl Grows for Grown {
    const NAME: &str = "grown";
    const FIRST: usize = std::mem::offset_of!(Grown, later);
}

#[test]
fn a_later_version_fills_what_a_caller_of_the_first_knows() {
    let mut caller = Grown { size: Grown::FIRST, first: 1, later: 2 };
    // SAFETY: it has as much room as it says
    unsafe {
        let room = room(&raw const caller).unwrap();
        fill(&raw mut caller, room, Grown { size: size_of::<Grown>(), first: 3, later: 4 });
    }
    assert_eq!((caller.size, caller.first, caller.later), (Grown::FIRST, 3, 2));
}

#[test]
fn a_panic_is_an_error_until_reset() {
    let compensator = Compensator::new(magcomp_core::Config::default()).unwrap();
    let panicked = compensator.with(|_| panic!("on purpose")).unwrap_err();
    assert_eq!((panicked.code, panicked.why.contains("on purpose")), (Error::Panicked, true));
    assert_eq!(compensator.with(|_| Ok(())).unwrap_err().code, Error::Panicked, "refuses further use");
    compensator.reset().unwrap();
    compensator.with(|_| Ok(())).unwrap();
}

//! The header against these sources, the layout of the structs against `abi.txt`, a panic. The rest is tested from C and C++ (`tests/c.sh`).

use crate::calibration::Calibration;
use crate::compensator::Compensator;
use crate::error::Error;
use crate::fit::Fit;
use crate::grows::{Grows, fill, room};
use crate::reading::Reading;
use crate::settings::{Config, members};
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

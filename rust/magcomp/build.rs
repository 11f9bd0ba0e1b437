//! Names the build: the state in a snapshot is laid out as the sources have it, so only a build of the same sources reads it.

use std::fs;
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=src");
    let mut sources = Vec::new();
    gather(Path::new("src"), &mut sources);
    sources.sort();
    // FNV-1a (Fowler, Noll, Vo), 64 bits
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    for source in sources {
        for byte in fs::read(&source).expect("a source file can be read") {
            // a checkout with other line ends is the same build
            if byte != b'\r' {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
    }
    println!("cargo::rustc-env=MAGCOMP_BUILD={hash:016x}");
}

fn gather(folder: &Path, sources: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a source folder can be read") {
        let path = entry.expect("a source folder can be read").path();
        if path.is_dir() { gather(&path, sources) } else { sources.push(path) }
    }
}

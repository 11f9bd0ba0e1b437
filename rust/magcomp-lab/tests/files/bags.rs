//! Bags that are cut off or damaged.

use crate::bag::bag;
use crate::{folder, imported, refused};
use std::fs;

#[test]
fn a_cut_bag_gives_what_precedes_the_cut() {
    for compression in [None, Some(mcap::Compression::Zstd), Some(mcap::Compression::Lz4)] {
        let whole = bag(90, compression, 0);
        let folder = folder(&[("whole.mcap", &whole)]);
        let (expected, warnings) = imported(folder.path(), "whole.mcap", &[]);
        assert_eq!((expected.lines().count(), warnings.as_str()), (91, ""));
        let mut rows = Vec::new();
        for part in [2, 5, 9] {
            fs::write(folder.path().join("cut.mcap"), &whole[..whole.len() * part / 10]).unwrap();
            let (text, warnings) = imported(folder.path(), "cut.mcap", &[]);
            assert!(expected.starts_with(&text) && text.lines().count() > 1, "{text}");
            assert!(
                warnings.contains("cut.mcap: cannot be read: ") && warnings.contains("what is before that place"),
                "{warnings}"
            );
            rows.push(text.lines().count());
        }
        assert!(rows.is_sorted() && rows[0] < 40 && rows[2] > 40, "{rows:?}");
        // nothing before the cut
        fs::write(folder.path().join("cut.mcap"), &whole[..60]).unwrap();
        assert!(refused(folder.path(), "cut.mcap", &[]).contains("cut.mcap: cannot be read: "));
    }
}

#[test]
fn a_length_beyond_its_record_is_an_error_or_not_read() {
    let whole = bag(3, None, 0);
    let folder = folder(&[("b.mcap", &whole)]);
    let (expected, _) = imported(folder.path(), "b.mcap", &[]);
    // (opcode of the record, bytes before the length of a string in it, whether it is read at all)
    for (opcode, before, read) in [(1, 0, false), (3, 2, true), (4, 4, true), (6, 28, true), (8, 50, false)] {
        let mut bytes = whole.clone();
        let mut records = records(&whole);
        let at = records.find(|(found, _)| *found == opcode).unwrap().1 + before;
        bytes[at..at + 4].copy_from_slice(&(u32::MAX - 9).to_le_bytes());
        fs::write(folder.path().join("b.mcap"), bytes).unwrap();
        if read {
            let error = refused(folder.path(), "b.mcap", &[]);
            assert!(error.contains("b.mcap: cannot be read: "), "{error}");
        } else {
            assert_eq!(imported(folder.path(), "b.mcap", &[]).0, expected, "{opcode}");
        }
    }
}

/// Opcode of each record of a bag, in chunks too, and where its content begins.
fn records(bag: &[u8]) -> impl Iterator<Item = (u8, usize)> {
    let mut at = 8;
    std::iter::from_fn(move || {
        let opcode = *bag.get(at)?;
        let start = at + 9;
        let length = u64::from_le_bytes(bag.get(at + 1..start)?.try_into().unwrap()) as usize;
        // a chunk that is not packed: its records follow times, size, checksum, an empty name and a length
        at = if opcode == 6 { start + 40 } else { start + length };
        Some((opcode, start))
    })
}

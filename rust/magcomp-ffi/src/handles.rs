//! Numbers for compensators, so that JNI and Swift need no pointer.
//!
//! A handle is an index and a generation. The table holds weak references: it keeps nothing alive, a handle whose
//! object is gone finds nothing, and a number is never used twice. So there is no use after close and no double
//! release, whatever threads do.

use crate::compensator::Compensator;
use std::sync::{Arc, PoisonError, RwLock, Weak};

struct Slot {
    generation: u32,
    object: Weak<Compensator>,
}

/// Generations stay below, so that handles are positive.
const GENERATIONS: u32 = i32::MAX as u32;

static TABLE: RwLock<Vec<Slot>> = RwLock::new(Vec::new());

/// A handle for the object.
pub(crate) fn add(object: &Arc<Compensator>) -> i64 {
    let mut table = TABLE.write().unwrap_or_else(PoisonError::into_inner);
    let object = Arc::downgrade(object);
    let free = table.iter().position(|slot| slot.object.strong_count() == 0 && slot.generation < GENERATIONS);
    let index = match free {
        Some(index) => {
            let generation = table[index].generation + 1;
            table[index] = Slot { generation, object };
            index
        }
        None => {
            table.push(Slot { generation: 1, object });
            table.len() - 1
        }
    };
    i64::from(table[index].generation) << 32 | index as i64
}

/// The object of a handle, if it is still there.
pub(crate) fn find(handle: i64) -> Option<Arc<Compensator>> {
    let (generation, index) = ((handle >> 32) as u32, (handle & 0xffff_ffff) as usize);
    let table = TABLE.read().unwrap_or_else(PoisonError::into_inner);
    let slot = table.get(index).filter(|slot| slot.generation == generation)?;
    slot.object.upgrade()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::default_config;

    #[test]
    fn a_handle_of_a_dropped_object_finds_nothing_ever_again() {
        let first = Compensator::new(default_config()).unwrap();
        let handle = add(&first);
        assert!(Arc::ptr_eq(&find(handle).unwrap(), &first));
        drop(first);
        assert!(find(handle).is_none());
        let others: Vec<_> = (0..10).map(|_| Compensator::new(default_config()).unwrap()).collect();
        for other in &others {
            assert_ne!(add(other), handle);
        }
        assert!(find(handle).is_none());
    }

    #[test]
    fn invented_handles_find_nothing() {
        for handle in [0, -1, 1, i64::MAX, i64::MIN, 1 << 32 | 0xffff_ffff] {
            assert!(find(handle).is_none(), "{handle}");
        }
    }
}

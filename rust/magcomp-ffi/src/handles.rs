//! Numbers for objects, so that JNI and Swift need no pointer.
//!
//! A handle is an index and a generation. The table holds weak references: it keeps nothing alive, a handle whose
//! object is gone finds nothing, and a number is never used twice. So there is no use after close and no double
//! release, whatever threads do.

use std::sync::{Arc, PoisonError, RwLock, Weak};

struct Slot<T> {
    generation: u32,
    object: Weak<T>,
}

/// Generations stay below, so that handles are positive.
const GENERATIONS: u32 = i32::MAX as u32;

/// The table.
pub(crate) struct Handles<T>(RwLock<Vec<Slot<T>>>);

impl<T> Handles<T> {
    pub(crate) const fn new() -> Self {
        Self(RwLock::new(Vec::new()))
    }

    /// A handle for the object.
    pub(crate) fn add(&self, object: &Arc<T>) -> i64 {
        let mut table = self.0.write().unwrap_or_else(PoisonError::into_inner);
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
    pub(crate) fn find(&self, handle: i64) -> Option<Arc<T>> {
        let (generation, index) = ((handle >> 32) as u32, (handle & 0xffff_ffff) as usize);
        let table = self.0.read().unwrap_or_else(PoisonError::into_inner);
        let slot = table.get(index).filter(|slot| slot.generation == generation)?;
        slot.object.upgrade()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_handle_of_a_dropped_object_finds_nothing_ever_again() {
        let handles = Handles::new();
        let first = Arc::new(1);
        let handle = handles.add(&first);
        assert!(Arc::ptr_eq(&handles.find(handle).unwrap(), &first));
        drop(first);
        assert!(handles.find(handle).is_none());
        let others: Vec<_> = (0..10).map(Arc::new).collect();
        for other in &others {
            assert_ne!(handles.add(other), handle);
        }
        assert!(handles.find(handle).is_none());
    }

    #[test]
    fn invented_handles_find_nothing() {
        let handles = Handles::new();
        let object = Arc::new(1);
        handles.add(&object);
        for handle in [0, -1, 1, i64::MAX, i64::MIN, 1 << 32 | 0xffff_ffff] {
            assert!(handles.find(handle).is_none(), "{handle}");
        }
    }
}

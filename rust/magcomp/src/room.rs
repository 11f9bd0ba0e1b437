//! Memory that is taken once: a clone has as much room as what it was made from, so that it takes none later.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::ops::{Deref, DerefMut};

/// A queue with the room that it began with.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Roomy<T>(VecDeque<T>);

impl<T> Roomy<T> {
    pub fn new(room: usize) -> Self {
        Self(VecDeque::with_capacity(room))
    }
}

impl<T> Default for Roomy<T> {
    fn default() -> Self {
        Self::new(0)
    }
}

impl<T: Clone> Clone for Roomy<T> {
    fn clone(&self) -> Self {
        let mut clone = Self::new(self.capacity());
        clone.extend(self.iter().cloned());
        clone
    }
}

impl<T> Deref for Roomy<T> {
    type Target = VecDeque<T>;

    fn deref(&self) -> &VecDeque<T> {
        &self.0
    }
}

impl<T> DerefMut for Roomy<T> {
    fn deref_mut(&mut self) -> &mut VecDeque<T> {
        &mut self.0
    }
}

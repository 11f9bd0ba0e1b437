//! Memory that is taken once: a clone has as much room as what it was made from, so that it takes none later.
//! A `Vec` where it is read all the time: a ring in its place costs the adaptive estimator a tenth more instructions.

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::ops::{Deref, DerefMut};
use serde::{Deserialize, Serialize};

/// A collection with the room that it began with.
#[derive(Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Roomy<C>(C);

impl<T> Roomy<Vec<T>> {
    pub fn new(room: usize) -> Self {
        Self(Vec::with_capacity(room))
    }
}

impl<T> Roomy<VecDeque<T>> {
    pub fn new(room: usize) -> Self {
        Self(VecDeque::with_capacity(room))
    }

    /// The newest enters; of `most` the oldest leaves.
    pub fn roll(&mut self, newest: T, most: usize) {
        if self.len() == most {
            self.pop_front();
        }
        self.push_back(newest);
    }
}

impl<T: Clone> Clone for Roomy<Vec<T>> {
    fn clone(&self) -> Self {
        let mut clone = Self::new(self.capacity());
        clone.extend_from_slice(self);
        clone
    }
}

impl<T: Clone> Clone for Roomy<VecDeque<T>> {
    fn clone(&self) -> Self {
        let mut clone = Self::new(self.capacity());
        clone.extend(self.iter().cloned());
        clone
    }
}

impl<C> Deref for Roomy<C> {
    type Target = C;

    fn deref(&self) -> &C {
        &self.0
    }
}

impl<C> DerefMut for Roomy<C> {
    fn deref_mut(&mut self) -> &mut C {
        &mut self.0
    }
}

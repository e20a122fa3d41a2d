//! Predictions that a run keeps.

use super::hypothesis::Hypothesis;
use crate::film::Film;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Case, hypothesis and look of a prediction.
type Key = (String, Hypothesis, String);

/// A prediction, and the work that it took.
type Kept = (Film, u64);

/// Images that mistakes make of cases: several images of one case need the same ones.
#[derive(Debug, Default)]
pub struct Predictions(Mutex<HashMap<Key, Kept>>);

/// Largest number of predictions. One of a case of the suite has 20 to 500 kB.
const MOST_KEPT: usize = 1000;

impl Predictions {
    /// Number of predictions that are kept.
    pub fn count(&self) -> usize {
        self.kept().len()
    }

    /// The prediction with this key, if it was kept.
    pub(super) fn get(&self, key: &Key) -> Option<Kept> {
        self.kept().get(key).cloned()
    }

    /// Keeps a prediction, while there is room.
    pub(super) fn put(&self, key: Key, prediction: Kept) {
        let mut kept = self.kept();
        if kept.len() < MOST_KEPT {
            kept.insert(key, prediction);
        }
    }

    fn kept(&self) -> MutexGuard<'_, HashMap<Key, Kept>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

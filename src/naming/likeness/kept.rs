//! Predictions that a run keeps.
//!
//! The image that a mistake makes of a case depends neither on the image that is judged nor on whose it is: several
//! images of one case need the same predictions.

use crate::film::Film;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// Largest memory of the predictions, bytes. One of a case of the suite has 20 to 500 kB.
const MOST_BYTES: usize = 256 << 20;

/// Predictions, by what they depend on.
#[derive(Debug, Default)]
pub struct Predictions {
    kept: Mutex<Kept>,
}

#[derive(Debug, Default)]
struct Kept {
    films: HashMap<String, Film>,
    bytes: usize,
}

impl Predictions {
    /// Number of predictions that are kept.
    pub fn count(&self) -> usize {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.films.len()
    }

    /// The prediction with this key, if it was kept.
    pub(super) fn get(&self, key: &str) -> Option<Film> {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.films.get(key).cloned()
    }

    /// Keeps a prediction, while there is room.
    pub(super) fn put(&self, key: String, film: &Film) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        // Three channels and their variances.
        let bytes = film.width() * film.height() * 6 * size_of::<f32>();
        if kept.bytes + bytes <= MOST_BYTES && kept.films.insert(key, film.clone()).is_none() {
            kept.bytes += bytes;
        }
    }
}

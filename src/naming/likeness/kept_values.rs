//! Values that the file of an image can hold, by which predictions of it are rounded.

use crate::film::{Film, Quantisation};
use crate::variations::edited_film::mapped;

/// Values that a file can hold.
#[derive(Clone, Copy)]
pub(super) enum KeptValues {
    /// All.
    All,
    /// None above this.
    UpTo(f64),
    /// Codes. A right prediction has the same, but for a few that lie between two.
    Codes(Quantisation),
}

impl KeptValues {
    /// Values that the file of `test` can hold. Means of few samples are not predicted to a code.
    pub fn by(test: &Film, is_sampled: bool) -> KeptValues {
        match test.quantisation() {
            None => KeptValues::All,
            Some(quantisation) if is_sampled => KeptValues::UpTo(quantisation.largest()),
            Some(quantisation) => KeptValues::Codes(quantisation),
        }
    }

    /// `film` as such a file keeps it.
    pub fn film(self, film: &Film) -> Film {
        match self {
            KeptValues::All => film.clone(),
            KeptValues::UpTo(ceiling) => mapped(film, |value, _| (value.min(ceiling), 1.0)),
            KeptValues::Codes(quantisation) => quantisation.rounded(film),
        }
    }
}

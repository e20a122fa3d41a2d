//! From a failing image to the likely mistake, convention or number.

pub(crate) mod convention_search;
pub(crate) mod likeness;
pub(crate) mod rate;
mod shipped_profile;

pub use convention_search::{Agreement, ConventionSearch, Explained, Unfinished};
pub use likeness::{Likenesses, Predictions, Search, SearchStep, Stage, likeness};
pub(crate) use likeness::{NOTHING_STANDS_OUT, is_number_found};
pub use rate::{Naming, naming};

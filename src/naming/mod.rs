//! From a failing image to the likely mistake, convention or number.

pub(crate) mod convention_search;
pub(crate) mod likeness;
pub(crate) mod rate;
mod shipped_profile;

pub use convention_search::{Agreement, ConventionSearch, Explained, Unfinished};
pub(crate) use likeness::{CACHE_VARIABLE, NOTHING_STANDS_OUT, cache_of_the_user, is_number_found};
pub use likeness::{Likenesses, Predictions, Search, SearchStep, Stage, likeness};
pub use rate::{Naming, naming};

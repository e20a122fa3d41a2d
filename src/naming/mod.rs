//! From a failing image to the likely mistake, convention or number.

pub(crate) mod convention_search;
pub(crate) mod likeness;
pub(crate) mod rate;
mod shipped_profile;

pub use convention_search::{Agreement, ConventionSearch, Explained, Unfinished};
pub use likeness::{
    CACHE_VARIABLE, Likenesses, NOTHING_STANDS_OUT, Predictions, Search, SearchStep, Stage,
    cache_of_the_user, is_number_found, likeness,
};
pub use rate::{Naming, naming};

//! From a failing image to the likely mistake, convention or number.

pub(crate) mod convention_search;
pub(crate) mod likeness;
pub(crate) mod rate;
mod shipped_profile;

pub use convention_search::{Agreement, ConventionSearch, Explained};
pub use likeness::{
    AGREES, CACHE_VARIABLE, Likenesses, Predictions, Search, SearchStep, Stage, cache_of_the_user,
    likeness,
};
pub use rate::{Naming, naming};

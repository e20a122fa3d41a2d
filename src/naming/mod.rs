//! From a failing image to the likely mistake, convention or parameter, with the verdict that follows.

pub(crate) mod convention_search;
pub(crate) mod likeness;
mod shipped_profile;

pub use convention_search::{ConventionSearch, Explained};
pub(crate) use likeness::NOTHING_KNOWN;
pub use likeness::{Likenesses, Predictions, Search, SearchStep, Stage, likeness};

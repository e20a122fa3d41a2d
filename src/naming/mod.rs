//! From a failing image to the likely mistake, convention or parameter, with the verdict that follows.

pub(crate) mod convention_search;
pub(crate) mod diagnosis;
mod shipped_profile;

pub use convention_search::{ConventionSearch, Explained};
pub(crate) use diagnosis::NOTHING_KNOWN;
pub use diagnosis::{Diagnosis, Predictions, Search, SearchStep, Stage, diagnosis};

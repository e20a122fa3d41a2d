//! Long work in parts: new goldens, results of the parts of a run.

pub(crate) mod accept;
pub(crate) mod kept_results;

pub use accept::{AcceptError, Accepted, Change, Request as AcceptRequest, accept};
pub use kept_results::{KeptResult, Part, ResultFolder, Run};

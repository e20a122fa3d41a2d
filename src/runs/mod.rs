//! Long work in parts: work units, new goldens made from them, results of parts.

pub(crate) mod accept;
pub(crate) mod kept_results;
pub(crate) mod units;

pub(crate) use accept::StepsOfWork;
pub use accept::{AcceptError, AcceptWatch, Accepted, Change, Request as AcceptRequest, accept};
pub use kept_results::{KeptResult, RESULTS, ResultFolder, Run};
pub use units::{AddError, Added, Unit, UnitFile, UnitFolder};
pub(crate) use units::{CaseUnits, UnitError};

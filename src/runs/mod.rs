//! Long work in parts: work units, new goldens made from them, results of parts.

pub(crate) mod accept;
pub(crate) mod kept_results;
pub(crate) mod units;

pub use accept::{
    AcceptError, AcceptWatch, Accepted, Change, Request as AcceptRequest, StepsOfWork, accept,
};
pub use kept_results::{KeptResult, RESULTS, ResultFolder, Run};
pub use units::{AddError, Added, CaseUnits, Unit, UnitError, UnitFile, UnitFolder};

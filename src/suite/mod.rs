//! Cases, their goldens, and what `verify` and `accept` do with them.

mod accept;
mod case;
mod golden;
mod results;
mod store;
mod verify;

pub use accept::{AcceptError, Accepted, Change, accept};
pub use case::{Case, MANIFEST, Suite, SuiteError};
pub use golden::{Golden, GoldenError, LIBM_VERSION, Provenance};
pub use results::{CaseResult, Cause, Summary, Verdict};
pub use store::{Disk, Failure, RealDisk, Store, StoreError};
pub use verify::{verify, without_case};

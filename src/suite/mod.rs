//! Cases, their goldens, and what `verify` and `accept` do with them.

mod accept;
mod cache;
mod case;
mod evidence;
mod golden;
mod outputs;
mod rendering;
mod results;
#[cfg(test)]
mod sampled_tests;
mod store;
mod verify;

pub use accept::{AcceptError, Accepted, Change, Watch, accept};
pub use cache::Cache;
pub use case::{Case, MANIFEST, Sampling, Suite, SuiteError};
pub use evidence::{Evidence, Likeness};
pub use golden::{Golden, GoldenError, LIBM_VERSION, Provenance, Quick};
pub use outputs::{Found, OutputError, Outputs, Stranger};
pub use results::{CaseResult, Cause, Summary, Verdict};
pub use store::{Disk, Failure, RealDisk, Store, StoreError};
pub use verify::{verify, without_case};

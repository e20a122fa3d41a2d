//! Verdicts on cases: `verify`, `validate` and the self-test; new goldens, and results of parts of a run.

mod accept;
pub(crate) mod decide;
mod depth;
pub(crate) mod evidence;
pub(crate) mod finding;
mod judged_with;
mod kept_results;
pub(crate) mod known;
pub(crate) mod known_failure;
mod known_file;
mod known_rewriting;
pub(crate) mod measured;
pub(crate) mod more_samples;
pub(crate) mod nothing_drawn;
pub(crate) mod precision;
pub(crate) mod random_samples;
mod refinement;
pub(crate) mod results;
pub(crate) mod self_test;
pub(crate) mod truth;
pub(crate) mod validate;
pub(crate) mod verify;

pub use accept::{AcceptError, Accepted, Change, Request as AcceptRequest, accept};
pub use decide::{Looks, share_of_look};
pub use evidence::{Evidence, LikelyMistake};
pub use finding::Judged;
pub(crate) use judged_with::JudgedWith;
pub use kept_results::{KeptResult, Part, ResultFolder, Run};
pub use known::{Known, KnownStatus};
pub(crate) use known_failure::OF_PROFILE;
pub(crate) use known_file::KnownFailures;
pub(crate) use more_samples::MoreSamples;
pub use more_samples::is_open;
pub(crate) use precision::before_background;
pub use precision::{declared, radiance};
pub(crate) use random_samples::within;
pub use results::{CaseResult, Cause, Verdict, metric_meaning};
pub(crate) use self_test::{
    CaseTrials, MistakeTrials, SelfTest, SelfTestCases, Step, Trial, case_trials, self_test_steps,
};
pub use validate::validate;
pub(crate) use validate::validate_at;
pub use verify::verify;
pub(crate) use verify::without_case;

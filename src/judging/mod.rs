//! Verdicts on cases: `verify`, `validate` and the self-test.

pub(crate) mod decide;
mod depth;
pub(crate) mod evidence;
pub(crate) mod finding;
pub(crate) mod measured;
pub(crate) mod more_samples;
pub(crate) mod precision;
pub(crate) mod random_samples;
mod refinement;
pub(crate) mod results;
pub(crate) mod rows;
pub(crate) mod self_test;
pub(crate) mod truth;
pub(crate) mod validate;
pub(crate) mod verify;

pub use decide::{Looks, share_of_look};
pub use evidence::{Evidence, Likeness};
pub use finding::{CaseFinding, Judged};
pub use more_samples::{MoreSamples, is_open};
pub use precision::{before_background, declared, radiance};
pub use results::{CaseResult, Cause, Summary, Verdict, metric_meaning};
pub use rows::verify_row;
pub use self_test::{
    BenignTrials, CaseTrials, MistakeTrials, Rejection, SelfTest, SelfTestCases, SelfTestExtent,
    Step, Trial, case_trials, self_test, self_test_steps,
};
pub use validate::{add_right_declaration, validate, validate_at};
pub use verify::{verify, without_case};

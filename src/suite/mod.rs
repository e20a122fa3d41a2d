//! Cases and goldens, and their use by `verify`, `validate` and `accept`.

mod accept;
mod analytic;
mod answer;
mod case;
mod check;
mod convention_search;
mod decide;
mod edited_film;
mod embedded;
mod evidence;
mod finding;
mod golden;
mod kept_file;
mod kept_film;
mod kept_results;
mod likeness;
mod measured;
pub mod mistakes;
mod name_hash;
mod naming;
mod other_renderer;
mod outputs;
mod program_hash;
mod refinement;
mod rendering;
mod results;
mod row_name;
mod rows;
mod self_test;
mod sensitivities;
mod store;
mod suite_hash;
mod truth;
mod units;
mod validate;
mod verify;

pub use accept::{
    AcceptError, AcceptWatch, Accepted, Change, Request as AcceptRequest, StepsOfWork, accept,
};
pub use analytic::{ANALYTIC, Analytic, ERROR_OF_TOLERANCE};
pub use answer::Answer;
pub use case::{
    Case, CaseSampling, ConvergedSampling, MANIFEST, MEAN_RESOLUTION, Suite, SuiteError,
};
pub use check::{SUITE_VARIABLE, check, check_within};
pub use convention_search::{Agreement, ConventionSearch, Explained};
pub use decide::{Looks, share_of_look};
pub use embedded::EmbeddedSuite;
pub use evidence::{Evidence, Likeness};
pub use finding::{CaseFinding, Judged};
pub use golden::{Golden, GoldenError, LIBM_VERSION, Provenance, Quick};
pub use kept_file::KeepError;
pub use kept_results::{KeptResult, RESULTS, ResultFolder, Run};
pub use likeness::{
    CACHE_VARIABLE, Likenesses, Predictions, Search, SearchStep, Stage, cache_of_the_user, likeness,
};
pub use name_hash::name_hash;
pub use naming::{Naming, naming};
pub use other_renderer::{CommandTemplate, Keeper, Kept, Ran, TemplateError, keep, run, stop_all};
pub use outputs::{Found, OutputError, Outputs, UnknownFile, step_name};
pub use program_hash::program_hash;
pub use results::{CaseResult, Cause, Summary, Verdict, metric_meaning};
pub use row_name::{HARD, row_name};
pub use rows::verify_row;
pub use self_test::{
    BenignTrials, CaseTrials, MistakeTrials, Rejection, SelfTest, SelfTestCases, SelfTestExtent,
    Step, Trial, case_trials, self_test, self_test_steps,
};
pub use sensitivities::{sensitivities_of, telling_case};
pub use store::{Disk, RealDisk, Store, StoreError, StoreFailure};
pub use units::{AddError, Added, CaseUnits, Unit, UnitError, UnitFile, UnitFolder};
pub use validate::{Output, validate, validate_at};
pub use verify::{verify, without_case};

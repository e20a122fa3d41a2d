//! Cases and goldens: their files, and how each is rendered.

pub(crate) mod answer;
pub(crate) mod case;
pub(crate) mod embedded;
pub(crate) mod families;
pub(crate) mod golden;
pub(crate) mod name_hash;
pub(crate) mod outline;
pub(crate) mod outputs;
pub(crate) mod rendering;
pub(crate) mod sensitivities;
pub(crate) mod store;
pub(crate) mod suite_hash;

pub use answer::Answer;
pub(crate) use answer::{ERROR_OF_TOLERANCE, OF_TOLERANCE};
pub(crate) use case::CACHE;
pub use case::{
    Case, CaseSampling, ConvergedSampling, MANIFEST, MEAN_RESOLUTION, Suite, SuiteError,
};
pub(crate) use embedded::EmbeddedSuite;
pub use families::Family;
pub use golden::{Golden, GoldenError, LIBM_VERSION, Provenance, Quick};
pub(crate) use name_hash::name_hash;
pub(crate) use outline::CORE;
pub use outputs::{Found, Output, OutputError, Outputs, UnknownFile, image_path};
pub(crate) use outputs::{NOT_RENDERED, entries, refusal, step_name};
pub(crate) use sensitivities::sensitivities_of;
pub use store::{Store, StoreError};

/// Environment variable for the folder of a suite other than volref's own.
pub const SUITE_VARIABLE: &str = "VOLREF_SUITE";

//! Settings of proptest for tests beside the code.

use proptest::prelude::ProptestConfig;
use proptest::test_runner::FileFailurePersistence;

/// Proptest's settings, with failures kept in `file`: a path from the package's root, inside
/// `fixtures/proptest-regressions/`, where the default would open a folder of its own.
pub(crate) fn failures_in(file: &'static str) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(file))),
        ..ProptestConfig::default()
    }
}

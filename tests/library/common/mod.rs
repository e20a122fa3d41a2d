//! Helpers that several subjects share.

pub mod entries;
pub mod quadrature;
pub mod simulated;
pub mod test_ray;
pub mod watch;

use proptest::prelude::ProptestConfig;
use proptest::test_runner::FileFailurePersistence;

/// Proptest's settings, with failures kept in `file`: a path from the package's root, inside
/// `fixtures/proptest-regressions/`, where the default would open a folder of its own.
pub fn failures_in(file: &'static str) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(file))),
        ..ProptestConfig::default()
    }
}

//! Helpers that several subjects share.

pub mod entries;
pub mod estimators;
pub mod quadrature;
pub mod simulated;
pub mod suite;
pub mod test_ray;
pub mod watch;

use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;

/// Proptest's settings, with failures kept in `file`: a path from the package's root, inside
/// `fixtures/proptest-regressions/`, where the default would open a folder of its own.
pub fn failures_in(file: &'static str) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(file))),
        ..ProptestConfig::default()
    }
}

/// Three coordinates.
pub fn vector(coordinate: impl Strategy<Value = f64>) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(coordinate).prop_map(DVec3::from_array)
}

/// Directions as renderers meet them: any, along an axis or a plane of axes with zeros of either
/// sign, nearly so, with denormal components.
pub fn direction() -> impl Strategy<Value = DVec3> {
    let component = prop_oneof![
        4 => -1.0..1.0,
        1 => Just(0.0),
        1 => Just(-0.0),
        1 => prop_oneof![Just(1e-17), Just(-1e-9), Just(5e-324), Just(-1e-310)],
    ];
    vector(component).prop_filter("a direction", |v| v.abs().max_element() > 0.1)
}

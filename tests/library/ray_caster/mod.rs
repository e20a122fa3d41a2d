//! Laws of the classified ray caster, each over random scenes and through the code that renders
//! them.

pub mod scenes;

mod empty_space;
mod extremes;
mod known_answers;
mod light;
mod opacity;
mod order;
mod plan;
mod points;
mod scale;
mod shadow;

use crate::common;
use proptest::prelude::ProptestConfig;

/// Half a unit in the last place of 1: the largest relative error of one rounding.
const U: f64 = f64::EPSILON / 2.0;

/// Proptest's settings for laws that render: fewer cases than the default 256.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        ..common::failures_in("fixtures/proptest-regressions/ray_caster.txt")
    }
}

//! Laws over the ground of the catalogue of hard cases, each on a thousand random cases: boxes,
//! spheres, grids and whole rays. Names begin with the rows that they generalise.

mod boxes;
mod grids;
mod rays;
mod spheres;

use crate::common::{self, direction, vector};
use crate::exact;
use crate::ray_caster::scenes;
use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use volref::geometry::Span;

/// The same thousand cases in every run. `PROPTEST_RNG_SEED` gives others, `PROPTEST_CASES` more:
/// `scripts/nightly.sh` tries a hundred thousand.
fn config() -> ProptestConfig {
    let usual = common::failures_in("fixtures/proptest-regressions/hard_laws.txt");
    ProptestConfig {
        cases: usual.cases.max(1_000),
        max_global_rejects: 100_000,
        rng_seed: match usual.rng_seed {
            RngSeed::Random => RngSeed::Fixed(1),
            fixed => fixed,
        },
        ..usual
    }
}

/// From `2^low` to `2^high`, each octave as likely as the next.
fn octaves(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high).prop_map(volref::math::exp2)
}

/// Powers of two by which lengths are scaled.
fn scale() -> impl Strategy<Value = f64> {
    (-200..=200_i32).prop_map(scenes::power_of_two)
}

/// A multiple of 1/256 between −4 and 4.
fn dyadic() -> impl Strategy<Value = f64> {
    (-1024..=1024_i32).prop_map(|n| f64::from(n) / 256.0)
}

/// An offset so large that multiples of 1/256 near it are still exact: 2^40 and 10 bits.
fn offset() -> impl Strategy<Value = DVec3> {
    let power = (0..=40_i32, any::<bool>()).prop_map(|(exponent, negative)| {
        scenes::power_of_two(exponent) * if negative { -1.0 } else { 1.0 }
    });
    vector(power)
}

/// Whether no component is so close to 0 that products with it, scaled down, would leave the normal
/// numbers: there scaling by a power of two moves digits.
fn scales_exactly(v: DVec3) -> bool {
    v.to_array().iter().all(|&x| x == 0.0 || x.abs() > 1e-40)
}

/// What scaling every length by `factor` makes of a span.
fn scaled(span: Option<Span>, factor: f64) -> Option<Span> {
    span.map(|Span { near, far }| Span::new(near * factor, far * factor))
}

/// The axes of a vector in another order.
fn permuted(v: DVec3, order: [usize; 3]) -> DVec3 {
    DVec3::from_array(order.map(|axis| v[axis]))
}

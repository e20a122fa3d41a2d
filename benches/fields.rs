//! What a look-up in a density field costs, and what bounds over a box cost.
//!
//! `cargo bench --bench fields`. Read ratios between rows of one run: machines differ.

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::DVec3;
use volref::geometry::Aabb;
use volref::math::rng::Stream;
use volref::volume::{DensityField, FractalDensity, FractalParameters, perlin_noise};

fn main() {
    divan::main();
}

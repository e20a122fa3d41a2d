//! Noise that a test image does not state, beside a reference that has none.
//!
//! A right image without noise differs from such a reference by no more than the deterministic gate allows. What
//! differs by more is wrong, unless the difference is noise: then it fills the blocks in which it is, and neighbours have
//! nothing of it in common. Displaced edges and single wrong pixels fill no block, and a bias is common to neighbours.

use super::super::deterministic::tolerance;
use super::blocks::Block;
use super::comparison::Comparison;
use super::neighbours::correlations;
use super::{FALSE_ALARM, SHARES};
use crate::film::Film;

/// Share of the tolerance beyond which a pixel counts as off from the median difference of its block. Noise of which one
/// pixel in 5000 exceeds the tolerance, as the deterministic gate allows, has a standard deviation of a quarter of it
/// (3.7 standard deviations), and two thirds of its pixels are beyond this.
const OFF: f64 = 0.1;

/// Correlation of neighbours from which a difference is not noise: half-way between that of noise, 0, and that of a
/// difference that varies slowly, 1.
const IN_COMMON: f64 = 0.5;

/// True if `test` differs from `reference`, an image of the same size without noise, by noise.
pub(crate) fn is_off_by_noise(reference: &Film, test: &Film) -> bool {
    let known = reference.clone().known();
    let comparison = Comparison::new(&known, test, FALSE_ALARM / SHARES);
    let blocks = comparison.blocks.iter();
    let filled: Vec<bool> = blocks
        .filter_map(|block| is_filled(reference, test, block))
        .collect();
    let most = 2 * filled.iter().filter(|is| **is).count() > filled.len();
    most && correlations(&comparison)
        .into_iter()
        .all(|correlation| correlation < IN_COMMON)
}

/// True if most pixels of `block` are off, of the channel with most; `None` if none is beyond the tolerance.
fn is_filled(reference: &Film, test: &Film, block: &Block) -> Option<bool> {
    let (mut is_beyond, mut most) = (false, 0);
    for c in 0..3 {
        let of = |film: &Film, index: usize| f64::from(film.radiance()[index][c]);
        let difference = |index: usize| of(test, index) - of(reference, index);
        let indices = || block.indices(reference.width());
        let mut differences: Vec<f64> = indices().map(difference).collect();
        differences.sort_by(f64::total_cmp);
        let median = differences[differences.len() / 2];
        let in_tolerances = |index: usize, from: f64| {
            (difference(index) - from).abs() / tolerance(of(reference, index))
        };
        is_beyond |= indices().any(|index| in_tolerances(index, 0.0) > 1.0);
        most = most.max(
            indices()
                .filter(|&index| in_tolerances(index, median) > OFF)
                .count(),
        );
    }
    is_beyond.then_some(2 * most > block.pixels())
}

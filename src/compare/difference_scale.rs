//! The unit of the difference of two images in a report.

use super::gate::Gate;
use super::{deterministic, stochastic};
use crate::film::Film;

/// Unit of the difference of two images.
#[derive(Clone, Debug, PartialEq)]
pub enum DifferenceScale {
    /// Radiance.
    Radiance,
    /// The tolerance of a channel, which is `absolute + relative · |golden|`.
    Tolerance {
        /// Radiance.
        absolute: f64,
        /// Fraction of the golden.
        relative: f64,
    },
    /// Standard errors of the mean of a block of pixels.
    StandardErrors(BlockMap),
}

impl DifferenceScale {
    /// The unit in which `gate` shows the difference of two images of one size.
    pub(crate) fn of(gate: Gate, golden: &Film, test: &Film) -> DifferenceScale {
        match gate {
            Gate::Deterministic | Gate::Refinement => DifferenceScale::Tolerance {
                absolute: deterministic::ABSOLUTE,
                relative: deterministic::RELATIVE,
            },
            Gate::Stochastic => stochastic::block_map(golden, test)
                .map_or(DifferenceScale::Radiance, DifferenceScale::StandardErrors),
            Gate::Exact | Gate::Perceptual => DifferenceScale::Radiance,
        }
    }
}

/// Deviations of blocks of 8 × 8 pixels, for a map.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockMap {
    /// Blocks in a row.
    pub columns: usize,
    /// Rows of blocks.
    pub rows: usize,
    /// Test minus reference in standard errors, by channel; row by row from the top. Incomplete
    /// blocks at the right and lower edges are part of the last blocks. At most 1e9 in magnitude.
    pub deviations: Vec<[f64; 3]>,
}

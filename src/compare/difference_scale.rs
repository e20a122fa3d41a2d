//! The unit of the difference of two images in a report.

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

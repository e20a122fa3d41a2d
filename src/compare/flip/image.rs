//! The input: an 8-bit sRGB image.

use crate::film::{Bits, Film};
use thiserror::Error;

/// Reason why two images could not be compared.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum FlipError {
    /// The image has no pixels.
    #[error("an image of {width}×{height} has no pixels")]
    Empty {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The pixels do not fill the image.
    #[error("{pixels} pixels given for an image of {width}×{height}")]
    PixelCount {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Pixels given.
        pixels: usize,
    },
    /// The images differ in size.
    #[error("the reference is {reference:?} pixels wide and high, the test image {test:?}")]
    Size {
        /// Columns and rows of the reference.
        reference: (usize, usize),
        /// Columns and rows of the test image.
        test: (usize, usize),
    },
    /// The viewing condition is outside [`PIXELS_PER_DEGREE_RANGE`](super::PIXELS_PER_DEGREE_RANGE).
    #[error("{0} pixels per degree is outside 1 to 10000")]
    PixelsPerDegree(f64),
}

/// An sRGB image as displays and PNG files hold it: 8-bit codes with the sRGB transfer curve
/// (IEC 61966-2-1), row-major, top row first. At least one pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SrgbImage {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

impl SrgbImage {
    /// The radiance of codes of these bits at `exposure` stops.
    pub(crate) fn radiance(&self, bits: Bits, exposure: f64) -> Film {
        bits.of_png(exposure)
            .decoded(self.width, self.height, &self.pixels)
    }

    /// An image of `width` columns and `height` rows.
    ///
    /// # Errors
    ///
    /// If either is zero, or the length of `pixels` is not their product.
    pub fn new(width: usize, height: usize, pixels: Vec<[u8; 3]>) -> Result<Self, FlipError> {
        if width == 0 || height == 0 {
            return Err(FlipError::Empty { width, height });
        }
        if width.checked_mul(height) != Some(pixels.len()) {
            return Err(FlipError::PixelCount {
                width,
                height,
                pixels: pixels.len(),
            });
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Red, green and blue codes, row-major, top row first.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// An error unless `test` has the size of `self`, the reference.
    pub(super) fn require_same_size(&self, test: &Self) -> Result<(), FlipError> {
        let (reference, test) = ((self.width, self.height), (test.width, test.height));
        if reference == test {
            Ok(())
        } else {
            Err(FlipError::Size { reference, test })
        }
    }
}

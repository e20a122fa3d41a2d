//! The input: an 8-bit sRGB image.

use crate::film::{Bits, Film};
use thiserror::Error;

/// Reason why two images could not be compared.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{0}")]
pub struct FlipError(pub(super) String);

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
        let count = pixels.len();
        if count == 0 || width.checked_mul(height) != Some(count) {
            let fault = format!("{count} pixels given for an image of {width}×{height}");
            return Err(FlipError(fault));
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

    /// A PNG image of the codes.
    pub(crate) fn to_png(&self) -> Vec<u8> {
        Film::codes_to_png(&self.pixels, self.width, self.height)
    }
}

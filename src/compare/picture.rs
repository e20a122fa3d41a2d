//! The two kinds of images that can be compared.

use super::flip::SrgbImage;
use super::gate::Gate;
use crate::files::regular_file;
use crate::film::{Bits, Film, FilmError, FilmFormat};
use std::fmt::Display;
use std::path::Path;
use thiserror::Error;

/// An image to compare: linear radiance, or 8-bit codes for a display.
#[derive(Clone, Debug, PartialEq)]
pub enum Picture {
    /// Linear radiance, from EXR, PFM or NPY.
    Radiance(Film),
    /// sRGB codes, from PNG.
    Codes(SrgbImage),
}

/// Reason why an image cannot be compared.
#[derive(Debug, Error)]
pub enum PictureError {
    /// The file cannot be read, or contains no usable image.
    #[error("{path}: {reason}")]
    File {
        /// The file.
        path: String,
        /// Its fault.
        reason: String,
    },
    /// The image has no pixels.
    #[error("an image of {0} × {1} has no pixels")]
    Empty(usize, usize),
    /// An 8-bit image under a gate for radiance, by the name of the gate.
    #[error(
        "the {0} gate compares linear images (.exr, .pfm, .npy); compare an 8-bit image by \
         the perceptual gate, or state --bits"
    )]
    NeedsRadiance(&'static str),
    /// Two images without noise under the gate for noise.
    #[error(
        "the stochastic gate needs the noise of at least one image: an .exr with the layers \
         `variance` and `samples`, which volref writes when rendering with 2 or more samples per \
         pixel"
    )]
    NeedsNoise,
}

impl PictureError {
    /// The fault of the file at `path`.
    pub(crate) fn of(path: &Path, fault: impl Display) -> PictureError {
        PictureError::File {
            path: path.display().to_string(),
            reason: fault.to_string(),
        }
    }
}

impl Picture {
    /// Reads an image file: `.exr`, `.pfm` and `.npy` as radiance, `.png` as codes.
    pub fn read(path: &Path) -> Result<Picture, PictureError> {
        let in_film = |error| PictureError::of(path, error);
        let format = FilmFormat::known(path).map_err(in_film)?;
        let bytes = Picture::bytes(path)?;
        Picture::decode(format, &bytes).map_err(in_film)
    }

    /// All bytes of the image file at `path`.
    pub fn bytes(path: &Path) -> Result<Vec<u8>, PictureError> {
        let bytes = regular_file::read(path, regular_file::MOST_BYTES);
        bytes.map_err(|error| PictureError::of(path, format!("cannot be read: {error}")))
    }

    fn decode(format: FilmFormat, bytes: &[u8]) -> Result<Picture, FilmError> {
        format.check(bytes)?;
        match format {
            FilmFormat::Exr => Film::from_exr(bytes).map(Picture::Radiance),
            FilmFormat::Pfm => Film::from_pfm(bytes).map(Picture::Radiance),
            FilmFormat::Npy => Film::from_npy(bytes).map(Picture::Radiance),
            FilmFormat::Png => {
                let (width, height, codes) = Film::codes_from_png(bytes)?;
                let image = SrgbImage::new(width, height, codes);
                Ok(Picture::Codes(
                    image.expect("pixels of a size that was checked"),
                ))
            }
        }
    }

    /// Linear radiance; `None` for 8-bit codes.
    pub fn radiance(&self) -> Option<&Film> {
        match self {
            Picture::Radiance(film) => Some(film),
            Picture::Codes(_) => None,
        }
    }

    /// Linear radiance; that for which 8-bit codes stand at `exposure` stops.
    pub fn film(&self, exposure: f64) -> Film {
        match self {
            Picture::Radiance(film) => film.clone(),
            Picture::Codes(codes) => codes.radiance(Bits::UNKNOWN, exposure),
        }
    }

    /// Linear radiance, which `gate` needs.
    pub(super) fn radiance_for(&self, gate: Gate) -> Result<&Film, PictureError> {
        let needs = || PictureError::NeedsRadiance(gate.name());
        self.radiance().ok_or_else(needs)
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        match self {
            Picture::Radiance(film) => (film.width(), film.height()),
            Picture::Codes(image) => (image.width(), image.height()),
        }
    }

    /// The displayed image; radiance at `exposure` stops.
    pub fn srgb(&self, exposure: f64) -> Result<SrgbImage, PictureError> {
        match self {
            Picture::Codes(image) => Ok(image.clone()),
            Picture::Radiance(film) => {
                let (width, height) = (film.width(), film.height());
                SrgbImage::new(width, height, film.srgb_codes(exposure))
                    .map_err(|_| PictureError::Empty(width, height))
            }
        }
    }
}

//! Either kind of image that can be compared.

use super::Gate;
use super::flip::SrgbImage;
use crate::film::{Film, FilmError};
use std::path::Path;
use thiserror::Error;

/// An image to compare: linear radiance, or 8-bit codes for a display.
#[derive(Clone, Debug, PartialEq)]
pub enum Picture {
    /// Linear radiance, from EXR.
    Radiance(Film),
    /// sRGB codes, from PNG.
    Codes(SrgbImage),
}

/// Why an image cannot be compared.
#[derive(Debug, Error)]
pub enum PictureError {
    /// The file cannot be read.
    #[error("{path}: cannot be read: {error}")]
    Read {
        /// The file.
        path: String,
        /// What went wrong.
        error: std::io::Error,
    },
    /// The file holds no image that can be used.
    #[error("{path}: {error}")]
    Film {
        /// The file.
        path: String,
        /// What is wrong with it.
        error: FilmError,
    },
    /// The image has no pixels.
    #[error("an image of {0} × {1} has no pixels")]
    Empty(usize, usize),
    /// An 8-bit image under a gate for radiance.
    #[error(
        "the {0} gate judges linear radiance (.exr); 8-bit images can only be judged by the \
         perceptual gate"
    )]
    NeedsRadiance(Gate),
    /// Two images without noise under the gate for noise.
    #[error(
        "the stochastic gate needs the noise of at least one image: an .exr with the layers \
         variance (of the mean; R, G, B) and samples (per pixel), as volref renders of 2 samples \
         or more have them"
    )]
    NeedsNoise,
}

impl Picture {
    /// Reads an image file, `.exr` or `.png`.
    pub fn read(path: &Path) -> Result<Picture, PictureError> {
        let name = path.display().to_string();
        let in_film = |error| PictureError::Film {
            path: name.clone(),
            error,
        };
        let extension = path
            .extension()
            .and_then(|extension| extension.to_str())
            .unwrap_or("");
        let is_exr = match extension.to_ascii_lowercase().as_str() {
            "exr" => true,
            "png" => false,
            _ => return Err(in_film(FilmError::Format)),
        };
        let bytes = std::fs::read(path).map_err(|error| PictureError::Read {
            path: name.clone(),
            error,
        })?;
        if is_exr {
            return Film::from_exr(&bytes)
                .map(Picture::Radiance)
                .map_err(in_film);
        }
        let (width, height, codes) = Film::codes_from_png(&bytes).map_err(in_film)?;
        let image = SrgbImage::new(width, height, codes);
        image
            .map(Picture::Codes)
            .map_err(|_| PictureError::Empty(width, height))
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        match self {
            Picture::Radiance(film) => (film.width(), film.height()),
            Picture::Codes(image) => (image.width(), image.height()),
        }
    }

    /// As a display shows it; radiance at `exposure` stops.
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

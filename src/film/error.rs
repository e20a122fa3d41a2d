//! Errors in reading images.

use super::Film;
use crate::files::decoder::Stopped;
use thiserror::Error;

/// Reason why bytes are not a usable image.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum FilmError {
    /// Not a readable image of the format.
    #[error("not a readable {format} image: {reason}")]
    Unreadable {
        /// `EXR`, `PFM`, `NPY` or `PNG`.
        format: &'static str,
        /// Error of the reader.
        reason: String,
    },
    /// A kind of image whose colours would have to be guessed.
    #[error("{what}; {remedy}")]
    Unsuited {
        /// Contents of the file.
        what: String,
        /// Remedy.
        remedy: &'static str,
    },
    /// The contents are not what the extension says.
    #[error(
        "named .{extension}, but it begins like {really}: give it the right extension, or write \
        one of the supported formats (.exr, .pfm, .npy, .png)"
    )]
    Disguised {
        /// Extension of the file.
        extension: &'static str,
        /// Format by the first bytes, with an article.
        really: &'static str,
    },
    /// More pixels than the file can hold.
    #[error(
        "the image claims {claimed} bytes of pixels, which a file of {bytes} bytes cannot hold"
    )]
    Bomb {
        /// Bytes of all pixels, uncompressed.
        claimed: u64,
        /// Bytes of the file.
        bytes: usize,
    },
    /// Larger than any image of the suite.
    #[error(
        "the image claims {width} × {height} pixels; at most {} are read",
        Film::MOST_PIXELS
    )]
    TooLarge {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// No pixels.
    #[error("an image of {width} × {height} has no pixels")]
    Empty {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Variances that cannot be used.
    #[error("the noise of the image cannot be read: {0}")]
    Noise(&'static str),
    /// Depths that cannot be used.
    #[error("the depth of the image cannot be read: {0}")]
    Depth(&'static str),
    /// Replicates that are not independent renderings of one image.
    #[error("not independent renderings of one image: {0}")]
    Replicates(String),
    /// An unknown file extension, and the remedy.
    #[error(
        "unknown image extension: supported are .exr, .pfm and .npy (linear radiance) and .png \
         (8-bit sRGB); {0}"
    )]
    Format(&'static str),
}

impl FilmError {
    pub(super) fn unreadable(format: &'static str, reason: impl Into<String>) -> FilmError {
        let reason = reason.into();
        FilmError::Unreadable { format, reason }
    }

    pub(super) fn unsuited(what: impl Into<String>, remedy: &'static str) -> FilmError {
        let what = what.into();
        FilmError::Unsuited { what, remedy }
    }

    /// A decoder panicked.
    pub(super) fn stopped(format: &'static str, stopped: Stopped) -> FilmError {
        FilmError::unreadable(format, format!("it is broken ({stopped}): write it again"))
    }
}

/// No compression of PNG or EXR has a higher ratio: deflate, the strongest, reaches 1032.
const MOST_BYTES_FROM_ONE: u64 = 1100;

/// Fails if a file of `bytes` bytes cannot hold `claimed` bytes of pixels; called before these are
/// allocated.
pub(super) fn check_claim(claimed: u64, bytes: usize) -> Result<(), FilmError> {
    if claimed <= MOST_BYTES_FROM_ONE.saturating_mul(bytes as u64) {
        return Ok(());
    }
    Err(FilmError::Bomb { claimed, bytes })
}

/// Fails for images too large to be read.
pub(super) fn check_size(width: usize, height: usize) -> Result<(), FilmError> {
    if width == 0 || height == 0 {
        return Err(FilmError::Empty { width, height });
    }
    if width.saturating_mul(height) > Film::MOST_PIXELS {
        return Err(FilmError::TooLarge { width, height });
    }
    Ok(())
}

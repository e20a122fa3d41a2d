//! Why something is no image, or not one that can be judged.

use super::Film;
use crate::decoder::Stopped;
use thiserror::Error;

/// Why bytes are no image.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum FilmError {
    /// Not readable as an image of the format.
    #[error("not a readable {format} image: {reason}")]
    Unreadable {
        /// `EXR`, `PFM`, `NPY` or `PNG`.
        format: &'static str,
        /// What the reader says.
        reason: String,
    },
    /// An image, but of a kind whose colours would have to be guessed.
    #[error("{what}; {remedy}")]
    Unsuited {
        /// What the file holds.
        what: String,
        /// What to do instead.
        remedy: &'static str,
    },
    /// The contents are not what the extension says.
    #[error(
        "named .{extension}, but it begins like {really}: name it after what it is, or write it \
         as one of the formats that are read (.exr, .pfm, .npy, .png)"
    )]
    Disguised {
        /// What the name says.
        extension: &'static str,
        /// What the first bytes say, with its article.
        really: &'static str,
    },
    /// Pixels that the file is too short to hold.
    #[error(
        "the image claims {claimed} bytes of pixels, which a file of {bytes} bytes cannot hold"
    )]
    Bomb {
        /// Bytes of all pixels, uncompressed.
        claimed: u64,
        /// Bytes of the file.
        bytes: usize,
    },
    /// No colours inside.
    #[error("no layer of the image has the channels R, G and B; there are: {found}")]
    Channels {
        /// Names of the channels there are, `layer.channel` in a named layer.
        found: String,
    },
    /// Colours of several layers, none of which is the main one.
    #[error(
        "several layers have colours, and none is the main one: {}; write one of them without a \
         name, or call it rgba, beauty or combined",
        .0.join(", ")
    )]
    Layers(Vec<String>),
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
    /// Variances that cannot be understood.
    #[error("the noise of the image cannot be read: {0}")]
    Noise(&'static str),
    /// Renderings that are not independent renderings of one picture.
    #[error("no independent renderings of one picture: {0}")]
    Replicates(String),
    /// A file name that stands for no format.
    #[error(
        "not an image by its extension: known are .exr, .pfm and .npy (linear radiance) and .png \
         (8-bit sRGB)"
    )]
    Format,
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
        FilmError::unreadable(format, stopped.to_string())
    }
}

/// No compression of PNG or EXR makes more of a byte: deflate, the strongest, reaches 1032.
const MOST_BYTES_FROM_ONE: u64 = 1100;

/// Fails where a file of that many bytes cannot hold `claimed` bytes of pixels: asked before
/// they are allocated.
pub(super) fn check_claim(claimed: u64, bytes: usize) -> Result<(), FilmError> {
    if claimed <= MOST_BYTES_FROM_ONE.saturating_mul(bytes as u64) {
        return Ok(());
    }
    Err(FilmError::Bomb { claimed, bytes })
}

/// Fails where no image of that size is read.
pub(super) fn check_size(width: usize, height: usize) -> Result<(), FilmError> {
    if width == 0 || height == 0 {
        return Err(FilmError::Empty { width, height });
    }
    if width.saturating_mul(height) > Film::MOST_PIXELS {
        return Err(FilmError::TooLarge { width, height });
    }
    Ok(())
}

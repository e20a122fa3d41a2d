//! Errors in reading images.

use super::Film;
use crate::files::decoder::Stopped;
use thiserror::Error;

/// Reason why bytes are not a usable image, and the remedy.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{0}")]
pub struct FilmError(pub(crate) String);

impl FilmError {
    /// Not a readable image of the `format`: `EXR`, `PFM`, `NPY` or `PNG`.
    pub(super) fn unreadable(format: &'static str, reason: impl Into<String>) -> FilmError {
        let reason = reason.into();
        FilmError(format!("not a readable {format} image: {reason}"))
    }

    /// A kind of image whose colours would have to be guessed.
    pub(super) fn unsuited(what: impl Into<String>, remedy: &'static str) -> FilmError {
        let what = what.into();
        FilmError(format!("{what}; {remedy}"))
    }

    /// Variances that cannot be used.
    pub(super) fn noise(reason: &str) -> FilmError {
        FilmError(format!("the noise of the image cannot be read: {reason}"))
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
    Err(FilmError(format!(
        "the image claims {claimed} bytes of pixels, which a file of {bytes} bytes cannot hold"
    )))
}

/// Fails for images without pixels, and for those too large to be read.
pub(super) fn check_size(width: usize, height: usize) -> Result<(), FilmError> {
    let most = Film::MOST_PIXELS;
    if (1..=most).contains(&width.saturating_mul(height)) {
        return Ok(());
    }
    Err(FilmError(format!(
        "the image claims {width} × {height} pixels; from 1 to {most} are read"
    )))
}

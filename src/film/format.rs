//! Image formats, by extension and by first bytes.

use super::FilmError;
use crate::files::file_kind::by_bytes;
use serde::{Deserialize, Serialize};
use std::ffi::OsStr;
use std::path::Path;

/// A format that images can be read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FilmFormat {
    /// `.exr`: OpenEXR, linear radiance.
    Exr,
    /// `.pfm`: portable float map, linear radiance.
    Pfm,
    /// `.npy`: one array of NumPy, linear radiance.
    Npy,
    /// `.png`: 8-bit sRGB codes.
    Png,
}

impl FilmFormat {
    /// All formats, by their extensions.
    const EXTENSIONS: [(&str, FilmFormat); 4] = [
        ("exr", FilmFormat::Exr),
        ("pfm", FilmFormat::Pfm),
        ("npy", FilmFormat::Npy),
        ("png", FilmFormat::Png),
    ];

    /// The format for the extension of `path`, in upper or lower case.
    pub fn of(path: &Path) -> Option<FilmFormat> {
        FilmFormat::with_extension(path.extension()?)
    }

    /// The format of `path`, or a message about what is supported.
    pub fn known(path: &Path) -> Result<FilmFormat, FilmError> {
        FilmFormat::of(path).ok_or_else(|| {
            let formats = ".exr, .pfm and .npy (linear radiance) and .png (8-bit sRGB)";
            let message = format!("unknown image extension: supported are {formats}");
            FilmError::unsuited(message, FilmFormat::CONVERSION)
        })
    }

    /// The way from an image that is not read to one that is.
    pub const CONVERSION: &str = "write linear radiance as .exr, or convert without loss: oiiotool image.tif -d float -o \
        image.exr, or oiiotool image.ppm -o image.png for 8-bit sRGB codes";

    /// True if it holds codes of 8 bits in place of radiance.
    pub(crate) fn is_of_codes(self) -> bool {
        match self {
            FilmFormat::Exr | FilmFormat::Pfm | FilmFormat::Npy => false,
            FilmFormat::Png => true,
        }
    }

    /// The format with this extension, in upper or lower case.
    pub fn with_extension(extension: &OsStr) -> Option<FilmFormat> {
        let mut formats = FilmFormat::EXTENSIONS.into_iter();
        let found = formats.find(|(of, _)| extension.eq_ignore_ascii_case(of));
        found.map(|(_, format)| format)
    }

    /// The extension, without the dot.
    pub fn extension(self) -> &'static str {
        let mut formats = FilmFormat::EXTENSIONS.into_iter();
        let found = formats.find(|(_, format)| *format == self);
        found.expect("every format has one").0
    }

    /// Fails if `bytes` begin with the signature of another kind of file. Unknown bytes are
    /// left to the reader, which reports the error.
    pub fn check(self, bytes: &[u8]) -> Result<(), FilmError> {
        let extension = self.extension();
        let image = format!("image.{extension}");
        match by_bytes(bytes) {
            Some(kind) if !kind.is_name(Path::new(&image)) => Err(FilmError(format!(
                "named .{extension}, but it begins like {}: give it the right extension, or write \
                 one of the supported formats (.exr, .pfm, .npy, .png)",
                kind.name
            ))),
            _ => Ok(()),
        }
    }
}

//! Which format a file has: by its name, and by its first bytes.

use super::FilmError;
use std::path::Path;

/// What an image can be read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmFormat {
    /// `.exr`: OpenEXR, linear radiance.
    Exr,
    /// `.pfm`: portable float map, linear radiance.
    Pfm,
    /// `.npy`: one array of NumPy, linear radiance.
    Npy,
    /// `.png`: sRGB codes of 8 bits.
    Png,
}

impl FilmFormat {
    /// All of them.
    pub const ALL: [FilmFormat; 4] = [
        FilmFormat::Exr,
        FilmFormat::Pfm,
        FilmFormat::Npy,
        FilmFormat::Png,
    ];

    /// The format that the extension of `path` stands for, in capitals or not.
    pub fn of(path: &Path) -> Option<FilmFormat> {
        let extension = path.extension()?;
        let is_of = |format: &FilmFormat| extension.eq_ignore_ascii_case(format.extension());
        FilmFormat::ALL.into_iter().find(is_of)
    }

    /// Without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            FilmFormat::Exr => "exr",
            FilmFormat::Pfm => "pfm",
            FilmFormat::Npy => "npy",
            FilmFormat::Png => "png",
        }
    }

    /// Fails where `bytes` begin like another kind of file that people put images into. Bytes
    /// that begin like nothing known are left to the reader, which says what is wrong with them.
    pub fn check(self, bytes: &[u8]) -> Result<(), FilmError> {
        let begins = |(signature, ..): &&(&[u8], _, _)| bytes.starts_with(signature);
        match KINDS.iter().find(begins) {
            Some(&(_, really, format)) if format != Some(self) => Err(FilmError::Disguised {
                extension: self.extension(),
                really,
            }),
            _ => Ok(()),
        }
    }
}

/// First bytes of a kind of file, its name, and the format if it is one of ours.
const KINDS: [(&[u8], &str, Option<FilmFormat>); 14] = [
    (b"\x76\x2f\x31\x01", "an EXR image", Some(FilmFormat::Exr)),
    (b"PF\n", "a PFM image", Some(FilmFormat::Pfm)),
    (b"Pf\n", "a PFM image", Some(FilmFormat::Pfm)),
    (b"\x93NUMPY", "a NumPy array", Some(FilmFormat::Npy)),
    (b"\x89PNG\r\n\x1a\n", "a PNG image", Some(FilmFormat::Png)),
    (b"\xff\xd8\xff", "a JPEG image", None),
    (b"II*\0", "a TIFF image", None),
    (b"MM\0*", "a TIFF image", None),
    (b"#?RADIANCE", "a Radiance HDR image", None),
    (b"GIF8", "a GIF image", None),
    (b"P6", "a PPM image", None),
    (b"PK\x03\x04", "a ZIP archive (as .npz is)", None),
    (b"\x1f\x8b", "a file compressed by gzip", None),
    (b"version https://git-lfs", "a pointer of Git LFS", None),
];

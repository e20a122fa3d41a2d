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
        let kind = KINDS.iter().find(|kind| bytes.starts_with(kind.signature));
        match kind {
            Some(kind) if kind.format != Some(self) => Err(FilmError::Disguised {
                extension: self.extension(),
                really: kind.name,
            }),
            _ => Ok(()),
        }
    }
}

/// A kind of file.
struct FileKind {
    /// Its first bytes.
    signature: &'static [u8],
    name: &'static str,
    format: Option<FilmFormat>,
}

const KINDS: [FileKind; 14] = [
    kind(b"\x76\x2f\x31\x01", "an EXR image", Some(FilmFormat::Exr)),
    kind(b"PF\n", "a PFM image", Some(FilmFormat::Pfm)),
    kind(b"Pf\n", "a PFM image", Some(FilmFormat::Pfm)),
    kind(b"\x93NUMPY", "a NumPy array", Some(FilmFormat::Npy)),
    kind(b"\x89PNG\r\n\x1a\n", "a PNG image", Some(FilmFormat::Png)),
    kind(b"\xff\xd8\xff", "a JPEG image", None),
    kind(b"II*\0", "a TIFF image", None),
    kind(b"MM\0*", "a TIFF image", None),
    kind(b"#?RADIANCE", "a Radiance HDR image", None),
    kind(b"GIF8", "a GIF image", None),
    kind(b"P6", "a PPM image", None),
    kind(b"PK\x03\x04", "a ZIP archive (as .npz is)", None),
    kind(b"\x1f\x8b", "a file compressed by gzip", None),
    kind(b"version https://git-lfs", "a pointer of Git LFS", None),
];

const fn kind(
    signature: &'static [u8],
    name: &'static str,
    format: Option<FilmFormat>,
) -> FileKind {
    FileKind {
        signature,
        name,
        format,
    }
}

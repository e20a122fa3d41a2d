//! Volumes from files, the format told by the extension.

use super::course_grid::Header;
use super::{
    CourseGridError, Grid, ObjError, SplatError, Splatting, read_course_grid, read_obj_points,
    splat,
};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What a volume can be read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolumeFormat {
    /// `.obj`: a point cloud in Wavefront OBJ, splatted.
    Obj,
    /// `.bin`: the course's binary grid.
    CourseGrid,
}

impl VolumeFormat {
    /// The format that the extension of `path` stands for, in capitals or not.
    pub fn of(path: &Path) -> Option<VolumeFormat> {
        let extension = path.extension()?.to_str()?;
        match extension.to_ascii_lowercase().as_str() {
            "obj" => Some(VolumeFormat::Obj),
            "bin" => Some(VolumeFormat::CourseGrid),
            _ => None,
        }
    }
}

/// Why a volume could not be loaded. The message begins with the path, and with line and column
/// where there are any.
#[derive(Debug, Error)]
pub enum VolumeError {
    /// An extension that stands for no format.
    #[error(
        "{}: not a volume by its extension: known are .obj (point cloud) and .bin (course grid)",
        .0.display()
    )]
    Format(PathBuf),
    /// Nothing there.
    #[error("{}: there is no such file", .0.display())]
    Missing(PathBuf),
    /// A directory, or a device.
    #[error("{}: this is {what}, and a volume is a file", path.display())]
    NotAFile {
        /// Where.
        path: PathBuf,
        /// What is there instead.
        what: &'static str,
    },
    /// A point cloud too large to be meant.
    #[error(
        "{}: the file has {bytes} bytes, and point clouds of at most {most} are read: thin it out",
        path.display()
    )]
    TooLarge {
        /// Where.
        path: PathBuf,
        /// Bytes in the file.
        bytes: u64,
        /// Bytes accepted.
        most: u64,
    },
    /// The system refuses.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// Where.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Not a point cloud.
    #[error(
        "{}:{}{error}",
        path.display(),
        if error.place.is_some() { "" } else { " " }
    )]
    Obj {
        /// Where.
        path: PathBuf,
        /// What is wrong in it.
        error: ObjError,
    },
    /// Not a course grid.
    #[error("{}: {error}", path.display())]
    CourseGrid {
        /// Where.
        path: PathBuf,
        /// What is wrong in it.
        error: CourseGridError,
    },
    /// A cloud, but not with this splatting.
    #[error("{}: {error}", path.display())]
    Splat {
        /// Where.
        path: PathBuf,
        /// What is wrong.
        error: SplatError,
    },
}

/// Largest point cloud read, in bytes: 4 GiB, some hundred million points.
const MOST_OBJ_BYTES: u64 = 1 << 32;

/// Loads a density grid: a point cloud by `splatting`, a grid as it is.
///
/// Densities are finite and not negative; those of a splatted cloud have the maximum 1.
pub fn load(path: &Path, splatting: Splatting) -> Result<Grid<f32>, VolumeError> {
    load_hashed(path, splatting).map(|(grid, _)| grid)
}

/// [`load`], and the BLAKE3 hash of the bytes read: it tells later whether a file is still the
/// one an image was made from.
pub fn load_hashed(path: &Path, splatting: Splatting) -> Result<(Grid<f32>, String), VolumeError> {
    let format = VolumeFormat::of(path).ok_or_else(|| VolumeError::Format(path.to_owned()))?;
    let (file, length) = open(path)?;
    match format {
        VolumeFormat::Obj => load_cloud(path, file, length, splatting),
        VolumeFormat::CourseGrid => load_course_grid(path, file, length),
    }
}

fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// Opens a regular file and tells its length.
fn open(path: &Path) -> Result<(File, u64), VolumeError> {
    let trouble = |source: io::Error| match source.kind() {
        io::ErrorKind::NotFound => VolumeError::Missing(path.to_owned()),
        _ => VolumeError::Read {
            path: path.to_owned(),
            source,
        },
    };
    // Before opening: to open a named pipe is to wait for a writer.
    let metadata = std::fs::metadata(path).map_err(trouble)?;
    if !metadata.is_file() {
        return Err(VolumeError::NotAFile {
            path: path.to_owned(),
            what: if metadata.is_dir() {
                "a directory"
            } else {
                "a device or pipe"
            },
        });
    }
    let file = File::open(path).map_err(trouble)?;
    Ok((file, metadata.len()))
}

fn load_cloud(
    path: &Path,
    file: File,
    length: u64,
    splatting: Splatting,
) -> Result<(Grid<f32>, String), VolumeError> {
    if length > MOST_OBJ_BYTES {
        return Err(VolumeError::TooLarge {
            path: path.to_owned(),
            bytes: length,
            most: MOST_OBJ_BYTES,
        });
    }
    let mut bytes = Vec::new();
    read(path, file.take(MOST_OBJ_BYTES), &mut bytes)?;
    let points = read_obj_points(&bytes).map_err(|error| VolumeError::Obj {
        path: path.to_owned(),
        error,
    })?;
    let grid = splat(&points, splatting).map_err(|error| VolumeError::Splat {
        path: path.to_owned(),
        error,
    })?;
    Ok((grid, hash(&bytes)))
}

/// The header is held against the length of the file before the rest is read.
fn load_course_grid(
    path: &Path,
    mut file: File,
    length: u64,
) -> Result<(Grid<f32>, String), VolumeError> {
    let trouble = |error| VolumeError::CourseGrid {
        path: path.to_owned(),
        error,
    };
    let mut bytes = Vec::new();
    read(path, (&mut file).take(Header::BYTES as u64), &mut bytes)?;
    let header = Header::read(&bytes).map_err(trouble)?;
    header.check_length(length).map_err(trouble)?;
    read(path, file.take(length - Header::BYTES as u64), &mut bytes)?;
    let grid = read_course_grid(&bytes).map_err(trouble)?;
    Ok((grid, hash(&bytes)))
}

fn read(path: &Path, mut source: impl Read, bytes: &mut Vec<u8>) -> Result<(), VolumeError> {
    match source.read_to_end(bytes) {
        Ok(_) => Ok(()),
        Err(source) => Err(VolumeError::Read {
            path: path.to_owned(),
            source,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_go_by_the_extension() {
        let of = |path: &str| VolumeFormat::of(Path::new(path));
        assert_eq!(of("a/b.obj"), Some(VolumeFormat::Obj));
        assert_eq!(of("a.b/C.OBJ"), Some(VolumeFormat::Obj));
        assert_eq!(of("smoke.bin"), Some(VolumeFormat::CourseGrid));
        for other in ["", "obj", ".obj", "a.obj.gz", "a.vol", "a."] {
            assert_eq!(of(other), None, "{other}");
        }
    }
}

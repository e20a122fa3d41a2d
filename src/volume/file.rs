//! Volumes from files, the format told by the extension.

use super::{
    CourseGridError, Encoding, Grid, Layout, LoadOptions, NiftiError, NrrdError, ObjError,
    RawVolumeError, SplatError, VolError, read_obj_points, splat,
};
use super::{course_grid, mitsuba_vol, nifti};
use super::{nrrd::NrrdHeader, raw_volume::RawVolume};
use crate::geometry::Aabb;
use crate::regular_file::{self, OpenError};
use glam::DVec3;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Component, Path, PathBuf};
use thiserror::Error;

/// What a volume can be read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolumeFormat {
    /// `.obj`: a point cloud in Wavefront OBJ, splatted.
    Obj,
    /// `.bin`: the course's binary grid.
    CourseGrid,
    /// `.vol`: Mitsuba's grid.
    MitsubaVol,
    /// `.nrrd`, and `.nhdr` with its data in another file.
    Nrrd,
    /// `.nii`: NIfTI-1.
    Nifti,
    /// `.nii.gz`: the same, compressed.
    NiftiGzip,
    /// `.toml`: a description of a file of bare samples.
    RawVolume,
}

impl VolumeFormat {
    /// The format that the extension of `path` stands for, in capitals or not.
    pub fn of(path: &Path) -> Option<VolumeFormat> {
        let extension = path.extension()?.to_str()?;
        match extension.to_ascii_lowercase().as_str() {
            "obj" => Some(VolumeFormat::Obj),
            "bin" => Some(VolumeFormat::CourseGrid),
            "vol" => Some(VolumeFormat::MitsubaVol),
            "nrrd" | "nhdr" => Some(VolumeFormat::Nrrd),
            "nii" => Some(VolumeFormat::Nifti),
            "gz" => {
                let inner = Path::new(path.file_stem()?).extension()?.to_str()?;
                let nifti = inner.eq_ignore_ascii_case("nii");
                nifti.then_some(VolumeFormat::NiftiGzip)
            }
            "toml" => Some(VolumeFormat::RawVolume),
            _ => None,
        }
    }

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            VolumeFormat::Obj => "point cloud (Wavefront OBJ)",
            VolumeFormat::CourseGrid => "course grid",
            VolumeFormat::MitsubaVol => "Mitsuba volume",
            VolumeFormat::Nrrd => "NRRD",
            VolumeFormat::Nifti | VolumeFormat::NiftiGzip => "NIfTI-1",
            VolumeFormat::RawVolume => "bare samples, described in TOML",
        }
    }

    /// Whether the file holds points that are splatted, and not a grid.
    pub fn is_cloud(self) -> bool {
        self == VolumeFormat::Obj
    }
}

/// A volume, and where it came from.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The grid. Values are finite unless [`NonFinite::Kept`](super::NonFinite::Kept) was asked
    /// for, and may be negative: [`Grid::check_densities`] tells.
    pub grid: Grid<f32>,
    /// The files read: the volume, and that of its data if they are apart.
    pub files: Vec<FileRead>,
    /// What the files hold.
    pub format: VolumeFormat,
    /// How they hold it.
    pub stored: Stored,
}

/// A file that was read to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileRead {
    /// Where.
    pub path: PathBuf,
    /// BLAKE3 of its bytes: it tells later whether a file is still the one an image was made
    /// from.
    pub hash: String,
}

/// How a file holds a volume.
#[derive(Clone, Debug, PartialEq)]
pub enum Stored {
    /// As points.
    Cloud {
        /// How many.
        points: usize,
        /// The box around them.
        extent: Aabb,
    },
    /// As samples of a grid.
    Samples(Layout),
}

/// Why a volume could not be loaded. The message begins with the path, and with line and column
/// where there are any.
#[derive(Debug, Error)]
pub enum VolumeError {
    /// An extension that stands for no format.
    #[error(
        "{}: not a volume by its extension: known are .obj (point cloud), .bin (course grid), \
         .vol (Mitsuba), .nrrd and .nhdr, .nii and .nii.gz (NIfTI-1), and .toml (description of \
         bare samples)",
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
    /// Not a Mitsuba volume.
    #[error("{}: {error}", path.display())]
    Vol {
        /// Where.
        path: PathBuf,
        /// What is wrong in it.
        error: VolError,
    },
    /// Not a NRRD file.
    #[error(
        "{}:{}{error}",
        path.display(),
        if matches!(error, NrrdError::Line { .. }) { "" } else { " " }
    )]
    Nrrd {
        /// Where.
        path: PathBuf,
        /// What is wrong in it.
        error: NrrdError,
    },
    /// Not a NIfTI-1 file.
    #[error("{}: {error}", path.display())]
    Nifti {
        /// Where.
        path: PathBuf,
        /// What is wrong in it.
        error: NiftiError,
    },
    /// Not a description of bare samples, or not one of these.
    #[error(
        "{}:{}{error}",
        path.display(),
        if matches!(error, RawVolumeError::Description { .. }) { "" } else { " " }
    )]
    RawVolume {
        /// Where.
        path: PathBuf,
        /// What is wrong in it.
        error: RawVolumeError,
    },
    /// Data in another folder.
    #[error(
        "{}: its data are in {name:?}, outside its folder, and nobody asked to read there: move \
         the file beside the header, or allow detached_anywhere",
        path.display()
    )]
    Outside {
        /// Where the header is.
        path: PathBuf,
        /// The file it names, or to which a link of that name leads.
        name: String,
    },
    /// The file that a header names cannot be read.
    #[error("{}: the file of its data cannot be had: {error}", path.display())]
    Data {
        /// Where the header is.
        path: PathBuf,
        /// What is wrong with the other file.
        error: Box<VolumeError>,
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

/// Longest description of bare samples, in bytes: 1 MiB.
const MOST_DESCRIPTION_BYTES: u64 = 1 << 20;

/// The grid of [`load_hashed`].
pub fn load(path: &Path, options: &LoadOptions) -> Result<Grid<f32>, VolumeError> {
    load_hashed(path, options).map(|loaded| loaded.grid)
}

/// Loads a volume: a point cloud by splatting, a grid as it is.
///
/// A splatted cloud has the maximum 1. Values of a grid are finite, unless asked for otherwise,
/// and may be negative.
pub fn load_hashed(path: &Path, options: &LoadOptions) -> Result<Loaded, VolumeError> {
    let format = VolumeFormat::of(path).ok_or_else(|| VolumeError::Format(path.to_owned()))?;
    let mut source = Source::open(path)?;
    let length = source.length;
    let owned = || path.to_owned();
    let mut data = None;
    let (grid, stored) = match format {
        VolumeFormat::Obj => load_cloud(&mut source, options)?,
        VolumeFormat::CourseGrid => {
            let read = course_grid::read(&mut source, length, options);
            let (grid, layout) = read.map_err(|error| VolumeError::CourseGrid {
                path: owned(),
                error,
            })?;
            (grid, Stored::Samples(layout))
        }
        VolumeFormat::MitsubaVol => {
            let read = mitsuba_vol::read(&mut source, length, options);
            let (grid, layout) = read.map_err(|error| VolumeError::Vol {
                path: owned(),
                error,
            })?;
            (grid, Stored::Samples(layout))
        }
        VolumeFormat::Nifti | VolumeFormat::NiftiGzip => {
            let compressed = format == VolumeFormat::NiftiGzip;
            let read = nifti::read(&mut source, length, compressed, options);
            let (grid, mut layout) = read.map_err(|error| VolumeError::Nifti {
                path: owned(),
                error,
            })?;
            if compressed {
                layout.encoding = Encoding::Gzip;
            }
            (grid, Stored::Samples(layout))
        }
        VolumeFormat::Nrrd => {
            let trouble = |error| VolumeError::Nrrd {
                path: owned(),
                error,
            };
            let (header, header_length) = NrrdHeader::read(&mut source).map_err(trouble)?;
            let read = match &header.data_file {
                None => header.read_from(&mut source, length - header_length, options),
                Some(name) => {
                    let other = data.insert(Source::beside(path, name, options)?);
                    let length = other.length;
                    header.read_from(other, length, options)
                }
            };
            (read.map_err(trouble)?, Stored::Samples(header.layout))
        }
        VolumeFormat::RawVolume => {
            let trouble = |error| VolumeError::RawVolume {
                path: owned(),
                error,
            };
            let text = source.text()?;
            let volume = RawVolume::parse(&text).map_err(trouble)?;
            let other = data.insert(Source::beside(path, &volume.file, options)?);
            let length = other.length;
            let grid = volume.read_from(other, length, options);
            (grid.map_err(trouble)?, Stored::Samples(volume.layout))
        }
    };
    let mut files = vec![source.finish()?];
    if let Some(data) = data {
        files.push(data.finish()?);
    }
    Ok(Loaded {
        grid,
        files,
        format,
        stored,
    })
}

/// A regular file that is hashed while it is read.
struct Source {
    path: PathBuf,
    /// Bytes in the file.
    length: u64,
    reader: BufReader<Hashed>,
}

struct Hashed {
    file: File,
    hasher: blake3::Hasher,
}

impl Read for Hashed {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(bytes)?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }
}

/// Where `data` really lie, if a symbolic link leads out of the folder of the `header`: neither
/// into the one in which it is named nor into the one in which it lies itself. Data that are not
/// there lie nowhere.
fn away(header: &Path, data: &Path) -> Option<PathBuf> {
    let data = data.canonicalize().ok()?;
    let named = match header.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let (named, real) = (named.canonicalize().ok()?, header.canonicalize().ok()?);
    let folders = [Some(named.as_path()), real.parent()];
    let inside = folders
        .into_iter()
        .flatten()
        .any(|folder| data.starts_with(folder));
    (!inside).then_some(data)
}

impl Source {
    fn open(path: &Path) -> Result<Source, VolumeError> {
        let (file, length) = open(path)?;
        let hasher = blake3::Hasher::new();
        Ok(Source {
            path: path.to_owned(),
            length,
            reader: BufReader::with_capacity(1 << 16, Hashed { file, hasher }),
        })
    }

    /// The file `name` that the header at `path` speaks of.
    fn beside(path: &Path, name: &str, options: &LoadOptions) -> Result<Source, VolumeError> {
        let inside = |part| matches!(part, Component::Normal(_) | Component::CurDir);
        if !options.detached_anywhere && !Path::new(name).components().all(inside) {
            return Err(VolumeError::Outside {
                path: path.to_owned(),
                name: name.to_owned(),
            });
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        // By parts, so that `./tooth.raw` becomes `tooth.raw`.
        let below = Path::new(name).components();
        let other = folder.join(
            below
                .filter(|part| *part != Component::CurDir)
                .collect::<PathBuf>(),
        );
        if let Some(elsewhere) = away(path, &other).filter(|_| !options.detached_anywhere) {
            return Err(VolumeError::Outside {
                path: path.to_owned(),
                name: elsewhere.display().to_string(),
            });
        }
        Source::open(&other).map_err(|error| VolumeError::Data {
            path: path.to_owned(),
            error: Box::new(error),
        })
    }

    /// The rest of a file that should be a short text.
    fn text(&mut self) -> Result<String, VolumeError> {
        if self.length > MOST_DESCRIPTION_BYTES {
            return Err(VolumeError::RawVolume {
                path: self.path.clone(),
                error: RawVolumeError::TooLong(self.length),
            });
        }
        let mut bytes = Vec::new();
        let read = (&mut self.reader)
            .take(MOST_DESCRIPTION_BYTES)
            .read_to_end(&mut bytes);
        read.map_err(|source| self.trouble(source))?;
        String::from_utf8(bytes).map_err(|_| VolumeError::RawVolume {
            path: self.path.clone(),
            error: RawVolumeError::NotText,
        })
    }

    /// Reads what is left of the file, so that its hash is that of all its bytes.
    fn finish(mut self) -> Result<FileRead, VolumeError> {
        let rest = io::copy(&mut self.reader, &mut io::sink());
        rest.map_err(|source| self.trouble(source))?;
        Ok(FileRead {
            hash: self.reader.get_ref().hasher.finalize().to_hex().to_string(),
            path: self.path,
        })
    }

    fn trouble(&self, source: io::Error) -> VolumeError {
        VolumeError::Read {
            path: self.path.clone(),
            source,
        }
    }
}

impl Read for Source {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.reader.read(bytes)
    }
}

impl BufRead for Source {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.reader.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.reader.consume(count);
    }
}

/// Opens a regular file and tells its length.
fn open(path: &Path) -> Result<(File, u64), VolumeError> {
    regular_file::open(path).map_err(|error| match error {
        OpenError::Missing(_) => VolumeError::Missing(path.to_owned()),
        OpenError::NotAFile(what) => VolumeError::NotAFile {
            path: path.to_owned(),
            what,
        },
        OpenError::Refused(source) => VolumeError::Read {
            path: path.to_owned(),
            source,
        },
    })
}

fn load_cloud(
    source: &mut Source,
    options: &LoadOptions,
) -> Result<(Grid<f32>, Stored), VolumeError> {
    let path = source.path.clone();
    if source.length > MOST_OBJ_BYTES {
        return Err(VolumeError::TooLarge {
            path,
            bytes: source.length,
            most: MOST_OBJ_BYTES,
        });
    }
    let mut bytes = Vec::new();
    let read = source.take(MOST_OBJ_BYTES).read_to_end(&mut bytes);
    read.map_err(|error| source.trouble(error))?;
    let points = match read_obj_points(&bytes) {
        Ok(points) => points,
        Err(error) => return Err(VolumeError::Obj { path, error }),
    };
    drop(bytes);
    let grid = match splat(&points, options.splatting) {
        Ok(grid) => grid,
        Err(error) => return Err(VolumeError::Splat { path, error }),
    };
    let first = points[0].position;
    let around = |(min, max): (DVec3, DVec3), position| (min.min(position), max.max(position));
    let positions = points.iter().map(|point| point.position);
    let (min, max) = positions.fold((first, first), around);
    let stored = Stored::Cloud {
        points: points.len(),
        extent: Aabb { min, max },
    };
    Ok((grid, stored))
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
        assert_eq!(of("smoke.vol"), Some(VolumeFormat::MitsubaVol));
        assert_eq!(of("a.nrrd"), Some(VolumeFormat::Nrrd));
        assert_eq!(of("a.Nhdr"), Some(VolumeFormat::Nrrd));
        assert_eq!(of("a.nii"), Some(VolumeFormat::Nifti));
        assert_eq!(of("a.b.NII.gz"), Some(VolumeFormat::NiftiGzip));
        assert_eq!(of("a.raw.toml"), Some(VolumeFormat::RawVolume));
        for other in ["", "obj", ".obj", "a.obj.gz", "a.vdb", "a.", "a.gz", ".nii"] {
            assert_eq!(of(other), None, "{other}");
        }
    }
}

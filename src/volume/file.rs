//! Volumes from files, in the format of the extension.

use super::error::{VolumeError, VolumeFault};
use super::grid::Grid;
use super::load_options::LoadOptions;
use super::samples::{Stored, VolumeRead};
use super::source::{FileRead, VolumeSource};
use crate::files::file_kind::{FileKind, HEAD, OF_SLICES, by_bytes, by_name, ends_in};
use crate::files::{gzip, regular_file};
use crate::geometry::Transform;
use std::io::BufRead;
use std::path::Path;

/// Content of a file of a format, by what it leaves to the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// Points to be splatted: the grid.
    Points,
    /// A grid: nothing.
    Grid,
    /// Samples that a description places: perhaps the order of their axes.
    Samples,
    /// An array: positions, and the order of its axes.
    Array,
}

/// A format of volume files.
pub(crate) struct VolumeFormat {
    /// Name of the format.
    pub name: &'static str,
    /// Extensions of its files: a dot and lower-case letters. Upper case is recognised, too.
    pub extensions: &'static [&'static str],
    /// What its files contain, and leave to the scene.
    pub content: Content,
    /// Reads a file of the format. Values of the grid are finite, unless asked for otherwise, and
    /// may be negative.
    read: fn(&mut VolumeSource, &LoadOptions) -> VolumeRead,
}

/// Declares formats of volume files, one a row: name, extensions, content, and the function that reads a file.
macro_rules! formats {
    ($($name:literal, $extensions:expr, $content:ident, $read:path;)+) => {
        [$(VolumeFormat { name: $name, extensions: &$extensions, content: Content::$content, read: $read },)+]
    };
}

/// Every format that is read.
static VOLUME_FORMATS: [VolumeFormat; 9] = formats! {
    "Wavefront point cloud", [".obj"], Points, super::obj_points::read;
    "binary grid", [".bin"], Grid, super::course_grid::read;
    "Mitsuba volume", [".vol"], Grid, super::mitsuba_vol::read;
    "NRRD", [".nrrd", ".nhdr"], Grid, super::nrrd::read;
    "NIfTI-1", [".nii", ".nii.gz"], Grid, super::nifti::read;
    "MetaImage", [".mha", ".mhd"], Grid, super::meta_image::read;
    "NumPy array", [".npy"], Array, super::npy_array::read;
    "NumPy archive of one array", [".npz"], Array, super::npy_array::read_archive;
    "raw samples, described in TOML", [".toml"], Samples, super::raw_volume::read;
};

/// A volume and its origin.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The grid. Values are finite unless [`NonFinite::Kept`](super::NonFinite::Kept) was
    /// requested, and may be negative: see [`Grid::check_densities`].
    pub grid: Grid<f32>,
    /// The map of the grid into the world, of [oblique](super::Orientation::Oblique) axes.
    pub to_world: Option<Transform>,
    /// The files read: the volume, and its detached data if any.
    pub files: Vec<FileRead>,
    /// Name of the format of the files.
    pub format: &'static str,
    /// The storage of the volume.
    pub stored: Stored,
}

/// The format of the file at `path`, by its extension.
pub(crate) fn volume_format(path: &Path) -> Option<&'static VolumeFormat> {
    VOLUME_FORMATS.iter().find(|format| {
        let mut extensions = format.extensions.iter();
        extensions.any(|extension| ends_in(path, extension))
    })
}

/// The grid in `bytes` of a file of that name, whose extension tells the format, and in the `samples` of
/// the file that it may name as theirs.
pub fn read_volume(
    name: &str,
    bytes: &[u8],
    samples: Option<&[u8]>,
    options: &LoadOptions,
) -> Result<Grid<f32>, VolumeFault> {
    let format = volume_format(Path::new(name)).ok_or_else(|| unsupported(None))?;
    let mut source = VolumeSource::of(name, bytes, samples);
    (format.read)(&mut source, options).map(|(grid, _)| grid)
}

/// The fault of a file whose extension no format has, with the remedy for it and the list of formats.
fn unsupported(remedy: Option<String>) -> VolumeFault {
    let known = volume_formats();
    let remedy = remedy.map_or(String::new(), |remedy| format!("; {remedy}"));
    format!("unsupported file extension; supported are {known}{remedy}").into()
}

/// The supported formats with their extensions, as a list for people.
pub(crate) fn volume_formats() -> String {
    let named =
        |format: &VolumeFormat| format!("{} ({})", format.extensions.join(" or "), format.name);
    let named: Vec<String> = VOLUME_FORMATS.iter().map(named).collect();
    named.join(", ")
}

/// The grid of [`load_hashed`].
pub fn load(path: &Path, options: &LoadOptions) -> Result<Grid<f32>, VolumeError> {
    load_hashed(path, options).map(|loaded| loaded.grid)
}

/// Loads a volume: a point cloud by splatting, a grid unchanged.
///
/// A splatted cloud has the maximum 1. Values of a grid are finite by default, and may be negative.
pub fn load_hashed(path: &Path, options: &LoadOptions) -> Result<Loaded, VolumeError> {
    let in_file = |fault| VolumeError {
        path: path.to_owned(),
        fault,
    };
    if path.is_dir() {
        let message = format!("this is a directory, not a volume file; {OF_SLICES}");
        return Err(in_file(message.into()));
    }
    let format = volume_format(path).ok_or_else(|| in_file(unsupported(remedy(path))))?;
    let mut source = VolumeSource::open(path)?;
    let first = source
        .fill_buf()
        .map(|first| first[..first.len().min(HEAD)].to_vec());
    let first = first.map_err(|error| source.error(error))?;
    let read = (format.read)(&mut source, options);
    let (grid, stored) = read.map_err(|fault| match misnamed(path, &first) {
        Some(misnamed) => source.error(misnamed),
        None => source.error(fault),
    })?;
    let to_world = match &stored {
        Stored::Samples { layout } => {
            let placement = layout.axes.placement(options.centring, options.orientation);
            placement.ok().and_then(|placement| placement.to_world)
        }
        Stored::Cloud { .. } => None,
    };
    Ok(Loaded {
        grid,
        to_world,
        files: source.finish()?,
        format: format.name,
        stored,
    })
}

/// The remedy for the file at `path`, whose ending no format has: by its name, else by its first bytes.
fn remedy(path: &Path) -> Option<String> {
    if let Some(remedy) = by_name(path).and_then(|kind| kind.as_volume) {
        return Some(remedy.to_owned());
    }
    let kind = by_bytes(&regular_file::first_bytes_of(path)?)?;
    let (name, way_out) = (kind.name, way_out(kind));
    Some(format!("it begins like {name}: {way_out}"))
}

/// The fault of the file at `path`, which the format of its name cannot read, if its `first` bytes
/// are those of another format.
fn misnamed(path: &Path, first: &[u8]) -> Option<String> {
    let kind = by_bytes(first).filter(|kind| !kind.is_name(path))?;
    let remedy = match path.extension() {
        Some(nii) if nii.eq_ignore_ascii_case("nii") && first.starts_with(&gzip::MAGIC) => {
            rename(".nii.gz")
        }
        _ => way_out(kind),
    };
    let name = kind.name;
    Some(format!(
        "the file begins like {name}, which its name does not say: {remedy}"
    ))
}

/// What to do with a file of that kind to have a volume.
fn way_out(kind: &FileKind) -> String {
    let is_read = |ending: &&&str| volume_format(Path::new(&format!("a{ending}"))).is_some();
    match (kind.as_volume, kind.endings.iter().find(is_read)) {
        (Some(remedy), _) => remedy.to_owned(),
        (None, Some(ending)) => rename(ending),
        (None, None) => "it holds no volume; give the file that does".to_owned(),
    }
}

fn rename(ending: &str) -> String {
    format!("rename it, so that it ends in {ending}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_go_by_the_extension() {
        let of = |path: &str| volume_format(Path::new(path)).map(|format| format.name);
        assert_eq!(of("a/b.obj"), Some("Wavefront point cloud"));
        assert_eq!(of("a.b/C.OBJ"), Some("Wavefront point cloud"));
        assert_eq!(of("smoke.bin"), Some("binary grid"));
        assert_eq!(of("smoke.vol"), Some("Mitsuba volume"));
        assert_eq!(of("a.nrrd"), Some("NRRD"));
        assert_eq!(of("a.Nhdr"), Some("NRRD"));
        assert_eq!(of("a.nii"), Some("NIfTI-1"));
        assert_eq!(of("a.b.NII.gz"), Some("NIfTI-1"));
        assert_eq!(of("a.NPY"), Some("NumPy array"));
        assert_eq!(of("a.raw.toml"), Some("raw samples, described in TOML"));
        for other in [
            "", "obj", ".obj", "a.obj.gz", "a.vdb", "a.", "a.gz", ".nii", ".nii.gz",
        ] {
            assert_eq!(of(other), None, "{other}");
        }
    }

    /// So that the order of the table says nothing.
    #[test]
    fn no_two_formats_share_an_extension() {
        let all = || {
            let formats = VOLUME_FORMATS.iter();
            formats.flat_map(|format| format.extensions)
        };
        for extension in all() {
            assert!(extension.starts_with('.') && *extension == extension.to_lowercase());
            let ending_so = all().filter(|other| other.ends_with(extension));
            assert_eq!(ending_so.count(), 1, "{extension}");
        }
    }
}

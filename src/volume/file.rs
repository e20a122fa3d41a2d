//! Volumes from files, the format by the extension.

use super::VOLUME_READERS;
use super::error::VolumeError;
use super::grid::Grid;
use super::load_options::LoadOptions;
use super::reader::{Stored, VolumeReader};
use super::source::ends_in;
use super::source::{FileRead, VolumeSource};
use std::path::Path;

/// A volume, and where it came from.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The grid. Values are finite unless [`NonFinite::Kept`](super::NonFinite::Kept) was asked
    /// for, and may be negative: [`Grid::check_densities`] tells.
    pub grid: Grid<f32>,
    /// The files read: the volume, and that of its data if they are apart.
    pub files: Vec<FileRead>,
    /// Name of the format of the files.
    pub format: &'static str,
    /// The form in which they hold the volume.
    pub stored: Stored,
}

/// The reader for the file at `path`, by its extension.
pub fn volume_reader(path: &Path) -> Option<&'static dyn VolumeReader> {
    VOLUME_READERS.into_iter().find(|reader| {
        let mut extensions = reader.extensions().iter();
        extensions.any(|extension| ends_in(path, extension))
    })
}

/// The formats that are read, each with its extensions, as a list for people.
pub fn volume_formats() -> String {
    let format = |reader: &dyn VolumeReader| {
        format!("{}: {}", reader.extensions().join(", "), reader.name())
    };
    VOLUME_READERS.map(format).join("; ")
}

/// The grid of [`load_hashed`].
pub fn load(path: &Path, options: &LoadOptions) -> Result<Grid<f32>, VolumeError> {
    load_hashed(path, options).map(|loaded| loaded.grid)
}

/// Loads a volume: a point cloud by splatting, a grid as it is.
///
/// A splatted cloud has the maximum 1. Values of a grid are finite, unless asked for otherwise,
/// and may be negative.
pub fn load_hashed(path: &Path, options: &LoadOptions) -> Result<Loaded, VolumeError> {
    let reader = volume_reader(path).ok_or_else(|| VolumeError::Format {
        path: path.to_owned(),
        known: volume_formats(),
    })?;
    let mut source = VolumeSource::open(path)?;
    let (grid, stored) = reader.read(&mut source, options)?;
    Ok(Loaded {
        grid,
        files: source.finish()?,
        format: reader.name(),
        stored,
    })
}

#[cfg(test)]
mod tests {
    use super::super::{BareSamples, CourseGrid, MitsubaVol, Nifti, Nrrd, PointCloud};
    use super::*;

    #[test]
    fn formats_go_by_the_extension() {
        let of = |path: &str| volume_reader(Path::new(path)).map(VolumeReader::name);
        assert_eq!(of("a/b.obj"), Some(PointCloud.name()));
        assert_eq!(of("a.b/C.OBJ"), Some(PointCloud.name()));
        assert_eq!(of("smoke.bin"), Some(CourseGrid.name()));
        assert_eq!(of("smoke.vol"), Some(MitsubaVol.name()));
        assert_eq!(of("a.nrrd"), Some(Nrrd.name()));
        assert_eq!(of("a.Nhdr"), Some(Nrrd.name()));
        assert_eq!(of("a.nii"), Some(Nifti.name()));
        assert_eq!(of("a.b.NII.gz"), Some(Nifti.name()));
        assert_eq!(of("a.raw.toml"), Some(BareSamples.name()));
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
            VOLUME_READERS
                .into_iter()
                .flat_map(VolumeReader::extensions)
        };
        for extension in all() {
            assert!(extension.starts_with('.') && *extension == extension.to_lowercase());
            let ending_so = all().filter(|other| other.ends_with(extension));
            assert_eq!(ending_so.count(), 1, "{extension}");
        }
    }
}

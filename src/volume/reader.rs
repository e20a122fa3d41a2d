//! The reader of a format of volume files.
//!
//! A new format is a file that implements [`VolumeReader`], and a row of
//! [`VOLUME_READERS`](super::VOLUME_READERS).

use super::error::VolumeError;
use super::grid::Grid;
use super::load_options::LoadOptions;
use super::samples::Layout;
use super::source::VolumeSource;
use crate::geometry::Aabb;
use std::fmt;

/// A format of volume files: how it is recognised, and how it is read.
pub trait VolumeReader: Send + Sync {
    /// Name of the format.
    fn name(&self) -> &'static str;

    /// Endings of the names of its files: a dot and small letters. Capitals are recognised, too.
    fn extensions(&self) -> &'static [&'static str];

    /// Whether its files hold points that are splatted, and not a grid.
    fn is_point_cloud(&self) -> bool {
        false
    }

    /// Reads a file of the format. Values of the grid are finite, unless asked for otherwise, and
    /// may be negative.
    ///
    /// # Errors
    ///
    /// Where the file cannot be read, or does not hold what its ending promises.
    fn read(
        &self,
        source: &mut VolumeSource,
        options: &LoadOptions,
    ) -> Result<(Grid<f32>, Stored), VolumeError>;
}

/// The form in which a file holds a volume.
#[derive(Clone, Debug, PartialEq)]
pub enum Stored {
    /// As points.
    Cloud {
        /// Number of points.
        points: usize,
        /// The box around them.
        extent: Aabb,
    },
    /// As samples of a grid.
    Samples(Layout),
}

impl fmt::Debug for dyn VolumeReader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

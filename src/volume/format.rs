//! A format of volume files.

use super::error::VolumeFault;
use super::grid::Grid;
use super::load_options::LoadOptions;
use super::samples::Layout;
use super::source::VolumeSource;
use crate::geometry::Aabb;

/// A format of volume files. A new one is a file that declares it, and a row of the table in
/// `file.rs`.
pub struct VolumeFormat {
    /// Name of the format.
    pub name: &'static str,
    /// Extensions of its files: a dot and lower-case letters. Upper case is recognised, too.
    pub extensions: &'static [&'static str],
    /// True if its files contain points to be splatted instead of a grid.
    pub is_point_cloud: bool,
    /// Reads a file of the format. Values of the grid are finite, unless asked for otherwise, and
    /// may be negative.
    pub(super) read: fn(&mut VolumeSource, &LoadOptions) -> VolumeRead,
}

/// Grid of a file, and its storage.
pub(super) type VolumeRead = Result<(Grid<f32>, Stored), VolumeFault>;

/// The storage of a volume in a file.
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

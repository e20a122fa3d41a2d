//! Options for reading volume files.

use super::{Centring, Orientation, Splatting};
use glam::DVec3;
use serde::Deserialize;

/// Options for converting a file to a grid, where the file is silent or the caller overrides it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// For point clouds: the grid they are splatted to.
    pub splatting: Splatting,
    /// For grids: the faces of the box, overriding the file. A Mitsuba volume gives its box, so its
    /// nodes move; all others give their nodes, so the box moves.
    pub centring: Option<Centring>,
    /// For grids: the treatment of samples that are not finite.
    pub non_finite: NonFinite,
    /// For grids: the treatment of axes other than x, y and z.
    pub orientation: Orientation,
    /// True if a header may name a file of data outside its own folder: by an absolute path, by
    /// `..`, or by a symbolic link that leads there.
    pub detached_anywhere: bool,
    /// For arrays and raw samples: the order of their axes, overriding a description; (z, y, x) if left out.
    pub axes: Option<AxisOrder>,
    /// For arrays, which state none: the distance between nodes along x, y and z; 1 if left out.
    pub spacing: Option<DVec3>,
    /// For arrays: the position of the first node; the origin if left out.
    pub origin: Option<DVec3>,
}

impl LoadOptions {
    /// The same options for an array, whose axes are x, y and z in whatever order they lie in memory: its samples
    /// are always put in the order of the world.
    pub(super) fn of_array(&self) -> LoadOptions {
        LoadOptions {
            orientation: Orientation::World,
            ..*self
        }
    }
}

/// The order of the indices of an array.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum AxisOrder {
    /// (z, y, x): of raw samples in C order x runs fastest.
    #[default]
    Zyx,
    /// (x, y, z): of raw samples in C order z runs fastest.
    Xyz,
}

impl AxisOrder {
    /// Both, by their names.
    pub const ALL: [(&'static str, AxisOrder); 2] =
        [("zyx", AxisOrder::Zyx), ("xyz", AxisOrder::Xyz)];
}

/// The treatment of a sample that is not finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum NonFinite {
    /// Refused: an error names the voxel.
    #[default]
    Refused,
    /// This value.
    Replaced(f32),
    /// Kept unchanged. For reports on a file: neither rendering nor resampling is defined.
    Kept,
}

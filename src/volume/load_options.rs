//! What the reader of a volume file is left to decide.

use super::{Centring, Orientation, Splatting};

/// How a file becomes a grid, where the file leaves it open or the caller knows better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadOptions {
    /// Of point clouds: the grid they are splatted to.
    pub splatting: Splatting,
    /// Of grids: where the faces of the box lie, in place of what the file says. A Mitsuba
    /// volume gives its box, so its nodes move; all others give their nodes, so the box moves.
    pub centring: Option<Centring>,
    /// Of grids: what stands for samples that are no finite numbers.
    pub non_finite: NonFinite,
    /// Of grids: what becomes of axes that point elsewhere than x, y and z.
    pub orientation: Orientation,
    /// Whether a header may name a file of data outside its own folder: by an absolute path, by
    /// `..`, or by a symbolic link that leads there.
    pub detached_anywhere: bool,
}

impl Default for LoadOptions {
    fn default() -> LoadOptions {
        LoadOptions::from(Splatting {
            resolution: None,
            padding: 2,
        })
    }
}

impl From<Splatting> for LoadOptions {
    fn from(splatting: Splatting) -> LoadOptions {
        LoadOptions {
            splatting,
            centring: None,
            non_finite: NonFinite::default(),
            orientation: Orientation::default(),
            detached_anywhere: false,
        }
    }
}

/// The replacement of a sample that is no finite number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum NonFinite {
    /// Nothing does: an error names the voxel.
    #[default]
    Refused,
    /// This value.
    Replaced(f32),
    /// It stays as it is. For reports on a file: neither rendering nor resampling is defined.
    Kept,
}

//! A format of volume files.

use super::load_options::LoadOptions;
use super::samples::VolumeRead;
use super::source::VolumeSource;

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

/// A format of volume files: a row of the table in `file.rs`.
pub(crate) struct VolumeFormat {
    /// Name of the format.
    pub name: &'static str,
    /// Extensions of its files: a dot and lower-case letters. Upper case is recognised, too.
    pub extensions: &'static [&'static str],
    /// What its files contain, and leave to the scene.
    pub content: Content,
    /// Reads a file of the format. Values of the grid are finite, unless asked for otherwise, and
    /// may be negative.
    pub(super) read: fn(&mut VolumeSource, &LoadOptions) -> VolumeRead,
}

//! A format of volume files.

use super::load_options::LoadOptions;
use super::samples::VolumeRead;
use super::source::VolumeSource;

/// A format of volume files. A new one is a file that declares it, and a row of the table in
/// `file.rs`.
pub(crate) struct VolumeFormat {
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

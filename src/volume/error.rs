//! Why a volume could not be loaded.

use super::splat::SplatError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why a volume could not be loaded. The message begins with the path, and with line and column
/// where there are any.
#[derive(Debug, Error)]
pub enum VolumeError {
    /// An extension that no format has.
    #[error("{}: not a volume by its extension: known are {known}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The formats and their extensions.
        known: String,
    },
    /// Nothing there.
    #[error("{}: there is no such file", .0.display())]
    Missing(PathBuf),
    /// A directory, or a device.
    #[error("{}: this is {what}, and a volume is a file", path.display())]
    NotAFile {
        /// Where.
        path: PathBuf,
        /// The thing in its place.
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
        /// The system's error.
        source: io::Error,
    },
    /// The file does not hold what its extension promises.
    #[error("{}{separator}{error}", path.display())]
    Contents {
        /// The file.
        path: PathBuf,
        /// Between path and message: a colon, and a space unless the message begins with a line.
        separator: &'static str,
        /// The reader's error.
        error: Box<dyn std::error::Error + Send + Sync>,
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
        /// The other file's error.
        error: Box<VolumeError>,
    },
    /// A cloud, but not with this splatting.
    #[error("{}: {error}", path.display())]
    Splat {
        /// Where.
        path: PathBuf,
        /// The splatting's error.
        error: SplatError,
    },
}

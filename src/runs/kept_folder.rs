//! Folders in which one process leaves files for another, hidden from version control.

use crate::files::atomic_file::WriteError;
use crate::files::own_file;
use crate::files::own_file::FolderError;
use crate::files::partial_file;
use std::path::{Path, PathBuf};

/// A file could not be kept.
#[derive(Debug, thiserror::Error)]
pub enum KeepError {
    /// The folder cannot be made, or something else is in its place.
    #[error("cannot create the folder {}: {error}", folder.display())]
    Folder {
        /// Path.
        folder: PathBuf,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// It cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It cannot be expressed.
    #[error("cannot write {}: {reason}", path.display())]
    Encode {
        /// Path.
        path: PathBuf,
        /// The fault.
        reason: String,
    },
}

impl KeepError {
    pub(crate) fn encode(path: &Path, reason: impl ToString) -> KeepError {
        KeepError::Encode {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }
}

impl From<FolderError> for KeepError {
    fn from(FolderError { folder, error }: FolderError) -> KeepError {
        KeepError::Folder { folder, error }
    }
}

/// The parent of `folder`, and its name, which must not be a link.
pub(crate) fn in_its_folder(folder: &Path) -> (&Path, &Path) {
    match (folder.parent(), folder.file_name()) {
        (Some(parent), Some(name)) => (parent, Path::new(name)),
        _ => (folder, Path::new("")),
    }
}

/// Hides `folder` and its contents from version control.
pub(crate) fn hide(folder: &Path) {
    partial_file::sweep(folder);
    let ignore = folder.join(IGNORE);
    if !ignore.exists() {
        let _ = own_file::write(&ignore, IGNORES_ALL);
    }
}

const IGNORE: &str = ".gitignore";
const IGNORES_ALL: &[u8] = b"*\n";

//! Sealed files, by which one process hands data to another: a hash of the rest, a line of JSON
//! that describes the contents, and the contents. A truncated or changed file is not read.

use super::atomic_file::{WriteError, directory_of};
use super::own_file;
use super::own_file::FolderError;
use super::{partial_file, regular_file};
use serde::Serialize;
use serde::de::DeserializeOwned;
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

/// Largest file read, in bytes: 4 GiB, as of other images.
const MOST_BYTES: u64 = regular_file::MOST_BYTES;

impl From<FolderError> for KeepError {
    fn from(FolderError { folder, error }: FolderError) -> KeepError {
        KeepError::Folder { folder, error }
    }
}

/// Writes the file `inner` of the folder `root` with its header; returns its bytes. Another process
/// may write the same file at once.
pub(crate) fn write(
    root: &Path,
    inner: &Path,
    head: &impl Serialize,
    body: &[u8],
) -> Result<u64, KeepError> {
    let path = root.join(inner);
    let head = serde_json::to_vec(head).map_err(|error| KeepError::encode(&path, error))?;
    own_file::make_folder(root, directory_of(inner))?;
    let rest = [&head[..], b"\n", body].concat();
    let hash = blake3::hash(&rest).to_hex();
    let bytes = [hash.as_bytes(), b"\n", &rest].concat();
    own_file::write(&path, &bytes)?;
    Ok(bytes.len() as u64)
}

/// The parent of `folder`, and its name, which must not be a link.
pub(crate) fn in_its_folder(folder: &Path) -> (&Path, &Path) {
    match (folder.parent(), folder.file_name()) {
        (Some(parent), Some(name)) => (parent, Path::new(name)),
        _ => (folder, Path::new("")),
    }
}

/// Kind and contents that a file states; the reason if it is not as it was written.
pub(crate) fn read<H: DeserializeOwned>(path: &Path) -> Result<(H, Vec<u8>), String> {
    let bytes = regular_file::read(path, MOST_BYTES).map_err(|error| error.to_string())?;
    let damaged = || "it was cut off or changed".to_owned();
    let line = |bytes: &[u8]| bytes.iter().position(|byte| *byte == b'\n');
    let end = line(&bytes).ok_or_else(damaged)?;
    let (hash, rest) = (&bytes[..end], &bytes[end + 1..]);
    if blake3::hash(rest).to_hex().as_bytes() != hash {
        return Err(damaged());
    }
    let end = line(rest).ok_or_else(damaged)?;
    let head = serde_json::from_slice(&rest[..end]);
    let head = head.map_err(|error| format!("another version of volref wrote it: {error}"))?;
    Ok((head, rest[end + 1..].to_vec()))
}

/// Hides `folder` and its contents from version control.
pub(crate) fn hide(folder: &Path) {
    partial_file::sweep(folder);
    let ignore = folder.join(IGNORE);
    if !ignore.exists() {
        let _ = own_file::write(&ignore, IGNORES_ALL);
    }
}

/// Removes `folder` if it is empty but for the file that hides it.
pub(crate) fn remove_if_empty(folder: &Path) {
    let is_hidden = |entry: std::fs::DirEntry| entry.file_name() == IGNORE;
    let only_hidden = |entries: std::fs::ReadDir| entries.flatten().all(is_hidden);
    if !std::fs::read_dir(folder).is_ok_and(only_hidden) {
        return;
    }
    let ignore = folder.join(IGNORE);
    let is_ours = || regular_file::read(&ignore, IGNORES_ALL.len() as u64);
    if own_file::check(&ignore).is_ok() && is_ours().is_ok_and(|text| text == IGNORES_ALL) {
        let _ = std::fs::remove_file(ignore);
    }
    let _ = std::fs::remove_dir(folder);
}

const IGNORE: &str = ".gitignore";
const IGNORES_ALL: &[u8] = b"*\n";

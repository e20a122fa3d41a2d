//! Temporary folders of a process, and the removal of those that killed processes left.
//!
//! A folder holds a file on which its process holds a lock, as on [partial files](super::partial_file): a folder whose
//! file can be locked is nobody's any more. Folders without such a file are not ours.

use super::partial_file::{nobodys, without_temporary_name};
use std::fs::{self, File};
use std::io;
use std::path::Path;
use tempfile::TempDir;

const PREFIX: &str = "volref-";
const LOCK: &str = ".volref-lock";

/// A temporary folder, removed when dropped.
#[derive(Debug)]
pub(crate) struct TemporaryFolder {
    /// Closed before the folder is removed.
    _lock: File,
    folder: TempDir,
}

impl TemporaryFolder {
    /// A new folder in the system's folder for temporary files. Folders of killed processes are removed from there first.
    /// An error does not name the folder.
    pub fn new() -> io::Result<TemporaryFolder> {
        TemporaryFolder::within(&std::env::temp_dir())
    }

    fn within(place: &Path) -> io::Result<TemporaryFolder> {
        sweep(place);
        let mut builder = tempfile::Builder::new();
        let folder = builder.prefix(PREFIX).tempdir_in(place);
        let folder = folder.map_err(without_temporary_name)?;
        // Not seen by others under its name before it is locked.
        let aside = tempfile::NamedTempFile::new_in(folder.path());
        let aside = aside.map_err(without_temporary_name)?;
        // Without locks nobody removes it either.
        let _ = aside.as_file().try_lock();
        let lock = aside.persist(folder.path().join(LOCK))?;
        Ok(TemporaryFolder {
            _lock: lock,
            folder,
        })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Removes the folders of killed processes from `place`. Fails silently.
fn sweep(place: &Path) {
    for entry in fs::read_dir(place).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_named = name.to_str().is_some_and(|name| name.starts_with(PREFIX));
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        let path = entry.path();
        if is_named && is_folder && is_left(&path.join(LOCK)) {
            let _ = fs::remove_dir_all(&path);
        }
    }
}

/// True if `lock` is an empty file of its own that no process holds.
fn is_left(lock: &Path) -> bool {
    let is_ours = |found: fs::Metadata| found.is_file() && found.len() == 0;
    fs::symlink_metadata(lock).is_ok_and(is_ours) && nobodys(lock).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_killed_processes_go_and_nothing_else_does() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        for name in ["volref-mine", "volref-left", "other"] {
            fs::create_dir(at(name)).unwrap();
            fs::write(at(name).join("file"), "").unwrap();
        }
        for name in ["volref-left", "other"] {
            fs::write(at(name).join(LOCK), "").unwrap();
        }
        let held = TemporaryFolder::within(place.path()).unwrap();
        assert!(!at("volref-left").exists());
        let second = TemporaryFolder::within(place.path()).unwrap();
        assert!(held.path().exists() && second.path() != held.path());
        drop(held);
        drop(second);
        let left = fs::read_dir(place.path()).unwrap();
        let mut left: Vec<_> = left.map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        assert_eq!(left, ["other", "volref-mine"]);
    }
}

//! The embedded suite: the files of a checkout within the program, unpacked where they are needed.
//!
//! Scenes name files beside them, and renderers that are run read scenes: both need a folder.

use crate::files::atomic_file::directory_of;
use crate::files::program_hash::hash;
use crate::files::{own_file, partial_file, regular_file};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The files of a suite, held by the program.
#[derive(Clone, Debug)]
pub(crate) struct EmbeddedSuite {
    /// Paths relative to the root of the suite, with the contents.
    files: Vec<(PathBuf, &'static [u8])>,
}

impl EmbeddedSuite {
    /// A suite of these files.
    pub fn new(mut files: Vec<(PathBuf, &'static [u8])>) -> EmbeddedSuite {
        files.sort();
        EmbeddedSuite { files }
    }

    /// Number of files.
    pub fn count(&self) -> usize {
        self.files.len()
    }

    /// Bytes of all files.
    pub fn bytes(&self) -> u64 {
        self.files.iter().map(|(_, bytes)| bytes.len() as u64).sum()
    }

    /// A name that depends on all paths and contents: 16 hexadecimal digits.
    pub fn name(&self) -> String {
        let mut parts: Vec<&[u8]> = Vec::new();
        for (path, bytes) in &self.files {
            parts.extend([path.as_os_str().as_encoded_bytes(), bytes]);
        }
        hash(&parts).chars().take(16).collect()
    }

    /// Paths of all files, relative to the root of the suite.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|(path, _)| path.as_path())
    }

    /// Writes the files below `root`, except those that are there already, each one whole or not at all:
    /// several processes may do so at once. Links below `root` are not followed.
    pub fn unpack(&self, root: &Path) -> io::Result<()> {
        for (inner, bytes) in &self.files {
            let path = root.join(inner);
            let folder = own_file::make_folder(root, directory_of(inner))?;
            let found = || regular_file::read(&path, bytes.len() as u64);
            if own_file::check(&path).is_ok() && found().is_ok_and(|found| found == *bytes) {
                continue;
            }
            // Not synced: whatever a crash leaves is looked at again before it is used.
            let mut file = partial_file::create(&folder)?;
            file.as_file_mut().write_all(bytes)?;
            file.persist(&path)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn suite() -> EmbeddedSuite {
        EmbeddedSuite::new(vec![
            (PathBuf::from("golden/b.exr"), b"two"),
            (PathBuf::from("fixtures/cases/a.toml"), b"one"),
        ])
    }

    #[test]
    fn what_is_changed_or_missing_is_written_again() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("unpacked");
        suite().unpack(&root).unwrap();
        let read = |name: &str| fs::read(root.join(name)).unwrap();
        assert_eq!(read("fixtures/cases/a.toml"), b"one");
        fs::write(root.join("golden/b.exr"), "changed").unwrap();
        fs::remove_file(root.join("fixtures/cases/a.toml")).unwrap();
        suite().unpack(&root).unwrap();
        assert_eq!(read("golden/b.exr"), b"two");
        assert_eq!(read("fixtures/cases/a.toml"), b"one");
        // A file in place of a folder.
        fs::write(folder.path().join("file"), "").unwrap();
        assert!(suite().unpack(&folder.path().join("file")).is_err());
    }

    #[test]
    fn the_name_depends_on_paths_and_contents() {
        let other = |path: &str, bytes| {
            let mut files = suite().files;
            files[0] = (PathBuf::from(path), bytes);
            EmbeddedSuite::new(files).name()
        };
        let name = suite().name();
        assert_eq!(name.len(), 16);
        assert_eq!(other("fixtures/cases/a.toml", b"one"), name);
        assert_ne!(other("fixtures/cases/c.toml", b"one"), name);
        assert_ne!(other("fixtures/cases/a.toml", b"other"), name);
        assert_eq!((suite().count(), suite().bytes()), (2, 6));
    }
}

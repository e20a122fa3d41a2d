//! File operations of the store.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use crate::files::atomic_file::sync_directory;

/// The file operations the store writes with, so that tests can make each of them fail.
///
/// Reading is not among them: a reader uses the standard library, whatever the writer used.
pub trait Disk {
    /// Creates a file that must not exist yet, writes `bytes` and makes them durable. Its name
    /// becomes durable with [`sync_dir`](Disk::sync_dir). On an error part of the file may be
    /// left.
    fn create_synced(&self, path: &Path, bytes: &[u8]) -> io::Result<()>;
    /// Moves a file over another one, or to a new name, in the same directory: a reader sees
    /// the one or the other.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Removes a file.
    fn remove(&self, path: &Path) -> io::Result<()>;
    /// Makes durable which names the directory holds.
    fn sync_dir(&self, directory: &Path) -> io::Result<()>;
    /// Creates one directory whose parent exists; an existing directory is an error.
    fn create_dir(&self, directory: &Path) -> io::Result<()>;
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct RealDisk;

impl Disk for RealDisk {
    fn create_synced(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = File::create_new(path)?;
        file.write_all(bytes)?;
        file.sync_all()
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)
    }

    fn sync_dir(&self, directory: &Path) -> io::Result<()> {
        sync_directory(directory)
    }

    fn create_dir(&self, directory: &Path) -> io::Result<()> {
        fs::create_dir(directory)
    }
}

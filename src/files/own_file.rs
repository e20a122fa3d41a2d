//! Files and folders that volref names itself, within a suite, a cache or a folder for outputs. A link, a pipe
//! or anything else in their place is refused: neither followed nor waited for.

use super::atomic_file::{WriteError, untouched, write_in_place_of};
use super::golden_mark;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// `error`, with the folder that it is about.
fn in_folder(folder: &Path) -> impl Fn(io::Error) -> io::Error {
    let folder = folder.display().to_string();
    move |error| {
        let cause = match error.kind() {
            ErrorKind::AlreadyExists => {
                "a file stands in its place: choose another folder".to_owned()
            }
            _ => error.to_string(),
        };
        let message = format!("cannot create the folder {folder}: {cause}");
        io::Error::new(error.kind(), message)
    }
}

/// Replaces the file at `path` by `bytes`, or creates it, whole or not at all. The stricter sibling of
/// [`write_atomically`](crate::files::atomic_file::write_atomically), which follows links and writes into pipes.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    check(path).map_err(untouched("write", path))?;
    write_in_place_of(path, bytes)
}

/// Removes the file or link at `path`, if there is one, unless it is a golden.
pub(crate) fn remove(path: &Path) -> io::Result<()> {
    golden_mark::check(path)?;
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Fails where something other than a regular file is at `path`; succeeds where nothing is.
pub(crate) fn check(path: &Path) -> io::Result<()> {
    is_there(path, FILE).map(|_| ())
}

/// Creates the folder `inner` of `root`, and those between, which have to be folders and no links. `root`
/// itself may be a link: it is the user's.
pub(crate) fn make_folder(root: &Path, inner: &Path) -> io::Result<PathBuf> {
    fs::create_dir_all(root).map_err(in_folder(root))?;
    for folder in folders(root, inner) {
        if is_there(&folder, FOLDER).map_err(in_folder(&folder))? {
            continue;
        }
        match fs::create_dir(&folder) {
            // Another process came first.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                is_there(&folder, FOLDER).map_err(in_folder(&folder))?;
            }
            result => result.map_err(in_folder(&folder))?,
        }
    }
    Ok(root.join(inner))
}

/// Fails where [`make_folder`] would find something in the place of a folder.
pub(crate) fn check_folder(root: &Path, inner: &Path) -> io::Result<()> {
    for folder in folders(root, inner) {
        if !is_there(&folder, FOLDER).map_err(in_folder(&folder))? {
            break;
        }
    }
    Ok(())
}

/// The folders from below `root` down to `inner`.
fn folders(root: &Path, inner: &Path) -> impl Iterator<Item = PathBuf> {
    let parts = inner.components();
    parts.scan(root.to_owned(), |folder, part| {
        folder.push(part);
        Some(folder.clone())
    })
}

fn is_there(path: &Path, wanted: &str) -> io::Result<bool> {
    let found = match fs::symlink_metadata(path) {
        Ok(found) => found,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
        Err(error) => return Err(error),
    };
    let what = match () {
        () if found.is_symlink() => "a symbolic link",
        () if found.is_dir() => FOLDER,
        () if found.is_file() => FILE,
        () => "a device or pipe",
    };
    if what == wanted {
        return Ok(true);
    }
    let message = format!("this is {what}, not {wanted}: move it away");
    Err(io::Error::other(message))
}

const FILE: &str = "a file";
const FOLDER: &str = "a folder";

//! Reads regular files only, never beyond a size limit, and remembers which ones, so that no output
//! is written over an input. Where something stands in place of a file, such as a pointer of Git LFS, the error says so.

use super::file_kind::{HEAD, stand_in};
use std::collections::HashSet;
use std::fs::{File, Metadata};
use std::io::{self, Read, Seek};
use std::path::Path;
use std::sync::{LazyLock, Mutex, PoisonError};
use thiserror::Error;

/// Largest file that is read unless a caller has a lower limit, in bytes: 4 GiB.
pub const MOST_BYTES: u64 = 1 << 32;

/// Errors in reading a file.
#[derive(Debug, Error)]
pub(crate) enum ReadError {
    /// Nothing is at the path.
    #[error("{0}")]
    Missing(io::Error),
    /// Not a regular file; with the kind found.
    #[error("this is {0}, not a file")]
    NotAFile(&'static str),
    /// Something else in place of the content; with what it is, and the remedy.
    #[error("{0}")]
    StandIn(String),
    /// Refused by the operating system.
    #[error("{0}")]
    Refused(io::Error),
    /// The file is larger than the limit.
    #[error("the file has {bytes} bytes; at most {most} are read")]
    TooLarge {
        /// Bytes in the file, or at least as many.
        bytes: u64,
        /// Bytes accepted.
        most: u64,
    },
}

impl ReadError {
    fn of(error: io::Error) -> ReadError {
        match error.kind() {
            io::ErrorKind::NotFound => ReadError::Missing(error),
            _ => ReadError::Refused(error),
        }
    }
}

impl From<ReadError> for io::Error {
    fn from(error: ReadError) -> io::Error {
        let kind = match error {
            ReadError::Missing(error) | ReadError::Refused(error) => return error,
            ReadError::NotAFile(_) | ReadError::StandIn(_) => io::ErrorKind::Other,
            ReadError::TooLarge { .. } => io::ErrorKind::FileTooLarge,
        };
        io::Error::new(kind, error.to_string())
    }
}

/// Opens a regular file for reading; with its length in bytes. Refuses what stands in place of its content.
pub fn open(path: &Path) -> Result<(File, u64), ReadError> {
    let (mut file, length) = open_any(path)?;
    let first = first_bytes(&mut file).map_err(ReadError::of)?;
    match stand_in(&first) {
        Some(what) => Err(ReadError::StandIn(what)),
        None => Ok((file, length)),
    }
}

/// The first bytes of a file, which is left at its beginning.
fn first_bytes(file: &mut File) -> io::Result<Vec<u8>> {
    let mut first = Vec::new();
    file.take(HEAD as u64).read_to_end(&mut first)?;
    file.rewind()?;
    Ok(first)
}

/// The first bytes of the file at `path`, if there is a regular one.
pub fn first_bytes_of(path: &Path) -> Option<Vec<u8>> {
    let (mut file, _) = open_any(path).ok()?;
    first_bytes(&mut file).ok()
}

/// As [`open`], whatever the file holds. Never waits: a named pipe without a writer would be waited for, and a
/// device may never end.
fn open_any(path: &Path) -> Result<(File, u64), ReadError> {
    let (file, metadata) = open_unnoted(path)?;
    remember(path, &metadata);
    Ok((file, metadata.len()))
}

fn open_unnoted(path: &Path) -> Result<(File, Metadata), ReadError> {
    check_kind(path)?;
    let file = File::open(path).map_err(ReadError::of)?;
    let metadata = file.metadata().map_err(ReadError::of)?;
    Ok((file, metadata))
}

/// Fails where no regular file is at `path`. Called before opening, as opening a named pipe waits
/// for its other end.
fn check_kind(path: &Path) -> Result<(), ReadError> {
    match std::fs::metadata(path).map_err(ReadError::of)? {
        found if found.is_file() => Ok(()),
        found if found.is_dir() => Err(ReadError::NotAFile("a directory")),
        _ => Err(ReadError::NotAFile("a device or pipe")),
    }
}

/// All bytes of a regular file that has at most `most` of them.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    read_from(open(path)?, most)
}

/// As [`read`], whatever the file holds: it is hashed, not read for what it says.
pub fn read_any(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    read_from(open_any(path)?, most)
}

/// As [`read_any`], of a file that an output may take the place of: it counts as no input.
pub fn read_unnoted(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    let (file, metadata) = open_unnoted(path)?;
    read_from((file, metadata.len()), most)
}

fn read_from((file, length): (File, u64), most: u64) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    if length <= most {
        // A file may grow while it is read, and some of the system's say that they are empty.
        let read = file.take(most.saturating_add(1)).read_to_end(&mut bytes);
        read.map_err(ReadError::of)?;
    }
    match length.max(bytes.len() as u64) {
        bytes if bytes > most => Err(ReadError::TooLarge { bytes, most }),
        _ => Ok(bytes),
    }
}

/// Identity of a file, the same by all names and links.
#[cfg(unix)]
type Identity = (u64, u64);
/// On other systems the path without links: hard links count as two files.
#[cfg(not(unix))]
type Identity = std::path::PathBuf;

#[cfg(unix)]
fn identity(_: &Path, metadata: &Metadata) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path, _: &Metadata) -> Option<Identity> {
    path.canonicalize().ok()
}

/// Identity of the file or folder at `path`, if there is one.
pub fn identity_of(path: &Path) -> Option<Identity> {
    identity(path, &std::fs::metadata(path).ok()?)
}

/// The inputs of this process.
static INPUTS: LazyLock<Mutex<HashSet<Identity>>> = LazyLock::new(Mutex::default);

fn remember(path: &Path, metadata: &Metadata) {
    if let Some(identity) = identity(path, metadata) {
        let mut inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
        inputs.insert(identity);
    }
}

/// Counts the file at `path` among the inputs no more: it is ours and will be removed, and another file may get its number.
pub fn forget(path: &Path) {
    let mut inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(identity) = identity_of(path) {
        inputs.remove(&identity);
    }
}

/// Counts the file at `path` among the inputs before it is read, if there is one.
pub fn note_input(path: &Path) {
    if let Ok(metadata) = std::fs::metadata(path)
        && metadata.is_file()
    {
        remember(path, &metadata);
    }
}

/// True if the file at `path` was read by this process, or noted as an input, under any name.
pub fn is_input(path: &Path) -> bool {
    let inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    identity_of(path).is_some_and(|identity| inputs.contains(&identity))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_up_to_their_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        std::fs::write(&path, b"12345").unwrap();
        assert_eq!(read(&path, 5).unwrap(), b"12345");
        let error = read(&path, 4).unwrap_err().to_string();
        assert_eq!(error, "the file has 5 bytes; at most 4 are read");
        let error = read(folder.path(), 5).unwrap_err().to_string();
        assert_eq!(error, "this is a directory, not a file");
        assert!(matches!(
            read(&folder.path().join("nothing"), 5),
            Err(ReadError::Missing(_))
        ));
    }

    #[cfg(unix)]
    #[test]
    fn inputs_are_known_by_every_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("file"), b"").unwrap();
        std::fs::write(at("other"), b"").unwrap();
        std::fs::hard_link(at("file"), at("hard")).unwrap();
        std::os::unix::fs::symlink("file", at("soft")).unwrap();
        read(&at("soft"), 5).unwrap();
        for name in ["file", "hard", "soft", "./file"] {
            assert!(is_input(&at(name)), "{name}");
        }
        assert!(!is_input(&at("nothing")));
        note_input(&at("other"));
        assert!(is_input(&at("other")));
    }

    /// Files that never end: the limit is what ends the reading.
    #[cfg(target_os = "linux")]
    #[test]
    fn files_that_say_they_are_empty() {
        let text = read(Path::new("/proc/self/status"), 1 << 20).unwrap();
        assert!(text.starts_with(b"Name:"));
        assert!(matches!(
            read(Path::new("/proc/self/status"), 8),
            Err(ReadError::TooLarge { most: 8, .. })
        ));
        for pipe in ["/dev/zero", "/dev/null"] {
            let error = read(Path::new(pipe), 8).unwrap_err().to_string();
            assert_eq!(error, "this is a device or pipe, not a file");
        }
    }
}

//! Opening what may turn out to be no file.

use std::fs::File;
use std::io;
use std::path::Path;

/// Why nothing was opened.
#[derive(Debug)]
pub enum OpenError {
    /// Nothing there.
    Missing(io::Error),
    /// Not a regular file: what is there instead.
    NotAFile(&'static str),
    /// The system refuses.
    Refused(io::Error),
}

/// Opens a regular file for reading, and tells its length in bytes. Never waits: a named pipe
/// without a writer would be waited for, and a device may never end.
pub fn open(path: &Path) -> Result<(File, u64), OpenError> {
    let trouble = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound => OpenError::Missing(error),
        _ => OpenError::Refused(error),
    };
    // Before opening: to open a named pipe is to wait for a writer.
    let metadata = std::fs::metadata(path).map_err(trouble)?;
    if !metadata.is_file() {
        return Err(OpenError::NotAFile(if metadata.is_dir() {
            "a directory"
        } else {
            "a device or pipe"
        }));
    }
    let file = File::open(path).map_err(trouble)?;
    Ok((file, metadata.len()))
}

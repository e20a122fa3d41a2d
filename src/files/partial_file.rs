//! Files written aside, and the removal of those that a killed process left.
//!
//! The writer holds a lock on it, which the system releases when the process ends, however it
//! ends: a file that can be locked is nobody's any more. Numbers of processes would not do, since they
//! mean nothing in another container or on another machine, and no age tells a slow writer from a dead one.
//! Where files cannot be locked, none is removed.

use std::collections::HashSet;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};
use tempfile::NamedTempFile;

const PREFIX: &str = ".volref-";
const SUFFIX: &str = ".partial";
/// Random letters between the two.
const LETTERS: usize = 6;

/// An empty file in `directory`, to be written and renamed; removed when dropped before that.
/// Partial files of killed processes are removed first. An error does not name the file.
pub(crate) fn create(directory: &Path) -> io::Result<NamedTempFile> {
    sweep(directory);
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX).rand_bytes(LETTERS);
    // tempfile's own choice is 0600, private to the user; the umask applies to this one.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    const ATTEMPTS: usize = 16;
    for _ in 0..ATTEMPTS {
        let file = builder
            .tempfile_in(directory)
            .map_err(without_temporary_name)?;
        if is_held(&file) {
            return Ok(file);
        }
    }
    Err(io::Error::other("files written aside are removed at once"))
}

/// The system's own error, where tempfile has put the random name of its file or folder into the message: that name
/// means nothing to the user.
pub(crate) fn without_temporary_name(error: io::Error) -> io::Error {
    let inner = error.get_ref().and_then(|error| error.source());
    let code = inner
        .and_then(|error| error.downcast_ref::<io::Error>())
        .and_then(io::Error::raw_os_error);
    code.map_or(error, io::Error::from_raw_os_error)
}

/// Locks a file just created: `false` if another process removed it as a leftover before it was
/// locked.
fn is_held(file: &NamedTempFile) -> bool {
    // Elsewhere a lock would keep readers off the file under its final name, too.
    if !cfg!(unix) {
        return true;
    }
    match file.as_file().try_lock() {
        Err(TryLockError::WouldBlock) => false,
        // Without locks nobody removes it either.
        Ok(()) | Err(TryLockError::Error(_)) => fs::symlink_metadata(file.path()).is_ok(),
    }
}

/// Removes the partial files of killed processes from `directory`, once for each process. Fails
/// silently.
pub(crate) fn sweep(directory: &Path) {
    static SWEPT: LazyLock<Mutex<HashSet<PathBuf>>> = LazyLock::new(Mutex::default);
    let mut swept = SWEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if !cfg!(unix) || !swept.insert(directory.to_owned()) {
        return;
    }
    drop(swept);
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && entry.file_name().to_str().is_some_and(is_partial) {
            let path = entry.path();
            // Held until the file is gone, so that whoever locks it afterwards sees that it is.
            if let Some(_held) = nobodys(&path) {
                let _ = fs::remove_file(&path);
            }
        }
    }
}

/// The file at `path`, if no process holds it. It is held until it is dropped.
pub(crate) fn nobodys(path: &Path) -> Option<File> {
    let file = File::open(path).ok()?;
    file.try_lock().is_ok().then_some(file)
}

fn is_partial(name: &str) -> bool {
    let random = name.strip_prefix(PREFIX);
    let random = random.and_then(|rest| rest.strip_suffix(SUFFIX));
    random.is_some_and(|random| {
        random.len() == LETTERS && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
    })
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn left_files_go_and_nothing_else_does() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let kept = [
            ".volref-abcdef.partial.exr",
            ".volref-abcdefg.partial",
            ".volref-abc.ef.partial",
            "volref-abcdef.partial",
        ];
        for name in kept {
            fs::write(at(name), "mine").unwrap();
        }
        fs::write(at(".volref-Left00.partial"), "cut off").unwrap();
        fs::create_dir(at(".volref-folder.partial")).unwrap();
        symlink(kept[0], at(".volref-link00.partial")).unwrap();
        let held = File::create(at(".volref-Held00.partial")).unwrap();
        held.lock().unwrap();

        let file = create(folder.path()).unwrap();
        assert!(is_partial(
            file.path().file_name().unwrap().to_str().unwrap()
        ));
        assert!(!at(".volref-Left00.partial").exists());
        assert!(at(".volref-Held00.partial").exists());
        assert!(at(".volref-folder.partial").is_dir());
        assert!(at(".volref-link00.partial").is_symlink());
        assert!(kept.iter().all(|name| at(name).exists()));
        // The file just created is held as well.
        assert!(File::open(file.path()).unwrap().try_lock().is_err());
    }
}

//! An output file that is either the old one or the complete new one.

use std::fs::{self, File, Metadata};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::{golden_mark, partial_file};

/// An output could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {cause}{kept}; {}", path.display(), remedy(cause.kind()))]
pub struct WriteError {
    /// The action, as a verb phrase: "write", "replace", …
    pub action: &'static str,
    /// File or directory of the action.
    pub path: PathBuf,
    /// Error of the operating system.
    pub cause: io::Error,
    /// State of the file that was there before, as the end of a sentence.
    kept: &'static str,
}

/// Replaces the file at `path` by `bytes`, or creates it.
///
/// The bytes are written to a temporary file in the same directory, synced and renamed, so a
/// reader sees the old file or all of the new one, also after a crash. On an error the
/// temporary file is removed and the old file stays. A process that is killed leaves it to the next
/// one that writes there.
///
/// - An existing file passes its permission bits on; a new one gets those that the umask
///   leaves. Owner, hard links and extended attributes of an existing file are not kept.
/// - A symbolic link stays, and the file it points to is replaced.
/// - A golden stays: only `volref accept` changes it.
/// - A device, a pipe, a FIFO or `/dev/stdout`, wherever it leads, must not be replaced by a file. It is written to
///   directly, without atomicity.
///
/// # Errors
///
/// [`WriteError`] names the file, what the operating system said and how to mend it. Missing
/// directories are an error, not created.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    match destination(path).map_err(untouched("look at", path))? {
        None => write_to_stream(path, bytes).map_err(failed("write to", path, "")),
        Some(target) => replace(path, &target, bytes),
    }
}

/// Replaces the file or link at `path`, as [`write_atomically`] does, but without following the
/// link.
pub(crate) fn write_in_place_of(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    replace(path, path, bytes)
}

/// Replaces the file `target`, which messages call `path`.
fn replace(path: &Path, target: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let failed = |action| untouched(action, path);
    golden_mark::check(target).map_err(failed("write"))?;
    let directory = directory_of(target);
    let mut aside =
        partial_file::create(directory).map_err(failed("create a temporary file beside"))?;
    // By the file itself: tempfile's own writer puts the temporary name into an error.
    (aside.as_file_mut().write_all(bytes)).map_err(failed("write"))?;
    if let Ok(existing) = fs::metadata(target) {
        let passed_on = aside.as_file().set_permissions(existing.permissions());
        passed_on.map_err(failed("pass on the permissions of"))?;
    }
    aside.as_file().sync_all().map_err(failed("write"))?;
    (aside.persist(target).map_err(|error| error.error)).map_err(failed("replace"))?;
    let in_place = " (the new file is in place, but might not survive a power cut)";
    sync_directory(directory).map_err(self::failed("sync the directory", directory, in_place))
}

const KEPT: &str = " (whatever was there before is untouched)";

/// The failure of an action before anything was changed.
pub(crate) fn untouched(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> WriteError {
    failed(action, path, KEPT)
}

fn failed(
    action: &'static str,
    path: &Path,
    kept: &'static str,
) -> impl FnOnce(io::Error) -> WriteError {
    let path = path.to_path_buf();
    move |cause| WriteError {
        action,
        path,
        cause,
        kept,
    }
}

/// The regular file, existing or not, that [`write_atomically`] would write for `path`; nothing
/// for a stream.
pub(crate) fn file_behind(path: &Path) -> Option<PathBuf> {
    destination(path).ok().flatten()
}

/// The file that is written for `path`, with symbolic links followed; nothing for a stream, which is written through.
///
/// Links are followed by hand: `canonicalize` would refuse a link to a file that does not
/// exist yet, and would lead from `/dev/stdout` to the file the shell redirected it to.
fn destination(path: &Path) -> io::Result<Option<PathBuf>> {
    match fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() => return Ok(None),
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    let mut target = path.to_path_buf();
    const MOST_LINKS: usize = 40; // as Linux
    for _ in 0..MOST_LINKS {
        // An open descriptor under the name of a file. To replace that file would cut off
        // whoever else holds the descriptor.
        if target.starts_with("/proc") || target.starts_with("/dev/fd") {
            return Ok(None);
        }
        if !fs::symlink_metadata(&target).is_ok_and(|metadata: Metadata| metadata.is_symlink()) {
            return Ok(Some(target));
        }
        target = directory_of(&target).join(fs::read_link(&target)?);
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Appends: opening a redirected standard output must not cut off what is already there.
fn write_to_stream(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut stream = File::options().append(true).open(path)?;
    stream.write_all(bytes)?;
    stream.flush()
}

/// The directory a file is in; `.` for a bare file name, whose `parent` is empty.
pub(crate) fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Makes the names in a directory durable: files created, renamed and removed there.
pub(crate) fn sync_directory(directory: &Path) -> io::Result<()> {
    // Elsewhere a directory cannot be opened as a file, and the file system orders its own log.
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(directory)?.sync_all() {
        Err(error) => match error.kind() {
            // Some network and user-space file systems do not know the operation.
            ErrorKind::InvalidInput | ErrorKind::Unsupported => Ok(()),
            _ => Err(error),
        },
        done => done,
    }
}

/// Advice to the user about a failed file operation.
pub(crate) fn remedy(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "free some space and run the same command again"
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "make the directory and the file writable and run the same command again"
        }
        ErrorKind::NotFound => "create the directory and run the same command again",
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists => {
            "move the file that stands in the place of a directory, or choose another path"
        }
        ErrorKind::IsADirectory => "move that directory, or choose another path",
        ErrorKind::InvalidFilename => "choose a shorter or simpler name",
        ErrorKind::BrokenPipe => "the program reading the output stopped; check it",
        _ => "mend that and run the same command again",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn creates_and_replaces_without_leaving_anything_aside() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("image.exr");
        write_atomically(&path, b"old").unwrap();
        write_atomically(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(directory.path()), ["image.exr"]);
    }

    #[test]
    fn a_missing_directory_is_named_with_a_remedy() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("missing").join("image.exr");
        let message = write_atomically(&path, b"new").unwrap_err().to_string();
        assert!(message.contains("missing"), "{message}");
        assert!(message.contains("create the directory"), "{message}");
    }

    #[test]
    fn a_file_in_the_place_of_the_directory_is_an_error() {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("plain"), b"kept").unwrap();
        let error = write_atomically(&directory.path().join("plain/image.exr"), b"new");
        assert_eq!(error.unwrap_err().cause.kind(), ErrorKind::NotADirectory);
        assert_eq!(fs::read(directory.path().join("plain")).unwrap(), b"kept");
    }

    #[test]
    fn a_directory_is_not_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let error = write_atomically(directory.path(), b"new").unwrap_err();
        assert_eq!(error.cause.kind(), ErrorKind::IsADirectory);
        assert!(names(directory.path()).is_empty());
    }

    #[cfg(unix)]
    mod unix {
        use super::*;
        use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};

        fn mode(path: &Path) -> u32 {
            fs::metadata(path).unwrap().permissions().mode() & 0o7777
        }

        #[test]
        fn a_new_file_obeys_the_umask() {
            let directory = tempfile::tempdir().unwrap();
            let ordinary = directory.path().join("ordinary");
            File::create(&ordinary).unwrap();
            let path = directory.path().join("image.exr");
            write_atomically(&path, b"new").unwrap();
            assert_eq!(mode(&path), mode(&ordinary));
        }

        #[test]
        fn an_existing_file_passes_its_permissions_on() {
            let directory = tempfile::tempdir().unwrap();
            let path = directory.path().join("image.exr");
            fs::write(&path, b"old").unwrap();
            fs::set_permissions(&path, PermissionsExt::from_mode(0o664)).unwrap();
            write_atomically(&path, b"new").unwrap();
            assert_eq!(mode(&path), 0o664);
        }

        #[test]
        fn links_stay_whether_or_not_they_dangle() {
            let directory = tempfile::tempdir().unwrap();
            let (file, link) = (directory.path().join("file"), directory.path().join("link"));
            symlink("file", &link).unwrap();
            for contents in [b"dangling", b"existing"] {
                write_atomically(&link, contents).unwrap();
                assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
                assert_eq!(fs::read(&file).unwrap(), contents);
            }
        }

        #[test]
        fn a_ring_of_links_is_an_error() {
            let directory = tempfile::tempdir().unwrap();
            let link = directory.path().join("link");
            symlink("link", &link).unwrap();
            assert!(write_atomically(&link, b"new").is_err());
        }

        #[test]
        fn a_device_stays_a_device() {
            write_atomically(Path::new("/dev/null"), b"gone").unwrap();
            assert!(
                fs::metadata("/dev/null")
                    .unwrap()
                    .file_type()
                    .is_char_device()
            );
        }

        #[test]
        fn a_fifo_is_written_through() {
            let directory = tempfile::tempdir().unwrap();
            let fifo = directory.path().join("fifo");
            let made = std::process::Command::new("mkfifo")
                .arg(&fifo)
                .status()
                .unwrap();
            assert!(made.success());
            let reader = std::thread::spawn({
                let fifo = fifo.clone();
                move || fs::read(fifo).unwrap()
            });
            write_atomically(&fifo, b"through").unwrap();
            assert_eq!(reader.join().unwrap(), b"through");
            assert!(fs::metadata(&fifo).unwrap().file_type().is_fifo());
        }

        /// A shell's `{ echo before; volref … --out /dev/stdout; } > file`.
        #[cfg(target_os = "linux")]
        #[test]
        fn an_open_descriptor_is_written_through() {
            use std::os::fd::AsRawFd;
            let directory = tempfile::tempdir().unwrap();
            let path = directory.path().join("file");
            let mut held = File::create(&path).unwrap();
            held.write_all(b"before ").unwrap();
            let descriptor = PathBuf::from(format!("/proc/self/fd/{}", held.as_raw_fd()));
            write_atomically(&descriptor, b"image").unwrap();
            assert_eq!(fs::read(&path).unwrap(), b"before image");
        }
    }
}

//! Atomic storage of goldens: many files are replaced as one, even if the process is killed
//! meanwhile.
//!
//! Several renames are not atomic, one is. An accept writes all its files into the folder
//! `.accept-new`, laid out as the goldens are, and renames it to `.accept`: **this decides**. Then
//! it moves the files to their places, and removes the folder.
//!
//! A file in `.accept` is read instead of the one in its place: readers see all old files before the
//! decision and all new ones after it, and never have to write for that. The next accept moves
//! what it finds in `.accept`, and removes `.accept-new`.

#[cfg(test)]
mod tests;

use crate::files::atomic_file::{WriteError, directory_of, remedy, sync_directory, untouched};
use crate::files::regular_file::ReadError;
use crate::files::{own_file, regular_file};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Goldens could not be read or replaced.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Reading failed, for another reason than that there is no such file.
    #[error("cannot read {}: {cause}; {}", path.display(), remedy(cause.kind()))]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        cause: io::Error,
    },
    /// Readers see what they saw before.
    #[error(transparent)]
    Untouched(#[from] WriteError),
    /// Readers see all new files, but some are not yet in their places.
    #[error(
        "cannot move the new goldens to their places below {}: {cause}; they are all recorded and `verify` \
         sees them, the next `accept` moves them: {}", root.display(), remedy(cause.kind())
    )]
    Unfinished {
        /// The folder of goldens.
        root: PathBuf,
        /// Error of the operating system.
        cause: io::Error,
    },
}

/// The file that is locked by who writes.
const LOCK: &str = ".lock";
/// The folder of an accept that is not decided.
const NEW: &str = ".accept-new";
/// The folder of an accept that is decided.
const DECIDED: &str = ".accept";

/// Hides the lock file from version control, in a folder that the store has made.
const IGNORES_LOCK: &[u8] = b"/.lock\n";

/// Largest file read, in bytes: 1 GiB, eight channels of 32 bits of 5792² pixels.
const MOST_BYTES: u64 = 1 << 30;

/// Storage of goldens, and the only code that writes them.
#[derive(Clone, Debug)]
pub struct Store {
    root: PathBuf,
}

impl Store {
    /// The goldens under `root`, a directory that need not exist. Touches no file.
    pub fn open(root: impl Into<PathBuf>) -> Store {
        Store { root: root.into() }
    }

    /// Contents that a reader sees now at `relative`, a path under the root; `None` if there is no
    /// such file. Files that belong together are to be read by [`read_all`](Self::read_all).
    pub fn read(&self, relative: &Path) -> Result<Option<Vec<u8>>, StoreError> {
        // In this order: a file on its way from the first to the second is found.
        match read_if_present(self.root.join(DECIDED).join(relative))? {
            None => read_if_present(self.root.join(relative)),
            found => Ok(found),
        }
    }

    /// Contents that a reader sees at all these paths at one moment, in their order: never some
    /// files from before an accept and some from after it, even if it runs meanwhile.
    pub fn read_all<P: AsRef<Path>>(
        &self,
        relative: &[P],
    ) -> Result<Vec<Option<Vec<u8>>>, StoreError> {
        let read = || relative.iter().map(|path| self.read(path.as_ref()));
        let mut before = read().collect::<Result<Vec<_>, _>>()?;
        loop {
            // Twice the same: no accept came between.
            let contents = read().collect::<Result<Vec<_>, _>>()?;
            if contents == before {
                return Ok(contents);
            }
            before = contents;
        }
    }

    /// Replaces or creates all files at once; a path is relative to the root, its directories
    /// are created. After a crash at any moment readers see all of the old files or all of the
    /// new ones. First completes or undoes an accept that was interrupted earlier; with no files
    /// it does only that. Waits while another accept writes.
    ///
    /// Leaves `.lock` in the root: the operating system releases the lock when its process
    /// ends, however it ends, so the file being there means nothing.
    pub fn publish<P: AsRef<Path>>(&self, files: &[(P, Vec<u8>)]) -> Result<(), StoreError> {
        let _lock = self.lock()?;
        let (new, decided) = (self.root.join(NEW), self.root.join(DECIDED));
        let failed = |path| untouched("write", path);
        if fs::symlink_metadata(&decided).is_ok() {
            self.install(Path::new("")).map_err(failed(&decided))?;
        }
        if fs::symlink_metadata(&new).is_ok() {
            fs::remove_dir_all(&new).map_err(failed(&new))?;
        }
        if files.is_empty() {
            return Ok(());
        }
        let staged = self.stage(files);
        let decision = staged.and_then(|()| fs::rename(&new, &decided).map_err(failed(&decided)));
        if let Err(error) = decision {
            // Where this fails, the next accept does it.
            let _ = fs::remove_dir_all(&new);
            return Err(error.into());
        }
        let root = self.root.clone();
        (self.install(Path::new(""))).map_err(|cause| StoreError::Unfinished { root, cause })
    }

    fn lock(&self) -> Result<File, WriteError> {
        let (lock, is_new) = (self.root.join(LOCK), !self.root.exists());
        let locked = || {
            // A link there would lead out of the suite.
            let name = Path::new(self.root.file_name().unwrap_or(OsStr::new("")));
            own_file::make_folder(directory_of(&self.root), name)?;
            // To open a named pipe for writing is to wait for its reader.
            own_file::check(&lock)?;
            let mut options = File::options();
            let file = options.create(true).truncate(false).write(true);
            let file = file.open(&lock)?;
            file.lock().map(|()| file)
        };
        let file = locked().map_err(untouched("lock", &lock))?;
        if is_new {
            // For version control, as a courtesy: a folder of the user's is left as it is.
            let _ = own_file::write(&self.root.join(".gitignore"), IGNORES_LOCK);
        }
        Ok(file)
    }

    /// Writes all files aside, durably.
    fn stage<P: AsRef<Path>>(&self, files: &[(P, Vec<u8>)]) -> Result<(), WriteError> {
        let mut folders = BTreeSet::new();
        for (path, bytes) in files {
            let (path, target) = (path.as_ref(), self.root.join(path));
            let staged = Path::new(NEW).join(path);
            let prepare = || {
                // A move would find it out only after the decision.
                own_file::check(&target)?;
                own_file::check_folder(&self.root, directory_of(path))?;
                own_file::make_folder(&self.root, directory_of(&staged))
            };
            prepare().map_err(untouched("write", &target))?;
            own_file::write(&self.root.join(&staged), bytes)?;
            folders.extend(
                staged
                    .ancestors()
                    .skip(1)
                    .map(|folder| self.root.join(folder)),
            );
        }
        folders
            .iter()
            .try_for_each(|folder| sync_directory(folder).map_err(untouched("sync", folder)))
    }

    /// Moves what is in the folder `inner` of the decided accept to its place, and removes this folder.
    fn install(&self, inner: &Path) -> io::Result<()> {
        // The decision must be durable before the first file depends on it.
        sync_directory(&self.root)?;
        own_file::check_folder(&self.root, &Path::new(DECIDED).join(inner))?;
        let from = self.root.join(DECIDED).join(inner);
        let to = own_file::make_folder(&self.root, inner)?;
        for entry in fs::read_dir(&from)? {
            let entry = entry?;
            match entry.file_type()?.is_dir() {
                true => self.install(&inner.join(entry.file_name()))?,
                false => fs::rename(entry.path(), to.join(entry.file_name()))?,
            }
        }
        sync_directory(&to)?;
        fs::remove_dir(&from)
    }
}

fn read_if_present(path: PathBuf) -> Result<Option<Vec<u8>>, StoreError> {
    match regular_file::read(&path, MOST_BYTES) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(ReadError::Missing(_)) => Ok(None),
        Err(error) => {
            let cause = error.into();
            Err(StoreError::Read { path, cause })
        }
    }
}

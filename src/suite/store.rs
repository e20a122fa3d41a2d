//! Atomic storage of goldens: many files are replaced as one, even if the process is killed
//! meanwhile.
//!
//! Several renames are not atomic, one is. So an accept goes through these steps, each durable
//! before the next begins:
//!
//! 1. a *draft* lists the files to be replaced;
//! 2. the new files are written aside (*staged*), each in its own directory;
//! 3. the draft is renamed to `accept.journal`: **this decides**;
//! 4. the staged files are renamed over the old ones;
//! 5. the journal is removed.
//!
//! While there is a journal, a file it lists is read from where it is staged or, once renamed,
//! from its place: readers see all old files before step 3 and all new ones after it, and never
//! have to write for that. The next accept completes what it finds: a journal is carried through
//! from step 4; a draft is undone, which removes exactly the files it lists. A draft that
//! was cut off was being written, so nothing was staged yet.

mod disk;
mod error;
mod journal;
mod name;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use crate::files::atomic_file::directory_of;
use crate::files::own_file;
use crate::files::regular_file;
use crate::files::regular_file::ReadError;
use journal::{Journal, JournalEntry};
use name::{DRAFT, JOURNAL, LOCK, StoreName};

pub use disk::{Disk, RealDisk};
pub use error::{StoreError, StoreFailure};

/// Storage of goldens, and the only code that writes them.
#[derive(Clone, Debug)]
pub struct Store<D: Disk = RealDisk> {
    root: PathBuf,
    disk: D,
}

impl Store {
    /// The goldens under `root`, a directory that need not exist. Touches no file.
    pub fn open(root: impl Into<PathBuf>) -> Store {
        Store::on_disk(root, RealDisk)
    }
}

/// What hides the lock file from version control, in a folder that the store has made.
const IGNORES_LOCK: &[u8] = b"/.lock\n";

/// Time for which another accept is waited for: writing the goldens of a whole suite takes a second or two.
const PATIENCE: Duration = Duration::from_secs(if cfg!(test) { 0 } else { 60 });

/// Time between two attempts.
const PAUSE: Duration = Duration::from_millis(20);

/// Reading. None of these functions writes, locks or creates anything.
impl<D: Disk> Store<D> {
    /// Contents that a reader sees now at `relative`, a path under the root; `None` if there is no
    /// such file. Files that belong together are to be read by [`read_all`](Self::read_all).
    ///
    /// # Errors
    ///
    /// [`StoreError::Name`] for a path that leaves the root, [`Read`](StoreError::Read) if the
    /// operating system refuses, [`Journal`](StoreError::Journal) and
    /// [`Lost`](StoreError::Lost) if the traces of an interrupted accept were changed by hand.
    pub fn read(&self, relative: &Path) -> Result<Option<Vec<u8>>, StoreError> {
        let name = name(relative)?;
        loop {
            let journal = self.journal()?;
            let Some((journal, entry)) = journal
                .as_ref()
                .and_then(|journal| Some((journal, journal.entry(&name)?)))
            else {
                return read_if_present(&name.under(&self.root));
            };
            if let Some(bytes) = self.recorded(journal, entry)? {
                return Ok(Some(bytes));
            }
            // Either something is wrong, or the journal was completed while we were looking.
            if self.journal()?.as_ref() == Some(journal) {
                return Err(self.lost(entry));
            }
        }
    }

    /// Contents that a reader sees at all these paths at one moment, in their order: never some
    /// files from before an accept and some from after it, even if it runs meanwhile.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    pub fn read_all<P: AsRef<Path>>(
        &self,
        relative: &[P],
    ) -> Result<Vec<Option<Vec<u8>>>, StoreError> {
        let collect = || {
            relative
                .iter()
                .map(|path| self.read(path.as_ref()))
                .collect::<Result<Vec<_>, _>>()
        };
        loop {
            let begun = self.last_accept();
            // Twice the same, and no accept began meanwhile: each file changed once at most, so these
            // were the contents at the moment between the two.
            let contents = collect()?;
            if contents == collect()? && self.last_accept() == begun {
                return Ok(contents);
            }
        }
    }

    /// The moment at which the last accept began, if one ever did.
    fn last_accept(&self) -> Option<SystemTime> {
        let lock = std::fs::metadata(self.root.join(LOCK));
        lock.and_then(|lock| lock.modified()).ok()
    }

    fn journal(&self) -> Result<Option<Journal>, StoreError> {
        let path = self.root.join(JOURNAL);
        let Some(bytes) = read_if_present(&path)? else {
            return Ok(None);
        };
        match Journal::parse(&bytes) {
            Ok(journal) => Ok(Some(journal)),
            Err(journal::Malformed { line, problem }) => Err(StoreError::Journal {
                path,
                line,
                problem,
            }),
        }
    }

    /// The contents a journal promises, staged or in their place; `None` if at neither.
    fn recorded(
        &self,
        journal: &Journal,
        entry: &JournalEntry,
    ) -> Result<Option<Vec<u8>>, StoreError> {
        // In this order: a file on its way from the first to the second is found.
        let staged = entry.name.staged_under(&self.root, &journal.tag);
        let bytes = match read_if_present(&staged)? {
            Some(bytes) => Some(bytes),
            None => read_if_present(&entry.name.under(&self.root))?,
        };
        Ok(bytes.filter(|bytes| entry.describes(bytes)))
    }

    fn lost(&self, entry: &JournalEntry) -> StoreError {
        let golden = entry.name.under(&self.root);
        StoreError::Lost {
            golden,
            journal: self.root.join(JOURNAL),
        }
    }
}

/// Writing.
impl<D: Disk> Store<D> {
    /// As [`open`](Store::open), with other file operations.
    pub(crate) fn on_disk(root: impl Into<PathBuf>, disk: D) -> Store<D> {
        Store {
            root: root.into(),
            disk,
        }
    }

    /// Replaces or creates all files at once; a path is relative to the root, its directories
    /// are created. After a crash at any moment readers see all of the old files or all of the
    /// new ones. First completes or undoes an accept that was interrupted earlier; with no files
    /// it does only that.
    ///
    /// Leaves `.lock` in the root: the operating system releases the lock when its process
    /// ends, however it ends, so the file being there means nothing.
    ///
    /// # Errors
    ///
    /// Whether readers see the new files follows from the variant: they do after
    /// [`StoreError::Unfinished`], cannot tell after [`Undecided`](StoreError::Undecided), and
    /// see what they saw before after any other. In that case no file is left behind
    /// if removing the staged files works; if not, the next call removes them.
    pub fn publish<P: AsRef<Path>>(&self, files: &[(P, Vec<u8>)]) -> Result<(), StoreError> {
        let mut names = BTreeSet::new();
        let mut entries = Vec::new();
        for (path, bytes) in files {
            let name = name(path.as_ref())?;
            if !names.insert(name.clone()) {
                return Err(StoreError::Twice {
                    path: name.as_str().to_owned(),
                });
            }
            entries.push(JournalEntry::new(name, bytes));
        }

        let journal = Journal::new(entries);
        self.check_inside(&journal)?;
        let _lock = self.lock()?;
        self.finish_interrupted()?;
        if journal.entries.is_empty() {
            return Ok(());
        }
        let contents = files.iter().map(|(_, bytes)| bytes.as_slice());
        if let Err(failure) = self.stage(&journal, contents) {
            return Err(self.give_up(&journal, failure));
        }
        self.decide(&journal)?;
        self.install(&journal).map_err(StoreError::Unfinished)
    }

    /// Fails where a directory of the journal leads, by a link, out of the folder that the root is in:
    /// the suite. Version control stores such links.
    fn check_inside(&self, journal: &Journal) -> Result<(), StoreError> {
        let Ok(home) = directory_of(&self.root).canonicalize() else {
            return Ok(()); // yet to be made
        };
        let mut directories = journal.directories(&self.root);
        directories.insert(self.root.clone());
        for directory in directories {
            let real = directory.canonicalize();
            if real.is_ok_and(|real| !real.starts_with(&home)) {
                let cause = io::Error::other(
                    "a link leads from there out of the suite: put a folder in its place",
                );
                let failure = failed("write goldens into", &directory)(cause);
                return Err(StoreError::Untouched(failure));
            }
        }
        Ok(())
    }

    fn lock(&self) -> Result<Lock, StoreError> {
        let lock = self.root.join(LOCK);
        let is_new = !self.root.exists();
        self.create_directory(&self.root)
            .map_err(StoreError::Untouched)?;
        if is_new {
            // For version control, as a courtesy: a folder of the user's is left as it is.
            let _ = own_file::write(&self.root.join(".gitignore"), IGNORES_LOCK);
        }
        // To open a named pipe for writing is to wait for its reader, and a link may lead to a user's file.
        own_file::check(&lock)
            .map_err(failed("open the lock file", &lock))
            .map_err(StoreError::Untouched)?;
        let opened = File::options()
            .create(true)
            .truncate(false)
            .write(true)
            .open(&lock);
        let file = opened.map_err(failed("open the lock file", &lock));
        let file = file.map_err(StoreError::Untouched)?;
        // Several accepts at once write one after the other.
        let end = Instant::now() + PATIENCE;
        let mut locked = file.try_lock();
        while matches!(locked, Err(TryLockError::WouldBlock)) && Instant::now() < end {
            std::thread::sleep(PAUSE);
            locked = file.try_lock();
        }
        match locked {
            Ok(()) => {
                // For `last_accept`. If the lock is another user's, it keeps its time, and readers
                // rely on no accept being undone by another while they read.
                let _ = file.set_modified(SystemTime::now());
                Ok(Lock(file))
            }
            Err(TryLockError::WouldBlock) => Err(StoreError::Locked { lock }),
            Err(TryLockError::Error(cause)) => {
                Err(StoreError::Untouched(failed("lock", &lock)(cause)))
            }
        }
    }

    /// Carries a decided accept through and undoes an undecided one. Readers see no difference.
    fn finish_interrupted(&self) -> Result<(), StoreError> {
        if let Some(journal) = self.journal()? {
            self.check_inside(&journal)?;
            // All of them first, so that nothing is changed if one has to be refused.
            for entry in &journal.entries {
                self.recorded(&journal, entry)?
                    .ok_or_else(|| self.lost(entry))?;
            }
            self.install(&journal).map_err(StoreError::Untouched)?;
        }
        let draft = self.root.join(DRAFT);
        if let Some(bytes) = read_if_present(&draft)? {
            match Journal::parse(&bytes) {
                Ok(journal) => {
                    self.check_inside(&journal)?;
                    self.unstage(&journal)
                }
                Err(_cut_off) => self.remove_draft(),
            }
            .map_err(StoreError::Untouched)?;
        }
        Ok(())
    }

    /// Steps 1 and 2.
    fn stage<'a>(
        &self,
        journal: &Journal,
        contents: impl Iterator<Item = &'a [u8]>,
    ) -> Result<(), StoreFailure> {
        let draft = self.root.join(DRAFT);
        let text = journal.to_text();
        (self.disk.create_synced(&draft, text.as_bytes())).map_err(failed("write", &draft))?;
        self.sync(&self.root)?;

        for entry in &journal.entries {
            self.create_directory(directory_of(&entry.name.under(&self.root)))?;
        }
        for (entry, bytes) in journal.entries.iter().zip(contents) {
            // What a rename would only find out after the decision.
            let target = entry.name.under(&self.root);
            if target.is_dir() {
                return Err(failed("replace", &target)(ErrorKind::IsADirectory.into()));
            }
            let staged = entry.name.staged_under(&self.root, &journal.tag);
            (self.disk.create_synced(&staged, bytes)).map_err(failed("write", &staged))?;
        }
        self.sync_all(journal)
    }

    /// Step 3.
    fn decide(&self, journal: &Journal) -> Result<(), StoreError> {
        let (draft, target) = (self.root.join(DRAFT), self.root.join(JOURNAL));
        let Err(cause) = self.disk.rename(&draft, &target) else {
            return Ok(());
        };
        // On a network a rename can be reported as failed that took place.
        let failure = failed("rename the journal to", &target)(cause);
        match target.try_exists() {
            Ok(true) => Ok(()),
            Ok(false) => Err(self.give_up(journal, failure)),
            Err(_) => Err(StoreError::Undecided(failure)),
        }
    }

    /// Steps 4 and 5, also if they were partly done before.
    fn install(&self, journal: &Journal) -> Result<(), StoreFailure> {
        // The decision must be durable before the first file depends on it.
        self.sync(&self.root)?;
        for entry in &journal.entries {
            let staged = entry.name.staged_under(&self.root, &journal.tag);
            if staged.try_exists().map_err(failed("look at", &staged))? {
                let target = entry.name.under(&self.root);
                (self.disk.rename(&staged, &target)).map_err(failed("replace", &target))?;
            }
        }
        self.sync_all(journal)?;
        self.remove_if_present(&self.root.join(JOURNAL))?;
        self.sync(&self.root)
    }

    /// Removes what an undecided accept staged, then its draft: as long as a staged file is
    /// there, so is the list that tells it from a file of the user's.
    fn unstage(&self, journal: &Journal) -> Result<(), StoreFailure> {
        for entry in &journal.entries {
            self.remove_if_present(&entry.name.staged_under(&self.root, &journal.tag))?;
        }
        for directory in journal.directories(&self.root) {
            // The crash may have come before the directory.
            if directory.is_dir() {
                self.sync(&directory)?;
            }
        }
        self.remove_draft()
    }

    fn remove_draft(&self) -> Result<(), StoreFailure> {
        self.remove_if_present(&self.root.join(DRAFT))?;
        self.sync(&self.root)
    }

    /// Undoes steps 1 and 2 because of a failure. If that fails as well, the draft stays and the
    /// next accept undoes them.
    fn give_up(&self, journal: &Journal, failure: StoreFailure) -> StoreError {
        let _ = self.unstage(journal);
        StoreError::Untouched(failure)
    }

    /// Creates a directory with its parents, durably.
    fn create_directory(&self, directory: &Path) -> Result<(), StoreFailure> {
        if directory.is_dir() {
            return Ok(());
        }
        let parent = directory_of(directory);
        self.create_directory(parent)?;
        match self.disk.create_dir(directory) {
            // Another accept came first.
            Err(error) if error.kind() == ErrorKind::AlreadyExists && directory.is_dir() => Ok(()),
            Err(error) => Err(failed("create the directory", directory)(error)),
            Ok(()) => self.sync(parent),
        }
    }

    fn remove_if_present(&self, path: &Path) -> Result<(), StoreFailure> {
        match self.disk.remove(path) {
            Err(error) if is_absence(&error) => Ok(()),
            result => result.map_err(failed("remove", path)),
        }
    }

    fn sync_all(&self, journal: &Journal) -> Result<(), StoreFailure> {
        journal
            .directories(&self.root)
            .iter()
            .try_for_each(|directory| self.sync(directory))
    }

    fn sync(&self, directory: &Path) -> Result<(), StoreFailure> {
        self.disk
            .sync_dir(directory)
            .map_err(failed("sync the directory", directory))
    }
}

/// The right to write, until dropped.
struct Lock(File);

impl Drop for Lock {
    /// Closing the file would not do: a process just being started by another thread has a copy
    /// of the descriptor for a moment, and the lock lasts until the last copy is closed.
    fn drop(&mut self) {
        // If unlocking fails, closing the file is the next best.
        let _ = self.0.unlock();
    }
}

fn name(path: &Path) -> Result<StoreName, StoreError> {
    StoreName::new(path).map_err(|problem| StoreError::Name {
        path: path.to_path_buf(),
        problem,
    })
}

fn failed(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> StoreFailure {
    move |cause| StoreFailure {
        action,
        path: path.to_path_buf(),
        cause,
    }
}

/// Largest file read, in bytes: 1 GiB, eight channels of 32 bits of 5792² pixels.
const MOST_BYTES: u64 = 1 << 30;

fn read_if_present(path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
    match regular_file::read(path, MOST_BYTES) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(ReadError::Missing(_)) => Ok(None),
        Err(error) => Err(StoreError::Read(failed("read", path)(error.into()))),
    }
}

/// Also where a file stands in the place of the directory: there is nothing in it to remove.
fn is_absence(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

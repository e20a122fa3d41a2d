//! Errors of the store, with remedies.

use std::io;
use std::path::PathBuf;

use crate::files::atomic_file::remedy;

/// One file operation that failed.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {cause}", path.display())]
pub struct StoreFailure {
    /// The action, as a verb phrase: "write", "rename", …
    pub action: &'static str,
    /// File or directory of the action.
    pub path: PathBuf,
    /// Error of the operating system.
    pub cause: io::Error,
}

/// Goldens could not be read or replaced.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A path that cannot name a golden. Nothing was done.
    #[error("{path:?} cannot name a golden: {problem}; use a path inside the golden directory")]
    Name {
        /// The path as given.
        path: PathBuf,
        /// Reason.
        problem: &'static str,
    },
    /// One accept with two contents for the same file. Nothing was done.
    #[error("{path} is given twice in one accept; give each golden once")]
    Twice {
        /// The path relative to the golden root.
        path: String,
    },
    /// Another process is replacing goldens. Nothing was done.
    #[error(
        "another accept is running: it holds {}; the goldens are untouched, \
         run the same command again when it has ended", lock.display()
    )]
    Locked {
        /// The lock file.
        lock: PathBuf,
    },
    /// Reading failed, for another reason than that there is no such file.
    #[error("{0}; {remedy}", remedy = remedy(.0.cause.kind()))]
    Read(StoreFailure),
    /// Readers see exactly what they saw before.
    #[error(
        "{0}; the goldens are as they were before this command: {remedy}",
        remedy = remedy(.0.cause.kind())
    )]
    Untouched(StoreFailure),
    /// Readers see all of the new files, but not all of them have their final names yet.
    #[error(
        "{0}; the new goldens are all recorded and `verify` sees them, \
         the next `accept` puts them in their places: {remedy}", remedy = remedy(.0.cause.kind())
    )]
    Unfinished(StoreFailure),
    /// The operation that decides failed, and so did finding out whether it took place. Readers
    /// see all of the new files or all of the old ones.
    #[error(
        "{0}, and cannot find out whether it happened; the goldens are all the old ones or all \
         the new ones: run `verify` to see which, and the same command again for the new ones"
    )]
    Undecided(StoreFailure),
    /// The journal is not one that volref wrote.
    #[error(
        "{}, line {line}: {problem}; a crash cannot cause this, the file was changed after it \
         was written: restore the goldens from version control, delete this file and the \
         `.*.volref-new` files beside the goldens, and run `accept` again", path.display()
    )]
    Journal {
        /// The journal.
        path: PathBuf,
        /// Counted from 1.
        line: usize,
        /// Fault of that line.
        problem: String,
    },
    /// An interrupted accept gave a file contents that are nowhere to be found. Whether the
    /// others should be the old or the new ones is not for volref to guess.
    #[error(
        "{} does not have the contents that the interrupted accept in {} gave it: one of the two \
         was changed or restored since; for the old goldens restore all of them from version \
         control and delete the journal and the `.*.volref-new` files beside the goldens, for \
         the new ones run `accept` again after that", golden.display(), journal.display()
    )]
    Lost {
        /// The golden in question.
        golden: PathBuf,
        /// The journal that lists it.
        journal: PathBuf,
    },
}

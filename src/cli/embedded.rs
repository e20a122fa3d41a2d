//! The embedded suite, unpacked into files.

use super::failure::{Exit, Failure};
use super::{interrupt, progress};
use crate::naming::{CACHE_VARIABLE, cache_of_the_user};
use crate::suite::{EmbeddedSuite, Suite};
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock, PoisonError};
use tempfile::TempDir;

/// The files of a suite, with their paths relative to its root.
pub(crate) type SuiteFiles = fn() -> Vec<(PathBuf, &'static [u8])>;

static FILES: OnceLock<SuiteFiles> = OnceLock::new();

/// Temporary folder of the unpacked suite, if it was made for this process alone.
static TEMPORARY: Mutex<Option<TempDir>> = Mutex::new(None);

/// Holds `files` as the suite of the program.
pub fn hold(files: SuiteFiles) {
    let _ = FILES.set(files);
}

/// The suite of the program.
pub fn suite() -> EmbeddedSuite {
    EmbeddedSuite::new(FILES.get().map(|files| files()).unwrap_or_default())
}

/// The suite of the program, unpacked into the user's folder for caches, where it stays, else into
/// a temporary one, which is removed [at the end](remove_temporary). Files of others in that folder
/// are not part of it.
pub fn open() -> Result<Suite, Failure> {
    let suite = suite();
    let cache = cache_of_the_user().map(|folder| folder.join("suite").join(suite.name()));
    let cached = cache.map(|folder| match suite.unpack_privately(&folder) {
        Ok(()) => Ok(folder),
        Err(error) => Err(format!("; not in {}: {error}", folder.display())),
    });
    let (folder, why) = match cached {
        Some(Ok(folder)) => (folder, String::new()),
        other => {
            let why = other.and_then(Result::err).unwrap_or_default();
            let folder = temporary(&suite).map_err(|error| {
                let message = format!("cannot unpack the suite within volref: {error}{why}");
                let help = format!(
                    "name a folder that can be written: {CACHE_VARIABLE}=DIR; or a suite: --suite DIR"
                );
                Failure::new(Exit::BadInput, message, Some(&help))
            })?;
            (folder, why)
        }
    };
    progress::note(&format!(
        "the suite of volref {}, in {}{why}",
        env!("CARGO_PKG_VERSION"),
        folder.display()
    ));
    Ok(Suite::open_unpacked(&folder, &suite)?)
}

fn temporary(suite: &EmbeddedSuite) -> std::io::Result<PathBuf> {
    let temporary = tempfile::Builder::new().prefix("volref-suite-").tempdir()?;
    let folder = temporary.path().to_owned();
    suite.unpack(&folder)?;
    *held(&TEMPORARY) = Some(temporary);
    interrupt::before_the_end(remove_temporary);
    Ok(folder)
}

/// Removes the temporary folder of the suite, if there is one.
pub fn remove_temporary() {
    *held(&TEMPORARY) = None;
}

fn held<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

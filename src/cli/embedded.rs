//! The embedded suite, unpacked into files.

use super::failure::{Exit, Failure};
use super::{interrupt, progress};
use crate::files::cache_folder::{CACHE_VARIABLE, cache_of_the_user};
use crate::files::temporary_folder::TemporaryFolder;
use crate::suite::{EmbeddedSuite, Suite};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

/// The files of a suite, with their paths relative to its root.
pub(crate) type SuiteFiles = fn() -> Vec<(PathBuf, &'static [u8])>;

static FILES: OnceLock<SuiteFiles> = OnceLock::new();

/// Temporary folder of the unpacked suite, if it was made for this process alone.
static TEMPORARY: Mutex<Option<TemporaryFolder>> = Mutex::new(None);

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
    let cached = cache_of_the_user().map(|cache| {
        let inner = Path::new("suite").join(suite.name());
        let unpacked = suite.unpack_privately(&cache, &inner);
        unpacked.map_err(|error| format!("; not in {}: {error}", cache.join(inner).display()))
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
    let temporary = TemporaryFolder::new()?;
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

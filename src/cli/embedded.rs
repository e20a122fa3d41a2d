//! The embedded suite, unpacked into files.

use super::failure::{Exit, Failure};
use super::progress;
use crate::files::own_file;
use crate::suite::{EmbeddedSuite, Suite};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The files of a suite, with their paths relative to its root.
pub(crate) type SuiteFiles = fn() -> Vec<(PathBuf, &'static [u8])>;

static FILES: OnceLock<SuiteFiles> = OnceLock::new();

/// Environment variable for the folder of the cache; empty for that of temporary files.
const CACHE_VARIABLE: &str = "VOLREF_CACHE";

/// Holds `files` as the suite of the program.
pub fn hold(files: SuiteFiles) {
    let _ = FILES.set(files);
}

/// The suite of the program.
pub fn suite() -> EmbeddedSuite {
    EmbeddedSuite::new(FILES.get().map(|files| files()).unwrap_or_default())
}

/// The suite of the program, unpacked into the first of the [`caches`] that can be written. Files of others in that
/// folder are not part of it.
pub fn open() -> Result<Suite, Failure> {
    let suite = suite();
    let inner = Path::new("suite").join(suite.name());
    let mut why = String::new();
    for cache in caches() {
        let folder = cache.join(&inner);
        let unpacked = own_file::make_folder(&cache, &inner);
        match unpacked.and_then(|folder| suite.unpack(&folder)) {
            Ok(()) => {
                let (version, shown) = (env!("CARGO_PKG_VERSION"), folder.display());
                progress::note(&format!("the suite of volref {version}, in {shown}{why}"));
                return Ok(Suite::open_unpacked(&folder, &suite)?);
            }
            Err(error) => why += &format!("; not in {}: {error}", folder.display()),
        }
    }
    let message = format!("cannot unpack the suite within volref{why}");
    let help =
        format!("name a folder that can be written: {CACHE_VARIABLE}=DIR; or a suite: --suite DIR");
    Err(Failure::new(Exit::BadInput, message, Some(&help)))
}

/// Folders for what volref unpacks: the one that the environment names, else the user's for caches; and that of the
/// system for temporary files.
fn caches() -> impl Iterator<Item = PathBuf> {
    let variable = |name| std::env::var_os(name).map(PathBuf::from);
    // A relative path is to be ignored, as the XDG Base Directory Specification has it.
    let absolute = |name| variable(name).filter(|path: &PathBuf| path.is_absolute());
    let of_system = if cfg!(windows) {
        absolute("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        absolute("HOME").map(|home| home.join("Library/Caches"))
    } else {
        absolute("HOME").map(|home| home.join(".cache"))
    };
    let of_user = absolute("XDG_CACHE_HOME").or(of_system);
    let cache = variable(CACHE_VARIABLE).or(of_user.map(|folder| folder.join("volref")));
    let named = cache.filter(|path| !path.as_os_str().is_empty());
    named
        .into_iter()
        .chain([std::env::temp_dir().join("volref")])
}

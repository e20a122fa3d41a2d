//! Renderings of stochastic cases, kept until `accept` writes all its goldens, so that one that was interrupted goes on
//! where it was. A file is an image behind a hash of it and of its key: one that was cut off or changed is not read.

use crate::files::atomic_file::directory_of;
use crate::files::kept_file::{self, KeepError};
use crate::files::program_hash::hash;
use crate::files::{own_file, partial_file, regular_file};
use crate::film::Film;
use std::path::{Path, PathBuf};

/// Name of the folder of renderings.
const RENDERINGS: &str = "accept";

const EXTENSION: &str = "rendering";

/// A rendering of a case.
pub(crate) struct RenderingKey {
    /// `family/name`.
    pub case: String,
    /// Hash of everything that it is computed from.
    pub hash: String,
}

impl RenderingKey {
    fn file(&self) -> PathBuf {
        let name = format!("{}.{EXTENSION}", self.hash);
        Path::new(RENDERINGS).join(&self.case).join(name)
    }

    fn seal(&self, exr: &[u8]) -> String {
        hash(&[self.hash.as_bytes(), exr])
    }
}

/// A folder of renderings, hidden from version control.
#[derive(Clone, Debug)]
pub struct KeptRenderings {
    /// The folder `.volref`.
    root: PathBuf,
}

impl KeptRenderings {
    /// The renderings within the folder `root`, which need not exist.
    pub fn open(root: impl Into<PathBuf>) -> KeptRenderings {
        KeptRenderings { root: root.into() }
    }

    /// True if there is a file of this key; it may be damaged.
    pub(crate) fn has(&self, key: &RenderingKey) -> bool {
        self.root.join(key.file()).is_file()
    }

    /// The rendering of this key; `None` if none was kept.
    ///
    /// # Errors
    ///
    /// A sentence about a file that is not as it was written: as if there were none.
    pub(crate) fn get(&self, key: &RenderingKey) -> Result<Option<Film>, String> {
        let path = self.root.join(key.file());
        if !path.exists() {
            return Ok(None);
        }
        let read = || {
            let bytes = regular_file::read(&path, regular_file::MOST_BYTES);
            let bytes = bytes.map_err(|error| error.to_string())?;
            let (seal, exr) = bytes.split_at_checked(64).unwrap_or_default();
            if key.seal(exr).as_bytes() != seal {
                return Err("it was cut off or changed".to_owned());
            }
            Film::from_exr(exr).map_err(|error| error.to_string())
        };
        let film = read().map_err(|reason| format!("{}: {reason}", path.display()))?;
        Ok(Some(film))
    }

    /// Keeps a rendering.
    pub(crate) fn put(&self, key: &RenderingKey, film: &Film) -> Result<(), KeepError> {
        let (root, name) = kept_file::in_its_folder(&self.root);
        let inner = name.join(key.file());
        let path = root.join(&inner);
        let exr = film.to_exr();
        let exr = exr.map_err(|error| KeepError::encode(&path, error))?;
        own_file::make_folder(root, directory_of(&inner))?;
        own_file::write(&path, &[key.seal(&exr).as_bytes(), &exr].concat())?;
        kept_file::hide(&self.root);
        Ok(())
    }

    /// Fails where renderings of `case` could not be kept, for a link or something else in the place of a folder.
    pub(crate) fn check(&self, case: &str) -> Result<(), KeepError> {
        let (root, name) = kept_file::in_its_folder(&self.root);
        let folder = name.join(RENDERINGS).join(case);
        Ok(own_file::check_folder(root, &folder)?)
    }

    /// Removes the renderings of `case`, and folders left empty. Other files there stay, and so does what a link leads
    /// to.
    pub(crate) fn forget(&self, case: &str) {
        let folder = self.root.join(RENDERINGS).join(case);
        let (Ok(()), Ok(entries)) = (self.check(case), std::fs::read_dir(&folder)) else {
            return;
        };
        for entry in entries.flatten() {
            let (path, kind) = (entry.path(), entry.file_type());
            let is_ours = path.extension().is_some_and(|of| of == EXTENSION)
                && path.file_stem().is_some_and(|hash| hash.len() == 64);
            if is_ours && kind.is_ok_and(|kind| kind.is_file()) {
                let _ = std::fs::remove_file(path);
            }
        }
        partial_file::sweep(&folder);
        for folder in folder.ancestors() {
            if folder == self.root || std::fs::remove_dir(folder).is_err() {
                break;
            }
        }
        partial_file::sweep(&self.root);
        kept_file::remove_if_empty(&self.root);
    }
}

//! Renderings of an interrupted accept.
//!
//! A converged rendering takes minutes to hours. Each one is kept when it is finished, so that the
//! next run resumes there; when its case is accepted, it is removed. An unfinished rendering starts
//! again.
//!
//! The key of a rendering is a hash of everything it depends on: scene, plan, input files,
//! samples and seed, the versions of volref and `libm`, and the executable itself, so that no
//! image ever comes from other code. Its file begins with the hash of the image, so that none comes
//! back changed.

use super::golden::{LIBM_VERSION, input_hashes};
use super::rendering::CaseRendering;
use crate::atomic_file::write_atomically;
use crate::compare::Picture;
use crate::film::Film;
use crate::regular_file;
use crate::render::Plan;
use crate::scene::Scene;
use std::path::{Path, PathBuf};

/// Largest rendering and executable read, in bytes: 4 GiB, as of other images.
const MOST_BYTES: u64 = Picture::MOST_BYTES;

/// A folder of finished renderings, hidden from version control.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
    /// Hash of the running executable; without it nothing is kept.
    executable: Option<String>,
}

impl Cache {
    /// The cache in `folder`, which need not exist. Touches no file but the executable.
    pub fn open(folder: impl Into<PathBuf>) -> Cache {
        Cache {
            folder: folder.into(),
            executable: executable_hash(),
        }
    }

    /// The key of a rendering, if it can be kept.
    pub(super) fn key(
        &self,
        scene: &Scene,
        plans: &[Plan<'_>],
        rendering: CaseRendering,
    ) -> Option<String> {
        let executable = self.executable.as_ref()?;
        let plans: Vec<_> = plans.iter().map(Plan::canonical_text).collect();
        let inputs: Vec<_> = input_hashes(scene).into_iter().collect();
        let parts = [
            scene.canonical_text(),
            format!("{plans:?}"),
            format!("{inputs:?}"),
            rendering.name(),
            env!("CARGO_PKG_VERSION").to_owned(),
            LIBM_VERSION.to_owned(),
            executable.clone(),
        ];
        Some(hash(&parts))
    }

    /// The rendering of `case` with this key, if it was kept and is intact.
    pub(super) fn get(&self, case: &str, key: &str) -> Option<Film> {
        read_film(&self.folder.join(case).join(key))
    }

    /// Keeps a finished rendering. A failure is ignored: the next run renders it again.
    pub(super) fn put(&self, case: &str, key: &str, film: &Film) {
        if write_film(&self.folder.join(case).join(key), film).is_none() {
            return;
        }
        // Hides the folder, and itself, from version control wherever the suite is.
        let ignore = self.folder.join(".gitignore");
        if !ignore.exists() {
            let _ = write_atomically(&ignore, b"*\n");
        }
    }

    /// Removes the kept renderings of `case`, and folders left empty.
    pub(super) fn forget(&self, case: &str) {
        let folder = self.folder.join(case);
        if std::fs::remove_dir_all(&folder).is_err() {
            return;
        }
        if folder.parent().is_some_and(is_removed) {
            let only_hidden = |entries: std::fs::ReadDir| {
                entries
                    .flatten()
                    .all(|entry| entry.file_name() == ".gitignore")
            };
            if std::fs::read_dir(&self.folder).is_ok_and(only_hidden) {
                let _ = std::fs::remove_file(self.folder.join(".gitignore"));
                let _ = std::fs::remove_dir(&self.folder);
            }
        }
    }
}

/// Bytes of a BLAKE3 hash, with which a kept film begins.
const HASH: usize = 32;

/// The film that was kept at `path`, if it is as it was.
pub(super) fn read_film(path: &Path) -> Option<Film> {
    let bytes = regular_file::read(path, MOST_BYTES).ok()?;
    let (sum, film) = bytes.split_at_checked(HASH)?;
    (blake3::hash(film).as_bytes() == sum).then(|| Film::from_exr(film).ok())?
}

/// Keeps `film` at `path`, its folder made, if that can be done; how many bytes that takes.
pub(super) fn write_film(path: &Path, film: &Film) -> Option<u64> {
    let film = film.to_exr().ok()?;
    std::fs::create_dir_all(path.parent()?).ok()?;
    let bytes = [&blake3::hash(&film).as_bytes()[..], &film].concat();
    write_atomically(path, &bytes).ok()?;
    Some(bytes.len() as u64)
}

/// Hash of the running executable, since other builds may render other images.
pub(super) fn executable_hash() -> Option<String> {
    let bytes = regular_file::read(&std::env::current_exe().ok()?, MOST_BYTES);
    bytes.ok().map(|bytes| hash(&[&bytes]))
}

/// Removes a folder if it is empty.
fn is_removed(folder: &Path) -> bool {
    std::fs::remove_dir(folder).is_ok()
}

/// Hash of the parts, each with its length, so that no two lists of parts collide.
pub(super) fn hash<P: AsRef<[u8]>>(parts: &[P]) -> String {
    let mut hasher = blake3::Hasher::new();
    for part in parts.iter().map(AsRef::as_ref) {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().to_hex().to_string()
}

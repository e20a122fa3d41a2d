//! Cache of predictions, kept from run to run.
//!
//! The image that a mistake makes of a case depends on neither the image that is judged nor on
//! whose it is: whoever judges the pictures of a whole class, or the same renderer again after a
//! change, needs the same predictions. Its key is a hash of all that it does depend on: scene, input
//! files, mistakes, pixels and samples, and the executable itself, so that no prediction ever comes
//! from other code, a build under development included.
//!
//! Nothing here is an error: what cannot be read, is damaged or cannot be written is rendered. A folder that
//! others can change is not used: a prediction is believed.

use crate::files::private_folder;
use crate::files::program_hash::{hash, program_hash};
use crate::film::Film;
use crate::film::kept_film;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};
use std::time::SystemTime;

/// Environment variable for the folder of the cache; empty for no cache.
pub(crate) const CACHE_VARIABLE: &str = "VOLREF_CACHE";

/// Largest size of the folder, bytes: beyond it the oldest files are removed. A prediction of a
/// case of the suite has 20 to 500 kB.
const MOST_BYTES: u64 = 256 << 20;

/// Size of the folder after a removal, bytes, so that not every further file leads to another one.
const BYTES_LEFT: u64 = MOST_BYTES / 4 * 3;

/// Their folder within the cache.
const PREDICTIONS: &str = "predictions";

const EXTENSION: &str = "prediction";

/// A folder of predictions.
#[derive(Debug, Default)]
pub struct Predictions {
    folder: Option<PathBuf>,
    /// Reason why the folder is not used, after it was checked.
    refusal: OnceLock<Option<String>>,
    /// Bytes in the folder, after they were counted.
    bytes: Mutex<Option<u64>>,
}

impl Predictions {
    /// A cache that keeps nothing.
    pub fn nowhere() -> Predictions {
        Predictions::default()
    }

    /// A cache in `folder`, which need not exist; unused if others can write there.
    pub fn in_folder(folder: impl Into<PathBuf>) -> Predictions {
        Predictions {
            folder: Some(folder.into()),
            ..Predictions::default()
        }
    }

    /// A cache in the folder that the environment variable [`VOLREF_CACHE`](CACHE_VARIABLE) names,
    /// else in the user's folder for caches; nowhere if there is none.
    pub(crate) fn of_the_user() -> Predictions {
        Predictions {
            folder: cache_of_the_user(),
            ..Predictions::default()
        }
    }

    /// Key of a prediction: a hash of the program and of the `parts` that it depends on besides.
    pub(super) fn key(&self, parts: &[&str]) -> Option<String> {
        self.folder.as_ref()?;
        let executable = program_hash()?;
        Some(hash(&[parts, &[executable]].concat()))
    }

    /// The prediction with this key, of `size`, if it was kept and is undamaged.
    pub(super) fn get(&self, key: &str, size: [usize; 2]) -> Option<Film> {
        let (key_of_file, film) = kept_film::read::<String>(&self.path(key)?, size).ok()?;
        (key_of_file == key).then_some(film)
    }

    /// Keeps a prediction.
    pub(super) fn put(&self, key: &str, film: &Film) {
        if let Some(folder) = self.usable_folder()
            && let Ok(bytes) = kept_film::write(&folder, &file(key), &key, film)
        {
            self.keep_small(&folder, bytes);
        }
    }

    /// Reason why the cache keeps nothing; a sentence.
    pub fn refusal(&self) -> Option<&str> {
        let folder = self.folder.as_ref()?;
        let look = || match private_folder::make(folder, Path::new(PREDICTIONS)) {
            Ok(()) => None,
            Err(error) => Some(format!("{}: {error}", folder.join(PREDICTIONS).display())),
        };
        self.refusal.get_or_init(look).as_deref()
    }

    fn subfolder(&self) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(PREDICTIONS))
    }

    fn usable_folder(&self) -> Option<PathBuf> {
        self.subfolder().filter(|_| self.refusal().is_none())
    }

    fn path(&self, key: &str) -> Option<PathBuf> {
        Some(self.usable_folder()?.join(file(key)))
    }

    /// Removes the oldest files if the folder is too large with `written` more bytes.
    fn keep_small(&self, folder: &Path, written: u64) {
        let Ok(mut bytes) = self.bytes.lock() else {
            return;
        };
        let now = match *bytes {
            Some(before) => before + written,
            None => files(folder).iter().map(|file| file.bytes).sum(),
        };
        *bytes = Some(if now > MOST_BYTES {
            without_the_oldest(folder, BYTES_LEFT)
        } else {
            now
        });
    }
}

/// The folder that the environment variable [`VOLREF_CACHE`](CACHE_VARIABLE) names, else the one in the
/// user's folder for caches; `None` if there is none.
pub(crate) fn cache_of_the_user() -> Option<PathBuf> {
    folder_of_the_user(&|name| std::env::var_os(name).map(PathBuf::from))
}

/// The folder of caches of this user, by the variables of the environment.
fn folder_of_the_user(variable: &dyn Fn(&str) -> Option<PathBuf>) -> Option<PathBuf> {
    if let Some(named) = variable(CACHE_VARIABLE) {
        return (!named.as_os_str().is_empty()).then_some(named);
    }
    // A relative path is to be ignored, as the XDG Base Directory Specification has it.
    let absolute = |name| variable(name).filter(|path: &PathBuf| path.is_absolute());
    let folder = if let Some(folder) = absolute("XDG_CACHE_HOME") {
        folder
    } else if cfg!(windows) {
        absolute("LOCALAPPDATA")?
    } else if cfg!(target_os = "macos") {
        absolute("HOME")?.join("Library/Caches")
    } else {
        absolute("HOME")?.join(".cache")
    };
    Some(folder.join("volref"))
}

fn file(key: &str) -> PathBuf {
    PathBuf::from(format!("{key}.{EXTENSION}"))
}

struct KeptPrediction {
    path: PathBuf,
    bytes: u64,
    written: SystemTime,
}

/// The predictions in `folder`, without other files.
fn files(folder: &Path) -> Vec<KeptPrediction> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .filter_map(|entry| {
            let path = entry.path();
            let metadata = entry.metadata().ok()?;
            let is_ours = metadata.is_file() && path.extension()? == EXTENSION;
            is_ours.then_some(KeptPrediction {
                bytes: metadata.len(),
                written: metadata.modified().ok()?,
                path,
            })
        })
        .collect()
}

/// Removes the oldest predictions in `folder` until at most `most` bytes are left; returns the
/// bytes left.
fn without_the_oldest(folder: &Path, most: u64) -> u64 {
    let mut files = files(folder);
    files.sort_by_key(|file| file.written);
    let mut left: u64 = files.iter().map(|file| file.bytes).sum();
    for file in files {
        if left <= most {
            break;
        }
        // Somebody else may have removed it.
        let _ = std::fs::remove_file(&file.path);
        left -= file.bytes;
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn film(value: f32) -> Film {
        Film::with_noise(2, 1, vec![[value; 3]; 2], vec![[0.25; 3]; 2], 16)
    }

    #[test]
    fn what_was_kept_comes_back_and_what_was_damaged_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let predictions = Predictions::in_folder(folder.path());
        let key = predictions.key(&["scene", "mistake"]).unwrap();
        assert_ne!(predictions.key(&["scenemistake"]).unwrap(), key);
        assert_eq!(predictions.get(&key, [2, 1]), None);
        predictions.put(&key, &film(0.5));
        assert_eq!(predictions.get(&key, [2, 1]), Some(film(0.5)));
        assert_eq!(predictions.get(&key, [1, 2]), None);
        let path = predictions.path(&key).unwrap();
        let whole = fs::read(&path).unwrap();
        for damaged in [&whole[..whole.len() - 1], &whole[..31], &[]] {
            fs::write(&path, damaged).unwrap();
            assert_eq!(predictions.get(&key, [2, 1]), None);
        }
        predictions.put(&key, &film(0.25));
        assert_eq!(predictions.get(&key, [2, 1]), Some(film(0.25)));
    }

    #[test]
    fn a_folder_that_cannot_be_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "kept").unwrap();
        let predictions = Predictions::in_folder(&file);
        let key = predictions.key(&["scene"]).unwrap();
        predictions.put(&key, &film(0.5));
        assert_eq!(predictions.get(&key, [2, 1]), None);
        assert_eq!(fs::read(&file).unwrap(), b"kept");
        assert_eq!(Predictions::nowhere().key(&["scene"]), None);
    }

    #[test]
    fn the_oldest_go_first_and_nothing_else_does() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("notes.txt"), [0; 64]).unwrap();
        for (age, name) in ["c", "a", "b"].iter().enumerate() {
            let path = path(&format!("{name}.{EXTENSION}"));
            fs::write(&path, [0; 10]).unwrap();
            let file = fs::File::options().write(true).open(&path).unwrap();
            let then = SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(age as u64);
            file.set_modified(then).unwrap();
        }
        assert_eq!(without_the_oldest(folder.path(), 29), 20);
        let there = |name: &str| path(name).exists();
        assert!(!there("c.prediction") && there("a.prediction") && there("b.prediction"));
        assert_eq!(without_the_oldest(folder.path(), 20), 20);
        assert_eq!(without_the_oldest(folder.path(), 0), 0);
        assert!(there("notes.txt") && !there("b.prediction"));
    }

    #[test]
    fn the_folder_is_named_or_the_users() {
        let with = |names: &[(&str, &str)]| {
            let found = |name: &str| names.iter().find(|(known, _)| *known == name);
            folder_of_the_user(&|name| found(name).map(|(_, path)| PathBuf::from(path)))
        };
        let home = if cfg!(windows) {
            "C:\\home"
        } else {
            "/home/me"
        };
        let named = [(CACHE_VARIABLE, "here"), ("XDG_CACHE_HOME", home)];
        assert_eq!(with(&named), Some(PathBuf::from("here")));
        assert_eq!(with(&[(CACHE_VARIABLE, ""), ("HOME", home)]), None);
        let xdg = Path::new(home).join("volref");
        assert_eq!(with(&[("XDG_CACHE_HOME", home)]), Some(xdg));
        assert_eq!(with(&[]), None);
        #[cfg(all(unix, not(target_os = "macos")))]
        assert_eq!(
            with(&[("XDG_CACHE_HOME", "relative"), ("HOME", home)]),
            Some(PathBuf::from("/home/me/.cache/volref"))
        );
    }
}

//! Films in files that only volref reads: behind a hash of themselves, so that none comes back changed.

use crate::atomic_file::write_atomically;
use crate::compare::Picture;
use crate::film::Film;
use crate::regular_file;
use std::path::Path;
use std::sync::OnceLock;

/// Largest rendering and executable read, in bytes: 4 GiB, as of other images.
pub(super) const MOST_BYTES: u64 = Picture::MOST_BYTES;

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

/// Hash of the running executable, since other builds may render other images; `None` if it cannot be
/// read.
pub fn executable_hash() -> Option<&'static str> {
    static HASH: OnceLock<Option<String>> = OnceLock::new();
    let read = || {
        let bytes = regular_file::read(&std::env::current_exe().ok()?, MOST_BYTES);
        bytes.ok().map(|bytes| hash(&[&bytes]))
    };
    HASH.get_or_init(read).as_deref()
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

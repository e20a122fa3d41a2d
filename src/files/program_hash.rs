//! Hashes of the inputs of a result, and of the running program.

use super::regular_file;
use std::sync::OnceLock;

/// Hash of the running executable, since other builds may render other images; `None` if it cannot
/// be read.
pub fn program_hash() -> Option<&'static str> {
    static HASH: OnceLock<Option<String>> = OnceLock::new();
    let read = || {
        let bytes =
            regular_file::read_any(&std::env::current_exe().ok()?, regular_file::MOST_BYTES);
        bytes.ok().map(|bytes| hash(&[&bytes]))
    };
    HASH.get_or_init(read).as_deref()
}

/// Hash of the parts, each with its length, so that no two lists of parts collide.
pub(crate) fn hash<P: AsRef<[u8]>>(parts: &[P]) -> String {
    let mut hasher = blake3::Hasher::new();
    for part in parts.iter().map(AsRef::as_ref) {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().to_hex().to_string()
}

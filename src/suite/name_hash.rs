//! Hash of a name as a number.

/// First eight bytes of the BLAKE3 hash of a name: the same everywhere, and different for different names.
pub(crate) fn name_hash(name: &str) -> u64 {
    let hash = blake3::hash(name.as_bytes());
    u64::from_le_bytes(*hash.as_bytes().first_chunk().expect("it has 32 bytes"))
}

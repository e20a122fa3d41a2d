//! Hash of a name as a number.

/// First eight bytes of the BLAKE3 hash of a name: the same everywhere, and different for different names.
pub(crate) fn name_hash(name: &str) -> u64 {
    let hash = blake3::hash(name.as_bytes());
    let (first, _) = hash.as_bytes().split_at(8);
    u64::from_le_bytes(first.try_into().expect("eight bytes"))
}

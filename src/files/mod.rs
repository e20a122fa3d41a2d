//! Reading and writing of files: regular files only, whole or not at all, sealed by a hash.

pub mod atomic_file;
pub(crate) mod decoder;
pub(crate) mod file_kind;
pub(crate) mod golden_mark;
pub(crate) mod gzip;
pub(crate) mod misspelling;
pub(crate) mod npy_header;
pub(crate) mod own_file;
pub(crate) mod partial_file;
pub(crate) mod program_hash;
pub(crate) mod regular_file;
#[cfg(test)]
pub(crate) mod tests;
pub(crate) mod visible;

pub use program_hash::program_hash;

//! Hash of everything in a suite that verdicts depend on.

use super::{Case, Suite, golden};
use crate::files::program_hash::hash;
use crate::files::regular_file;
use std::path::PathBuf;

/// Longest text of a suite that is hashed: 64 MiB.
const MOST_BYTES: u64 = 1 << 26;

impl Suite {
    /// Hash of what a case is judged by: its manifest, its scene and the record of its golden, which has
    /// hashes of all other files.
    pub(crate) fn hash_of(&self, case: &Case) -> String {
        let [_, _, record] = golden::files(case);
        let record = self.golden_folder().join(record);
        let files = [self.manifest_of(case), case.scene.clone(), record];
        // An unreadable file is an error of the case.
        let read = |file: &PathBuf| regular_file::read_any(file, MOST_BYTES).unwrap_or_default();
        hash(&files.iter().map(read).collect::<Vec<_>>())
    }
}

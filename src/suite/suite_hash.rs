//! What verdicts depend on in a suite, as a hash.

use super::kept_film::hash;
use super::{Case, Suite, golden};
use crate::regular_file;

/// Longest text of a suite that is hashed: 64 MiB.
const MOST_BYTES: u64 = 1 << 26;

impl Suite {
    /// Hash of what these cases are judged by: manifests, scenes and the records of goldens, which have
    /// hashes of all other files.
    pub fn hash_of<'c>(&self, cases: impl IntoIterator<Item = &'c Case>) -> String {
        let mut parts = Vec::new();
        for case in cases {
            let [_, _, record] = golden::files(case);
            let record = self.golden_folder().join(record);
            parts.push(case.name.clone().into_bytes());
            for file in [self.manifest_of(case), case.scene.clone(), record] {
                // What cannot be read is an error of the case.
                parts.push(regular_file::read(&file, MOST_BYTES).unwrap_or_default());
            }
        }
        hash(&parts)
    }
}

//! The record of one accept: which files it replaces, and by what.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use super::name::StoreName;

const HEADING: &str = "volref accept journal 2: completed by the next `volref accept`, do not edit";

/// The files one accept replaces.
///
/// As text it is indented JSON with a newline at its end. No other spelling is read, so that no
/// beginning of a journal is a journal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Journal {
    heading: String,
    /// Part of the names of the staged files. No two accepts share it, so a staged file that
    /// exists is that of this very accept.
    pub(super) tag: String,
    pub(super) entries: Vec<JournalEntry>,
}

/// One file and how to recognise its new contents.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JournalEntry {
    pub(super) name: StoreName,
    /// BLAKE3 hash of the contents.
    hash: String,
}

/// Reason why a text is not a journal.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Malformed {
    /// Counted from 1.
    pub(super) line: usize,
    pub(super) problem: String,
}

impl Journal {
    pub(super) fn new(entries: Vec<JournalEntry>) -> Journal {
        let now = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default();
        Journal {
            heading: HEADING.to_owned(),
            tag: format!("{:x}-{:x}", now.as_nanos(), process::id()),
            entries,
        }
    }

    pub(super) fn entry(&self, name: &StoreName) -> Option<&JournalEntry> {
        self.entries.iter().find(|entry| entry.name == *name)
    }

    /// The directories in which names change, each once.
    pub(super) fn directories(&self, root: &Path) -> BTreeSet<PathBuf> {
        let entries = self.entries.iter();
        entries
            .flat_map(|entry| entry.name.directories(root))
            .collect()
    }

    pub(super) fn to_text(&self) -> String {
        serde_json::to_string_pretty(self).expect("plain data becomes JSON") + "\n"
    }

    /// Accepts what [`to_text`](Self::to_text) writes and nothing else.
    pub(super) fn parse(bytes: &[u8]) -> Result<Journal, Malformed> {
        let journal: Journal = serde_json::from_slice(bytes).map_err(|error| Malformed {
            line: error.line().max(1),
            problem: error.to_string(),
        })?;
        let text = journal.to_text();
        let in_tag = |byte: u8| byte.is_ascii_hexdigit() || byte == b'-';
        let names: BTreeSet<_> = journal.entries.iter().map(|entry| &entry.name).collect();
        let (line, problem) = if text.as_bytes() != bytes {
            let same = text.bytes().zip(bytes).take_while(|(a, b)| a == *b);
            let lines = same.filter(|(byte, _)| *byte == b'\n').count();
            (lines + 1, "it is not spelt the way volref writes it")
        } else if journal.heading != HEADING {
            (2, "the heading is not that of a journal")
        } else if journal.tag.is_empty() || !journal.tag.bytes().all(in_tag) {
            (3, "expected a hexadecimal tag")
        } else if names.len() < journal.entries.len() {
            (4, "a path is listed twice")
        } else {
            return Ok(journal);
        };
        Err(Malformed {
            line,
            problem: problem.to_owned(),
        })
    }
}

impl JournalEntry {
    pub(super) fn new(name: StoreName, bytes: &[u8]) -> JournalEntry {
        JournalEntry {
            name,
            hash: hash(bytes),
        }
    }

    /// True if these are the contents the accept gave to the file.
    pub(super) fn describes(&self, bytes: &[u8]) -> bool {
        self.hash == hash(bytes)
    }
}

fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn journal() -> Journal {
        let entry =
            |path, bytes| JournalEntry::new(StoreName::new(Path::new(path)).unwrap(), bytes);
        Journal::new(vec![
            entry("a/b c.exr", b"exr"),
            entry("a/b c.toml", b""),
            entry("é", b"1"),
        ])
    }

    #[test]
    fn reads_what_it_writes() {
        let journal = journal();
        assert_eq!(Journal::parse(journal.to_text().as_bytes()), Ok(journal));
    }

    #[test]
    fn no_beginning_of_a_journal_is_a_journal() {
        let text = journal().to_text().into_bytes();
        for length in 0..text.len() {
            assert!(Journal::parse(&text[..length]).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn refuses_changed_lines_and_names_them() {
        let text = journal().to_text();
        for (old, new, line) in [
            ("volref", "Volref", 2),
            ("\"tag\": \"", "\"tag\": \"../", 3),
            ("a/b c.exr", "../b c.exr", 6),
            ("a/b c.exr", "/b c.exr", 6),
            ("a/b c.exr", "a//b c.exr", 6),
            ("\"hash\"", "\"Hash\"", 7),
            ("a/b c.toml", "a/b c.exr", 4),
            ("  ]", "]", 17),
        ] {
            let changed = text.replacen(old, new, 1);
            assert_ne!(changed, text);
            let malformed = Journal::parse(changed.as_bytes()).unwrap_err();
            assert_eq!(malformed.line, line, "{old:?} to {new:?}: {malformed:?}");
        }
    }
}

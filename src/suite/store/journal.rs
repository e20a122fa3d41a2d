//! The record of one accept: which files it replaces, and by what.

use std::collections::BTreeSet;
use std::path::Path;
use std::process;
use std::time::{SystemTime, UNIX_EPOCH};

use super::name::StoreName;

const HEADING: &str = "volref accept journal 1: completed by the next `volref accept`, do not edit";

/// The files one accept replaces.
///
/// As text: a heading, `tag TAG`, a line `DIGEST LENGTH PATH` for each file and `end COUNT`, so
/// that no beginning of a journal is a journal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Journal {
    /// Part of the names of the staged files. No two accepts share it, so a staged file that
    /// exists is that of this very accept.
    pub(super) tag: String,
    pub(super) entries: Vec<JournalEntry>,
}

/// One file and how to recognise its new contents.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct JournalEntry {
    pub(super) name: StoreName,
    length: u64,
    digest: u64,
}

/// Why a text is not a journal.
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
            tag: format!("{:x}-{:x}", now.as_nanos(), process::id()),
            entries,
        }
    }

    pub(super) fn entry(&self, name: &StoreName) -> Option<&JournalEntry> {
        self.entries.iter().find(|entry| entry.name == *name)
    }

    /// The directories in which names change, each once.
    pub(super) fn directories(&self, root: &Path) -> BTreeSet<std::path::PathBuf> {
        self.entries
            .iter()
            .flat_map(|entry| entry.name.directories(root))
            .collect()
    }

    pub(super) fn to_text(&self) -> String {
        let mut text = format!("{HEADING}\ntag {}\n", self.tag);
        for JournalEntry {
            name,
            length,
            digest,
        } in &self.entries
        {
            text += &format!("{digest:016x} {length} {}\n", name.as_str());
        }
        text + &format!("end {}\n", self.entries.len())
    }

    /// Accepts what [`to_text`](Self::to_text) writes and nothing else.
    pub(super) fn parse(bytes: &[u8]) -> Result<Journal, Malformed> {
        let malformed = |line, problem: &str| Malformed {
            line,
            problem: problem.to_owned(),
        };
        let text = str::from_utf8(bytes).map_err(|_| malformed(1, "the file is not UTF-8"))?;
        let lines: Vec<&str> = text.split('\n').collect();
        let [heading, tag, entries @ .., end, ""] = &lines[..] else {
            return Err(malformed(lines.len(), "the file is cut off"));
        };
        if *heading != HEADING {
            return Err(malformed(1, "the heading is not that of a journal"));
        }
        let tag = (tag.strip_prefix("tag "))
            .filter(|tag| {
                !tag.is_empty() && tag.bytes().all(|b| b.is_ascii_hexdigit() || b == b'-')
            })
            .ok_or_else(|| malformed(2, "expected `tag` and a hexadecimal tag"))?;
        let mut journal = Journal {
            tag: tag.to_owned(),
            entries: Vec::new(),
        };
        for (index, text) in entries.iter().enumerate() {
            let line = index + 3;
            let entry = JournalEntry::parse(text).map_err(|problem| Malformed { line, problem })?;
            if journal.entry(&entry.name).is_some() {
                return Err(malformed(line, "the path is listed twice"));
            }
            journal.entries.push(entry);
        }
        if *end != format!("end {}", entries.len()) {
            return Err(malformed(
                entries.len() + 3,
                "expected `end` and the number of files",
            ));
        }
        Ok(journal)
    }
}

impl JournalEntry {
    pub(super) fn new(name: StoreName, bytes: &[u8]) -> JournalEntry {
        JournalEntry {
            name,
            length: bytes.len() as u64,
            digest: fnv1a(bytes),
        }
    }

    /// Whether these are the contents the accept gave to the file.
    pub(super) fn describes(&self, bytes: &[u8]) -> bool {
        self.length == bytes.len() as u64 && self.digest == fnv1a(bytes)
    }

    fn parse(line: &str) -> Result<JournalEntry, String> {
        let mut fields = line.splitn(3, ' ');
        let (Some(digest), Some(length), Some(path)) =
            (fields.next(), fields.next(), fields.next())
        else {
            return Err("expected a digest, a length and a path".to_owned());
        };
        let name = StoreName::new(Path::new(path))
            .map_err(|problem| format!("the path {path:?} is refused: {problem}"))?;
        let entry = JournalEntry {
            name,
            length: length
                .parse()
                .map_err(|_| format!("{length:?} is not a length"))?,
            digest: u64::from_str_radix(digest, 16)
                .map_err(|_| format!("{digest:?} is not a digest"))?,
        };
        // One spelling only: no `+7`, no `a//b`.
        let JournalEntry {
            name,
            length,
            digest,
        } = &entry;
        if line != format!("{digest:016x} {length} {}", name.as_str()) {
            return Err("the line is not spelt the way volref writes it".to_owned());
        }
        Ok(entry)
    }
}

/// The 64-bit FNV-1a hash: enough to notice a file that was restored or edited by mistake,
/// and not meant against anyone who does it on purpose.
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
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
            ("volref", "Volref", 1),
            ("tag ", "tag ../", 2),
            (" a/b c.exr", " ../b c.exr", 3),
            (" a/b c.exr", " /b c.exr", 3),
            (" a/b c.exr", " a//b c.exr", 3),
            (" 3 ", " +3 ", 3),
            ("a/b c.toml", "a/b c.exr", 4),
            ("end 3", "end 2", 6),
            ("end 3\n", "end 3\n\n", 6),
        ] {
            let changed = text.replacen(old, new, 1);
            assert_ne!(changed, text);
            let malformed = Journal::parse(changed.as_bytes()).unwrap_err();
            assert_eq!(malformed.line, line, "{old:?} to {new:?}: {malformed:?}");
        }
    }

    #[test]
    fn digest_is_fnv1a() {
        // Test vectors of the authors, Fowler, Noll and Vo.
        assert_eq!(fnv1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
    }
}

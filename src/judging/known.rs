//! Known failures: what a file of them says of a result.
//!
//! Such a file is a ratchet. A failure that it lists does not fail the run; one that is new, mended, of another kind
//! or larger does.

use serde::Serialize;

/// What a file of known failures says of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum KnownStatus {
    /// It is listed, and fails as it says there.
    Known,
    /// It fails, and is not listed.
    New,
    /// It is listed, and passes.
    Mended,
    /// It is listed, and fails with another verdict or for another cause.
    Otherwise,
    /// It is listed, and the difference is larger than its bound.
    Worse,
}

impl KnownStatus {
    /// All of them, in the order in which they are counted, with the words used in JSON and on the terminal.
    pub const ALL: [(KnownStatus, &str); 5] = [
        (KnownStatus::Known, "known"),
        (KnownStatus::New, "new"),
        (KnownStatus::Mended, "mended"),
        (KnownStatus::Otherwise, "otherwise"),
        (KnownStatus::Worse, "worse"),
    ];

    /// The word for it.
    pub fn name(self) -> &'static str {
        KnownStatus::ALL[self as usize].1
    }
}

/// The entry of a result in a file of known failures, if it has one, and what is to change there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Known {
    /// What the file says of the result.
    pub status: KnownStatus,
    /// Why the failure is accepted, by a person.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Address of an issue, for example.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub link: Option<String>,
    /// Line of the entry, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// The line to change, with its file, and what to write there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub change: Option<String>,
}

impl Known {
    /// True if the file says what is no longer so.
    pub fn is_outdated(&self) -> bool {
        !matches!(self.status, KnownStatus::Known | KnownStatus::New)
    }

    /// In one line, such as `known: rounds opacities (https://...)`, or what is to change.
    pub fn in_words(&self) -> String {
        let status = self.status.name();
        let is_known = self.status == KnownStatus::Known;
        let words = if is_known { &self.reason } else { &self.change };
        let words = words.as_deref().unwrap_or_default();
        match &self.link {
            Some(link) if is_known => format!("{status}: {words} ({link})"),
            _ => format!("{status}: {words}"),
        }
    }
}

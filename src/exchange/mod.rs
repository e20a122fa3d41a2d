//! A scene for other renderers. What a format cannot say is refused by name, not approximated.

mod bundle;

pub use bundle::bundle;

/// A scene in another format: files to be written into one folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// Name of the file to open; it names the others.
    pub main: String,
    /// Every file: name and contents.
    pub files: Vec<(String, Vec<u8>)>,
}

/// What of a scene a format cannot say.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", reasons.join("; "))]
pub struct Refusal {
    /// Each obstacle, with what to do instead.
    pub reasons: Vec<String>,
}

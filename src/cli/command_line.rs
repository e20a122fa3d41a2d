//! The command line of this process, for what is said again.

use std::ffi::OsString;

/// The command line of this process.
pub fn command_line() -> String {
    command_line_with(|word| word)
}

/// The command line of this process, with each word as `change` has it.
pub fn command_line_with(change: impl Fn(OsString) -> OsString) -> String {
    let words = std::env::args_os().skip(1).map(change);
    let words: Vec<String> = words
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    format!("volref {}", shell_words::join(words))
}

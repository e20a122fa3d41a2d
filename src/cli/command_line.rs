//! The command line of this process, for what is said again.

/// The command line of this process.
pub fn command_line() -> String {
    let words = std::env::args_os().skip(1);
    let words: Vec<String> = words
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    format!("volref {}", shell_words::join(words))
}

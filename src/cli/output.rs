//! Printing that survives a reader who leaves early.

use super::failure::{Exit, Failure};
use crate::atomic_file::write_atomically;
use clap::Args;
use serde::Serialize;
use std::io::Write;
use std::path::PathBuf;

/// Writes `text` to stdout. A closed pipe (`volref list | head -1`) is no error.
pub fn print(text: &str) {
    let mut stdout = std::io::stdout().lock();
    let _ = stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush());
}

/// Writes a failure to stderr.
pub fn print_error(failure: &Failure) {
    let _ = writeln!(std::io::stderr(), "{:?}", failure.report);
}

/// `--json`: the result as JSON instead of text.
#[derive(Args, Debug)]
pub struct Json {
    /// Print the result as JSON instead of text; with =FILE, write it there as well as the text
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "-")]
    json: Option<PathBuf>,
}

impl Json {
    /// The text to print: `text`, or `value` as JSON if asked for on stdout.
    pub fn instead_of(&self, text: String, value: &impl Serialize) -> Result<String, Failure> {
        match &self.json {
            None => Ok(text),
            Some(path) if path.as_os_str() == "-" => Ok(pretty(value)),
            Some(path) => write(path, pretty(value).as_bytes()).map(|()| text),
        }
    }
}

/// `value` as indented JSON with a final newline.
pub fn pretty(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(value).expect("plain data becomes JSON");
    text.push('\n');
    text
}

/// Writes a whole file or nothing.
pub fn write(path: &std::path::Path, bytes: &[u8]) -> Result<(), Failure> {
    write_atomically(path, bytes).map_err(|error| {
        let message = format!("cannot write {}: {error}", path.display());
        Failure::new(
            Exit::BadInput,
            message,
            Some("give a file in a folder that exists and may be written to"),
        )
    })
}

//! Printing that survives a reader who leaves early.

use super::failure::{Exit, Failure};
use crate::atomic_file::{directory_of, remedy, write_atomically};
use clap::Args;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

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
    /// Fails where the file cannot be written: asked before long work, not after it.
    pub fn check(&self) -> Result<(), Failure> {
        match &self.json {
            Some(path) if path.as_os_str() != "-" => check_place(path),
            _ => Ok(()),
        }
    }

    /// Whether the result is to be written over the file at `path`.
    pub fn writes(&self, path: &Path) -> bool {
        let json = self.json.as_ref().map(|json| json.canonicalize());
        matches!((json, path.canonicalize()), (Some(Ok(json)), Ok(path)) if json == path)
    }

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
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_atomically(path, bytes).map_err(|error| {
        let cause = &error.cause;
        let message = format!("cannot write {}: {cause}", path.display());
        Failure::new(Exit::BadInput, message, Some(remedy(cause.kind())))
    })
}

/// Fails where [`write`] is bound to: asked before long work, not after it.
pub fn check_place(path: &Path) -> Result<(), Failure> {
    let what = if path.is_dir() {
        "it is a folder"
    } else if !directory_of(path).is_dir() {
        "its folder does not exist"
    } else {
        return Ok(());
    };
    let message = format!("cannot write {}: {what}", path.display());
    let help = "nothing was rendered; give a file in a folder that exists";
    Err(Failure::new(Exit::BadInput, message, Some(help)))
}

/// Stops of exposure on the command line.
pub fn stops(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(stops) if f64::abs(stops) <= 64.0 => Ok(stops),
        _ => Err("an exposure is a number of stops from -64 to 64, such as -1.5".to_owned()),
    }
}

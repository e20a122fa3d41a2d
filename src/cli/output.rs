//! The door through which all is printed. It survives a reader who leaves early, and lets no control
//! character through that stands in a name, a key or the output of another renderer.

use super::failure::{Exit, Failure};
use super::visible_report::VisibleReport;
use crate::atomic_file::{directory_of, remedy, write_atomically};
use crate::report::{visible, visible_json};
use clap::Args;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes `text` to stdout. A closed pipe (`volref list | head -1`) is no error.
pub fn print(text: &str) {
    let mut stdout = std::io::stdout().lock();
    let _ = stdout
        .write_all(visible(text).as_bytes())
        .and_then(|()| stdout.flush());
}

/// Writes a failure to stderr.
pub fn print_error(failure: &Failure) {
    let shown = miette::Report::new(VisibleReport::of(failure.report.as_ref()));
    let _ = writeln!(std::io::stderr(), "{shown:?}");
}

/// Writes what clap has to say of the command line, or its help. Where the arguments hold control
/// characters, which it repeats, the message goes without colours.
pub fn print_usage(error: &clap::Error) {
    let mut arguments = std::env::args_os();
    let is_plain = arguments.all(|argument| {
        let argument = argument.to_string_lossy();
        visible(&argument) == argument
    });
    let _ = match is_plain || !error.use_stderr() {
        true => error.print(),
        false => write!(std::io::stderr(), "{}", visible(&error.to_string())),
    };
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
    visible_json(&text)
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

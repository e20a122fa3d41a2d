//! Output of all commands. A reader may close the pipe early, and control characters in names, keys
//! or the output of another renderer are never printed.

use super::failure::{Exit, Failure, bad_input, drawn};
use crate::files::atomic_file::{directory_of, file_behind, remedy, write_atomically};
use crate::files::golden_mark;
use crate::files::own_file;
use crate::files::regular_file::{is_input, note_input};
use crate::files::visible::{visible, visible_json};
use crate::judging::Verdict;
use anstream::{AutoStream, ColorChoice};
use clap::Args;
use clap::builder::styling::AnsiColor;
use serde::Serialize;
use serde_json::json;
use std::ffi::OsString;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// First error in writing to stdout.
static STDOUT_ERROR: OnceLock<io::Error> = OnceLock::new();

/// Writes `text` to stdout; [`exit_after_output`] heeds an error.
pub fn print(text: &str) {
    let text = printable(text);
    match is_coloured() {
        true => write_out(&coloured(&text)),
        false => write_out(&text),
    }
}

/// True if standard output is a terminal that shows colours, unless the environment says otherwise (NO_COLOR,
/// CLICOLOR, CLICOLOR_FORCE).
fn is_coloured() -> bool {
    AutoStream::choice(&io::stdout()) != ColorChoice::Never && !is_for_ctest()
}

/// `text` with the verdict at the beginning of a line in its colour.
fn coloured(text: &str) -> String {
    let line = |line: &str| {
        let verdict = VERDICTS
            .into_iter()
            .find(|(verdict, _)| line.starts_with(&format!("{}  ", verdict.name())));
        match verdict {
            Some((verdict, colour)) => {
                let (word, style) = (verdict.name(), colour.on_default());
                format!("{style}{word}{style:#}{}", &line[word.len()..])
            }
            None => line.to_owned(),
        }
    };
    text.split_inclusive('\n').map(line).collect()
}

/// Colours of the verdicts.
const VERDICTS: [(Verdict, AnsiColor); 6] = [
    (Verdict::Pass, AnsiColor::Green),
    (Verdict::Fail, AnsiColor::Red),
    (Verdict::Convention, AnsiColor::Cyan),
    (Verdict::Inconclusive, AnsiColor::Yellow),
    (Verdict::Missing, AnsiColor::Yellow),
    (Verdict::Error, AnsiColor::Magenta),
];

/// Writes `text` to stdout as it is.
pub fn write_out(text: &str) {
    let mut stdout = io::stdout().lock();
    note_error(stdout.write_all(text.as_bytes()));
}

/// Flushes stdout, and records an error of this or of the write before. A closed pipe (`volref list
/// | head -1`) is not an error.
fn note_error(written: io::Result<()>) {
    match written.and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            STDOUT_ERROR.get_or_init(|| error);
        }
        _ => {}
    }
}

/// The exit code of a command that ends with `exit`. Output that could not be written is an error,
/// reported on stderr: a reader would take the part for the whole.
pub fn exit_after_output(exit: Exit) -> Exit {
    let Some(error) = STDOUT_ERROR.get() else {
        return exit;
    };
    let message = format!("cannot write to standard output: {error}");
    let failure = Failure::new(Exit::BadInput, message, Some(remedy(error.kind())));
    write_to_stderr(&failure);
    Exit::first_of([exit, failure.exit])
}

/// [`visible`] text as a stream of this process may hold it.
pub fn printable(text: &str) -> String {
    without_elements(visible(text))
}

/// `text`, with `--ctest` without the start of any element: CTest collects measurements, and files to attach,
/// from all that a test prints, also from the words of a renderer or of a file.
fn without_elements(text: String) -> String {
    if is_for_ctest() {
        text.replace('<', "&lt;")
    } else {
        text
    }
}

/// True if the command line has `--ctest`, even if it cannot be parsed.
fn is_for_ctest() -> bool {
    let asks = |argument: OsString| {
        let argument = argument.to_string_lossy();
        argument == "--ctest" || argument.starts_with("--ctest=")
    };
    std::env::args_os().any(asks)
}

/// Writes a failure to stderr; with `--json`, as an object to stdout as well.
pub fn print_error(failure: &Failure) {
    let diagnostic: &dyn miette::Diagnostic = failure.report.as_ref();
    let help = diagnostic.help().map(|help| help.to_string());
    print_error_object(failure.exit, diagnostic.to_string(), help);
    write_to_stderr(failure);
}

fn write_to_stderr(failure: &Failure) {
    let drawn = without_elements(drawn(failure));
    let _ = writeln!(io::stderr(), "{drawn}");
}

/// The JSON of a command that fails.
fn print_error_object(exit: Exit, message: String, help: Option<String>) {
    let asked = |argument: OsString| argument == "--json" || argument == "--json=-";
    if std::env::args_os().any(asked) {
        print(&pretty(&json!({
            "schema": "volref/error/1",
            "error": message,
            "help": help,
            "exit_code": exit as u8,
        })));
    }
}

/// Writes clap's message about the command line, or the help. If the arguments contain control
/// characters, which the message repeats, it has no colours.
pub fn print_usage(error: &clap::Error) {
    if !error.use_stderr() {
        return note_error(error.print());
    }
    print_error_object(Exit::BadInput, error.to_string(), None);
    let mut arguments = std::env::args_os();
    let is_plain = arguments.all(|argument| {
        let argument = argument.to_string_lossy();
        visible(&argument) == argument
    });
    let _ = if is_plain && !is_for_ctest() {
        error.print()
    } else {
        write!(io::stderr(), "{}", printable(&error.to_string()))
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
    /// The file to write, if any; `-` is standard output.
    pub fn file(&self) -> Option<&Path> {
        let file = self.json.as_deref();
        file.filter(|path| path.as_os_str() != "-")
    }

    /// True if standard output is for JSON alone.
    pub fn is_printed(&self) -> bool {
        self.json.is_some() && self.file().is_none()
    }

    /// The text to print: `text`, or `value` as JSON if asked for on stdout.
    pub fn instead_of(&self, text: String, value: &impl Serialize) -> Result<String, Failure> {
        if self.is_printed() {
            return Ok(pretty(value));
        }
        if let Some(path) = self.file() {
            write(path, pretty(value).as_bytes())?;
        }
        Ok(text)
    }
}

/// Fails if `folder` holds goldens, of this suite or of another: outputs there would be taken for goldens.
pub fn check_no_goldens_in(folder: &Path) -> Result<(), Failure> {
    let Some(golden) = golden_mark::golden_within(folder) else {
        return Ok(());
    };
    let [folder, golden] = [folder, &golden].map(Path::display);
    let message = format!("{folder} holds goldens, such as {golden}");
    let help = "only `volref accept` changes goldens; write elsewhere";
    Err(Failure::new(Exit::BadInput, message, Some(help)))
}

/// `value` as indented JSON with a final newline.
pub fn pretty(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(value).expect("plain data becomes JSON");
    text.push('\n');
    let text = visible_json(&text);
    if is_for_ctest() {
        // Within strings alone, and the same data.
        return text.replace('<', "\\u003c");
    }
    text
}

/// Writes a whole file or nothing, and never over an input or a golden.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    check_no_input(path)?;
    write_atomically(path, bytes).map_err(|error| not_written(path, &error.cause))
}

/// As [`write`], the file `inner` of a folder that the user named: volref chose the name of the
/// file, so that the user cannot have meant a link or pipe of this name.
pub fn write_within(folder: &Path, inner: &Path, bytes: &[u8]) -> Result<PathBuf, Failure> {
    own_file::make_folder(folder, directory_of(inner)).map_err(bad_input)?;
    let path = folder.join(inner);
    check_no_input(&path)?;
    own_file::write(&path, bytes).map_err(|error| not_written(&path, &error.cause))?;
    Ok(path)
}

/// Fails if [`write_within`] would fail, for something other than a file in the place of the file at `path`.
pub fn check_own(path: &Path) -> Result<(), Failure> {
    own_file::check(path).map_err(|cause| not_written(path, &cause))
}

fn not_written(path: &Path, cause: &std::io::Error) -> Failure {
    let message = format!("cannot write {}: {cause}", path.display());
    Failure::new(Exit::BadInput, message, Some(remedy(cause.kind())))
}

/// Fails if [`write`] would fail for one of the outputs, or if one would overwrite another. Called
/// before long work, and again once all inputs are read, since these may name further ones.
pub fn check(outputs: &[Option<&Path>], inputs: &[&Path]) -> Result<(), Failure> {
    inputs.iter().for_each(|input| note_input(input));
    let outputs: Vec<&Path> = outputs.iter().copied().flatten().collect();
    for (index, path) in outputs.iter().enumerate() {
        check_target(path)?;
        let identity = target(path);
        let mut before = outputs[..index].iter();
        if let Some(other) =
            before.find(|other| identity.is_some() && self::target(other) == identity)
        {
            let [path, other] = [path, other].map(|it| it.display());
            let message =
                format!("cannot write {path}: it is the same file as another output, {other}");
            let help = "nothing was done; give each output a file of its own";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
    }
    Ok(())
}

/// The file of an output, without links. Streams have none, since they cannot be overwritten.
fn target(path: &Path) -> Option<PathBuf> {
    let file = file_behind(path)?;
    let folder = directory_of(&file).canonicalize().ok()?;
    Some(folder.join(file.file_name()?))
}

/// Fails if the file at `path` is an input of this command, under any name.
pub fn check_no_input(path: &Path) -> Result<(), Failure> {
    if !is_input(path) {
        return Ok(());
    }
    let path = path.display();
    let message = format!("cannot write {path}: it is an input of this command");
    let help = "it is unchanged; give another file";
    Err(Failure::new(Exit::BadInput, message, Some(help)))
}

/// Fails if [`write`] would fail.
fn check_target(path: &Path) -> Result<(), Failure> {
    let what = if path.is_dir() {
        "it is a folder"
    } else if !directory_of(path).is_dir() {
        "its folder does not exist"
    } else {
        check_no_input(path)?;
        let file = file_behind(path);
        let checked = golden_mark::check(file.as_deref().unwrap_or(path));
        return checked.map_err(|cause| not_written(path, &cause));
    };
    let message = format!("cannot write {}: {what}", path.display());
    let help = "nothing was done; give a file in a folder that exists";
    Err(Failure::new(Exit::BadInput, message, Some(help)))
}

/// Creates a folder for outputs, with its parents; fails if it holds goldens.
pub fn make_folder(folder: &Path) -> Result<(), Failure> {
    own_file::make_folder(folder, Path::new("")).map_err(bad_input)?;
    check_no_goldens_in(folder)
}

/// A number on the command line that `is_right`; else what was `expected`.
pub fn number(text: &str, is_right: impl Fn(f64) -> bool, expected: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| is_right(*number));
    number.ok_or_else(|| expected.to_owned())
}

/// Exposure on the command line, in stops.
pub fn stops(text: &str) -> Result<f64, String> {
    let expected = "an exposure is a number of stops from -64 to 64, such as -1.5";
    number(text, |stops| stops.abs() <= 64.0, expected)
}

//! Errors with exit codes.

use crate::scene::{SceneError, shortened};
use miette::{MietteHandlerOpts, Report};
use std::io::IsTerminal;
use std::process::ExitCode;

/// Exit codes, as DESIGN states them. Where several causes meet, the highest wins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Exit {
    /// All compared and passed.
    Passed = 0,
    /// An image differs.
    Mismatch = 1,
    /// Usage, or bad input.
    BadInput = 2,
    /// A golden is missing, stale or tampered with.
    Golden = 3,
    /// The other renderer's image is missing or unreadable.
    OtherRenderer = 4,
    /// Nothing was compared, or the comparison decided nothing.
    Undecided = 5,
    /// The suite misses a mistake, or rejects what is right.
    SelfTest = 6,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}

/// A command that could not run to its end.
#[derive(Debug)]
pub struct Failure {
    /// For the shell.
    pub exit: Exit,
    /// For stderr.
    pub report: Report,
}

impl Failure {
    /// Any failure, in words.
    pub fn new(exit: Exit, message: impl Into<String>, help: Option<&str>) -> Failure {
        let diagnostic = miette::MietteDiagnostic::new(shortened(message.into()));
        let diagnostic = match help {
            Some(help) => diagnostic.with_help(shortened(help.to_owned())),
            None => diagnostic,
        };
        Failure {
            exit,
            report: Report::new(diagnostic),
        }
    }
}

impl From<Box<SceneError>> for Failure {
    fn from(error: Box<SceneError>) -> Failure {
        Failure {
            exit: Exit::BadInput,
            report: Report::new(*error),
        }
    }
}

/// Colours and line width by the terminal; in a pipe plain text, each message on one line, so
/// that other programs find path, line and column together.
pub fn draw_errors_for_the_terminal() {
    let terminal = std::io::stderr().is_terminal();
    let _ = miette::set_hook(Box::new(move |_| {
        let options = MietteHandlerOpts::new().unicode(true).width(100);
        let options = if terminal {
            options
        } else {
            options.color(false).wrap_lines(false)
        };
        Box::new(options.build())
    }));
}

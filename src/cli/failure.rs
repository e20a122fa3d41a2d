//! Errors with exit codes.

use crate::files::visible::visible;
use crate::judging::{CaseResult, Cause};
use crate::scene::{SceneError, shortened};
use miette::{Diagnostic, MietteHandlerOpts, Report, ReportHandler};
use std::fmt;
use std::io::IsTerminal;
use std::process::ExitCode;

/// Exit codes. If several apply, [`Exit::first_of`] chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All images compared and passed.
    Passed = 0,
    /// An image differs.
    Mismatch = 1,
    /// Wrong usage or bad input.
    BadInput = 2,
    /// A golden is missing, stale or tampered with.
    Golden = 3,
    /// The other renderer's image is missing or unreadable.
    OtherRenderer = 4,
    /// Nothing was compared, or the comparison is inconclusive.
    Undecided = 5,
    /// The suite misses a mistake, or rejects a correct image.
    SelfTest = 6,
}

impl Exit {
    /// All exit codes, in order of precedence: the request cannot be carried out; the goldens, or
    /// the suite, cannot be trusted; an image differs; an image is missing; the comparison is
    /// inconclusive.
    const ORDER: [Exit; 7] = [
        Exit::BadInput,
        Exit::Golden,
        Exit::SelfTest,
        Exit::Mismatch,
        Exit::OtherRenderer,
        Exit::Undecided,
        Exit::Passed,
    ];

    /// The exit code of a command with these outcomes; without any, nothing was compared.
    pub fn first_of(met: impl IntoIterator<Item = Exit>) -> Exit {
        let met: Vec<Exit> = met.into_iter().collect();
        let first = Exit::ORDER.into_iter().find(|exit| met.contains(exit));
        first.unwrap_or(Exit::Undecided)
    }
}

impl From<Cause> for Exit {
    fn from(cause: Cause) -> Exit {
        match cause {
            Cause::None => Exit::Passed,
            Cause::Undecided => Exit::Undecided,
            Cause::OtherRenderer => Exit::OtherRenderer,
            Cause::Mismatch | Cause::Convention => Exit::Mismatch,
            Cause::Golden => Exit::Golden,
            Cause::BadInput => Exit::BadInput,
        }
    }
}

/// Exit codes and their order, for `--help`.
pub const EXIT_CODES: &str = "\
Exit codes: 0 all images compared and passed; 1 mismatch; 2 wrong usage or bad input; 3 golden \
missing, stale or tampered with; 4 image of the other renderer missing or unreadable, or the \
renderer crashed or timed out; 5 nothing compared, or inconclusive; 6 self-test failed. If \
several apply, volref returns the first in the order 2, 3, 6, 1, 4, 5.";

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}

/// A command that failed.
#[derive(Debug)]
pub struct Failure {
    /// Exit code.
    pub exit: Exit,
    /// Message for stderr.
    pub report: Report,
}

impl Failure {
    /// A failure with a message.
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

/// Bad input with a message.
pub fn bad_input(error: impl ToString) -> Failure {
    Failure::new(Exit::BadInput, error.to_string(), None)
}

impl From<Box<SceneError>> for Failure {
    fn from(error: Box<SceneError>) -> Failure {
        Failure {
            exit: Exit::BadInput,
            report: Report::new(*error),
        }
    }
}

/// A message for drawing. Escape codes in the name of a file could not be told from those that colour the message: with
/// such it has no colours, and all control characters are made visible.
pub fn drawn(failure: &Failure) -> String {
    struct Drawn<'d>(&'d dyn Diagnostic, MietteHandlerOpts);
    impl fmt::Debug for Drawn<'_> {
        fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
            self.1.clone().build().debug(self.0, to)
        }
    }
    let message: &dyn Diagnostic = failure.report.as_ref();
    let help = message
        .help()
        .map_or(String::new(), |help| help.to_string());
    let text = message.to_string() + &help;
    let mut options = MietteHandlerOpts::new().unicode(true).width(100);
    // In a pipe plain text, each message on one line: other programs find path, line and column together.
    if !std::io::stderr().is_terminal() {
        options = options.color(false).wrap_lines(false);
    }
    if visible(&text) == text {
        return format!("{:?}", Drawn(message, options));
    }
    visible(&format!("{:?}", Drawn(message, options.color(false))))
}

/// The exit code of these results.
pub fn exit(results: &[CaseResult]) -> Exit {
    Exit::first_of(results.iter().map(|result| result.counted_cause().into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every pair of causes, and each by itself.
    #[test]
    fn of_two_exit_codes_the_one_wins_that_the_help_names_first() {
        let (_, order) = EXIT_CODES.rsplit_once("order ").unwrap();
        let order: Vec<u8> = order
            .trim_end_matches('.')
            .split(", ")
            .map(|code| code.parse().unwrap())
            .chain([0])
            .collect();
        assert_eq!(order, [2, 3, 6, 1, 4, 5, 0]);
        for first in Exit::ORDER {
            for second in Exit::ORDER {
                let rank = |exit: Exit| order.iter().position(|code| *code == exit as u8);
                let expected = if rank(first) <= rank(second) {
                    first
                } else {
                    second
                };
                assert_eq!(Exit::first_of([first, second]), expected);
            }
        }
        assert_eq!(Exit::first_of([]), Exit::Undecided);
    }

    /// Causes of one case weigh as exit codes do.
    #[test]
    fn causes_have_the_order_of_exit_codes() {
        let causes = [
            Cause::None,
            Cause::Undecided,
            Cause::OtherRenderer,
            Cause::Mismatch,
            Cause::Golden,
            Cause::BadInput,
        ];
        for first in causes {
            for second in causes {
                let exit = Exit::first_of([first, second].map(Exit::from));
                assert_eq!(exit, Exit::from(first.max(second)));
            }
        }
    }
}

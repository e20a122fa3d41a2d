//! The command line: arguments to library values, results to text and exit code.
//!
//! One file per command. Only this room prints.

mod accept;
mod command_line;
mod compare;
mod completions;
mod cost;
mod ctest;
mod embedded;
mod export;
mod failure;
mod gallery;
mod help;
mod info;
mod interrupt;
mod kept;
mod known;
mod list;
mod merge;
mod output;
mod page;
mod partition;
mod picture;
mod plan;
mod progress;
mod render;
mod renderer;
mod results;
mod schema;
mod selftest;
mod sensitivity;
mod suite;
mod suite_command;
mod threads;
mod validate;
mod verdicts;
mod verify;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

pub(crate) use embedded::SuiteFiles;
pub use failure::Exit;

/// A reference renderer for volumes, and a golden-image harness that tests other volume renderers
/// against it.
#[derive(Debug, Parser)]
#[command(name = "volref", version, max_term_width = 100)]
#[command(help_template = help::template::<Command>(), before_help = help::EXAMPLE)]
#[command(after_help = failure::EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// True on a machine of a build service, which sets the environment variable `CI`.
fn is_in_ci() -> bool {
    std::env::var_os("CI").is_some_and(|value| !value.is_empty())
}

#[derive(Debug, Subcommand)]
enum Command {
    Verify(verify::Arguments),
    Validate(Box<validate::Arguments>),
    Gallery(gallery::Arguments),
    Compare(compare::Arguments),
    Render(render::Arguments),
    Plan(plan::Arguments),
    Cost(cost::Arguments),
    Export(export::Arguments),
    Accept(accept::Arguments),
    Merge(merge::Arguments),
    Selftest(selftest::Arguments),
    Sensitivity(sensitivity::Arguments),
    Info(info::Arguments),
    List(list::Arguments),
    Suite(suite_command::Arguments),
    Schema(schema::Arguments),
    Completions(completions::Arguments),
}

/// The outcome of a command that succeeded.
struct Outcome {
    /// Text for stdout.
    text: String,
    /// Exit code.
    exit: Exit,
}

impl From<String> for Outcome {
    fn from(text: String) -> Outcome {
        Outcome {
            text,
            exit: Exit::Passed,
        }
    }
}

/// Runs the command of the process, with these files as the suite of the program; returns its exit
/// code.
pub fn main(suite: SuiteFiles) -> ExitCode {
    embedded::hold(suite);
    let exit = output::exit_after_output(run());
    exit.into()
}

fn run() -> Exit {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are answers, not mistakes; clap knows where each belongs.
            let exit = if error.use_stderr() {
                Exit::BadInput
            } else {
                Exit::Passed
            };
            output::print_usage(&error);
            return exit;
        }
    };
    let result = threads::start().and_then(|()| match arguments.command {
        Command::Verify(arguments) => verify::run(arguments),
        Command::Validate(arguments) => validate::run(*arguments),
        Command::Compare(arguments) => progress::during("comparing", || compare::run(arguments)),
        Command::Gallery(arguments) => gallery::run(arguments),
        Command::Render(arguments) => render::run(arguments),
        Command::Plan(arguments) => plan::run(arguments),
        Command::Cost(arguments) => cost::run(arguments),
        Command::Export(arguments) => progress::during("exporting", || export::run(arguments)),
        Command::Accept(arguments) => accept::run(arguments),
        Command::Merge(arguments) => merge::run(arguments),
        Command::Selftest(arguments) => selftest::run(arguments),
        Command::Sensitivity(arguments) => sensitivity::run(arguments),
        Command::Info(arguments) => progress::during("reading", || info::run(arguments)),
        Command::List(arguments) => list::run(arguments),
        Command::Suite(arguments) => suite_command::run(arguments),
        Command::Schema(arguments) => Ok(schema::run(arguments)),
        Command::Completions(arguments) => Ok(completions::run(arguments)),
    });
    match result {
        Ok(outcome) => {
            output::print(&outcome.text);
            outcome.exit
        }
        Err(failure) => {
            output::print_error(&failure);
            failure.exit
        }
    }
}

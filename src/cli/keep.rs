//! `volref __keep PROGRAM ARGUMENTS…`: the keeper process that volref starts for each renderer.

use super::Outcome;
use crate::renderers::{Keeper, keep};
use std::ffi::OsString;

/// Run a renderer, and end all processes that it started; prints the outcome as JSON
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The renderer stays: it answers on standard output what is asked on standard input
    #[arg(long)]
    serve: bool,
    /// The renderer and its arguments
    #[arg(required = true, trailing_var_arg = true, allow_hyphen_values = true)]
    words: Vec<OsString>,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Outcome {
    let kept = keep(&arguments.words, arguments.serve);
    let report = serde_json::to_string(&kept).expect("a report is plain data");
    // A renderer that stays may have printed the beginning of a line.
    Outcome::from(format!("\n{report}\n"))
}

/// This program as the keeper of a renderer, which `stays` or not; `None` on systems without keepers.
pub fn keeper(stays: bool) -> Option<Keeper> {
    // The running program, even if another build has taken its place.
    let program = if cfg!(target_os = "linux") {
        "/proc/self/exe".into()
    } else {
        std::env::current_exe().ok()?
    };
    cfg!(unix).then(|| Keeper {
        program,
        arguments: match stays {
            true => vec![NAME.into(), "--serve".into(), "--".into()],
            false => vec![NAME.into(), "--".into()],
        },
    })
}

/// Name of the command.
pub const NAME: &str = "__keep";

//! `volref __keep PROGRAM ARGUMENTS…`: the keeper process that volref starts for each renderer.

use super::Outcome;
use super::output::pretty;
use crate::renderers::{Keeper, keep};
use std::ffi::OsString;

/// Run a renderer, and end all processes that it started; prints the outcome as JSON
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The renderer and its arguments
    #[arg(required = true, trailing_var_arg = true, allow_hyphen_values = true)]
    words: Vec<OsString>,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Outcome {
    Outcome::from(pretty(&keep(&arguments.words)))
}

/// This program as the keeper of a renderer; `None` on systems without keepers.
pub fn keeper() -> Option<Keeper> {
    // What is running, even if another build has taken its place.
    let program = if cfg!(target_os = "linux") {
        "/proc/self/exe".into()
    } else {
        std::env::current_exe().ok()?
    };
    cfg!(unix).then(|| Keeper {
        program,
        arguments: vec![NAME.into(), "--".into()],
    })
}

/// Name of the command.
pub const NAME: &str = "__keep";

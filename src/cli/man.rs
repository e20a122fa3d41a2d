//! `volref man`

use super::Outcome;
use super::failure::{Exit, Failure, bad_input};
use clap::CommandFactory;
use clap_mangen::Man;

/// Print the manual page of volref or of a command, for `man -l -`
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Command [default: volref itself]
    command: Option<String>,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let mut volref = super::Arguments::command();
    volref.build();
    let mut page = volref.clone();
    if let Some(name) = &arguments.command {
        let Some(command) = volref.find_subcommand(name) else {
            let message = format!("volref has no command {name:?}");
            let help = "volref --help lists the commands";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        };
        page = command.clone().version(env!("CARGO_PKG_VERSION"));
    }
    let mut roff = Vec::new();
    match Man::new(page).render(&mut roff) {
        Ok(()) => Ok(Outcome::from(String::from_utf8_lossy(&roff).into_owned())),
        Err(error) => Err(bad_input(error)),
    }
}

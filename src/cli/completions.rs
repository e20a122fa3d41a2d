//! `volref completions`

use super::Outcome;
use clap::CommandFactory;
use clap_complete::Shell;

/// Print the completions of a shell, which complete commands and options
///
/// bash: volref completions bash > ~/.local/share/bash-completion/completions/volref.
/// zsh: into a folder of $fpath, as _volref. fish: into ~/.config/fish/completions, as volref.fish.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Outcome {
    let mut script = Vec::new();
    let mut command = super::Arguments::command();
    clap_complete::generate(arguments.shell, &mut command, "volref", &mut script);
    Outcome::from(String::from_utf8_lossy(&script).into_owned())
}

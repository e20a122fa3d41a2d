//! `volref completions`

use super::Outcome;
use clap::CommandFactory;
use clap_complete::Shell;

/// Print a shell completion script
///
/// bash: volref completions bash > ~/.local/share/bash-completion/completions/volref
/// zsh:  volref completions zsh > _volref, in a folder of $fpath
/// fish: volref completions fish > ~/.config/fish/completions/volref.fish
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
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

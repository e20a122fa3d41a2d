//! The `volref` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    volref::cli::main()
}

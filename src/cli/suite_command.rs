//! `volref suite [--extract DIR]`

use super::embedded;
use super::failure::{Exit, Failure};
use super::output::{self, Json};
use super::{Outcome, progress};
use indicatif::HumanBytes;
use serde_json::json;
use std::path::PathBuf;

/// Show the suite within this program, or write a copy of it
///
/// Commands use it where the current folder has no suite and --suite names none. It is unpacked into the
/// user's folder for caches (VOLREF_CACHE names another), and is never changed.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Write the suite into DIR, as fixtures/ and golden/: a copy that may be changed
    #[arg(long, value_name = "DIR")]
    extract: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    output::check(&[arguments.json.file()], &[])?;
    let suite = embedded::suite();
    let size = HumanBytes(suite.bytes());
    let mut text = format!(
        "the suite of volref {}: {} files, {size}\n",
        env!("CARGO_PKG_VERSION"),
        suite.count(),
    );
    if let Some(folder) = &arguments.extract {
        for part in ["fixtures", "golden"] {
            let path = folder.join(part);
            if path.symlink_metadata().is_ok() {
                let message = format!("{} exists already", path.display());
                let help = "nothing was written; give a folder without a suite";
                return Err(Failure::new(Exit::BadInput, message, Some(help)));
            }
        }
        progress::during("writing the suite", || suite.unpack(folder)).map_err(|error| {
            let message = format!("cannot write the suite into {}: {error}", folder.display());
            let help = "give a folder that can be created or written to";
            Failure::new(Exit::BadInput, message, Some(help))
        })?;
        let shown = folder.display();
        text.push_str(&format!(
            "written into {shown}\n\nto use it: run commands in that folder, or add --suite {shown}\n"
        ));
    }
    let value = json!({
        "schema": "volref/suite/1",
        "volref": env!("CARGO_PKG_VERSION"),
        "name": suite.name(),
        "files": suite.count(),
        "bytes": suite.bytes(),
        "folder": arguments.extract,
    });
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

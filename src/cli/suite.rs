//! Arguments shared by commands on the suite.

use super::failure::{Exit, Failure};
use crate::regular_file::note_input;
use crate::suite::{CaseResult, Suite, SuiteError};
use std::path::{Path, PathBuf};

/// The default suite.
const HERE: &str = ".";

/// The selected cases of a suite.
#[derive(clap::Args, Debug)]
pub struct Selection {
    /// Folder of the suite, with fixtures/ and golden/
    #[arg(long = "suite", value_name = "DIR", default_value = HERE)]
    folder: PathBuf,
}

impl Selection {
    /// The suite. All its files count as inputs, even unread ones.
    pub fn open(&self) -> Result<Suite, Failure> {
        let suite = Suite::open(&self.folder)?;
        suite.files().iter().for_each(|file| note_input(file));
        Ok(suite)
    }

    /// The command line that repeats `command` for one case of this suite.
    pub fn again(&self, command: &str, case: &str, arguments: &[String]) -> String {
        let mut words = vec!["volref".to_owned(), command.to_owned(), case.to_owned()];
        if self.folder != Path::new(HERE) {
            words.extend(["--suite".to_owned(), self.folder.display().to_string()]);
        }
        shell_words::join(words.iter().chain(arguments))
    }
}

/// Help for a filter that looks like the name of an output.
fn output_help(filter: &str) -> Option<String> {
    let extension = Path::new(filter).extension()?.to_str()?;
    match extension.to_ascii_lowercase().as_str() {
        "json" => Some(format!("to write the results there: --json={filter}")),
        "xml" => Some(format!("to write the results there: --junit {filter}")),
        "html" => Some("to write a page: --report DIR".to_owned()),
        _ => None,
    }
}

/// An unknown case is exit code 5, an unreadable suite 2.
impl From<SuiteError> for Failure {
    fn from(error: SuiteError) -> Failure {
        let (exit, error) = match error {
            SuiteError::NoMatch { filter, help } => {
                let help = output_help(&filter).unwrap_or(help);
                (Exit::Undecided, SuiteError::NoMatch { filter, help })
            }
            error => (Exit::BadInput, error),
        };
        Failure {
            exit,
            report: error.into(),
        }
    }
}

/// The exit code of these results.
pub fn exit(results: &[CaseResult]) -> Exit {
    Exit::first_of(results.iter().map(|result| result.cause.into()))
}

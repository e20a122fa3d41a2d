//! Selection of a suite and its scenes by the arguments of a command.

use super::embedded;
use super::failure::{Exit, Failure};
use crate::files::regular_file::note_input;
use crate::suite::{CACHE, Case, SUITE_VARIABLE, Suite, SuiteError};
use std::path::{Path, PathBuf};

/// The selected cases of a suite.
#[derive(clap::Args, Debug)]
pub struct Selection {
    /// Folder of the suite, with fixtures/ and golden/ [default: that of VOLREF_SUITE, else the
    /// current folder if it has them, else the suite within this program]
    #[arg(long = "suite", value_name = "DIR")]
    folder: Option<PathBuf>,
}

impl Selection {
    /// The suite. All its files count as inputs, even unread ones.
    pub fn open(&self) -> Result<Suite, Failure> {
        let suite = open(self.folder.as_deref())?;
        suite.files().iter().for_each(|file| note_input(file));
        Ok(suite)
    }

    /// The suite, opened for changes.
    pub fn open_to_change(&self) -> Result<Suite, Failure> {
        if self.is_embedded() {
            let message =
                "there is no suite in this folder, and that within volref cannot be changed";
            let help = "write a copy of it with `volref suite --extract DIR`, then add --suite DIR";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
        self.open()
    }

    /// Folder for results of this suite: in the suite, or for the embedded one in the
    /// current folder.
    pub fn kept_folder(&self, suite: &Suite) -> PathBuf {
        match self.is_embedded() {
            true => Path::new(HERE).join(CACHE),
            false => suite.cache_folder(),
        }
    }

    /// True if the suite is that within the program.
    fn is_embedded(&self) -> bool {
        folder_of(self.folder.as_deref()).is_none()
    }

    /// The command line that repeats `command` for one case of this suite.
    pub fn again(&self, command: &str, case: &str, arguments: &[String]) -> String {
        let mut words = ["volref", command, case].map(str::to_owned).to_vec();
        // Whoever repeats the command may have another environment.
        if let Some(folder) = self.folder.clone().or_else(named_suite) {
            words.extend(["--suite".to_owned(), folder.display().to_string()]);
        }
        shell_words::join(words.iter().chain(arguments))
    }
}

/// The current folder.
const HERE: &str = ".";

/// The folder that the environment variable [`VOLREF_SUITE`](SUITE_VARIABLE) names.
fn named_suite() -> Option<PathBuf> {
    let named = std::env::var_os(SUITE_VARIABLE).filter(|folder| !folder.is_empty());
    named.map(PathBuf::from)
}

/// Folder of the suite in use: the one `given`, else the one that the environment names, else the current one if it has a
/// suite; `None` of the suite within the program.
fn folder_of(given: Option<&Path>) -> Option<PathBuf> {
    let here = Path::new(HERE);
    let is_here = || here.join("fixtures/cases").is_dir();
    let outside = given.map(Path::to_owned).or_else(named_suite);
    outside.or_else(|| is_here().then(|| here.to_owned()))
}

/// The suite in use.
fn open(given: Option<&Path>) -> Result<Suite, Failure> {
    match folder_of(given) {
        Some(folder) => Ok(Suite::open(&folder)?),
        None => embedded::open(),
    }
}

/// A scene that was named on the command line.
pub struct NamedScene {
    /// Scene file.
    pub file: PathBuf,
    /// The case, or the file as it was given.
    pub name: String,
    /// Exposure of its 8-bit images, in stops, of a case.
    pub exposure: Option<f64>,
}

/// The scene that `given` names: a file, or a case of the suite.
pub fn named_scene(given: &Path) -> Result<NamedScene, Failure> {
    let as_given = Ok(NamedScene {
        file: given.to_owned(),
        name: given.display().to_string(),
        exposure: None,
    });
    let is_file = given.exists() || given.extension().is_some_and(|it| it == "toml");
    let Some(name) = given.to_str().filter(|_| !is_file) else {
        return as_given;
    };
    let parent = given.parent().filter(|parent| *parent != Path::new(""));
    let is_in_a_place = parent.is_some_and(Path::exists);
    let suite = open(None)?;
    let is_it = |case: &&Case| case.name == name || case.name.ends_with(&format!("/{name}"));
    let cases: Vec<&Case> = suite.cases().iter().filter(is_it).collect();
    match cases[..] {
        [case] => Ok(NamedScene {
            file: case.scene.clone(),
            name: case.name.clone(),
            exposure: Some(case.exposure),
        }),
        // No file either: the error names the nearest case.
        [] if given.extension().is_none() && !is_in_a_place => {
            let nearest = suite.select(&[name.to_owned()]).err();
            let help = nearest.as_ref().and_then(miette::Diagnostic::help);
            let help = help.map(|help| help.to_string());
            let message = format!("no case matches {name:?}, and there is no such file");
            Err(Failure::new(Exit::BadInput, message, help.as_deref()))
        }
        _ => as_given,
    }
}

/// An unknown case is exit code 5, an unreadable suite 2.
impl From<SuiteError> for Failure {
    fn from(error: SuiteError) -> Failure {
        let exit = match error {
            SuiteError::NoMatch { .. } => Exit::Undecided,
            _ => Exit::BadInput,
        };
        Failure {
            exit,
            report: error.into(),
        }
    }
}

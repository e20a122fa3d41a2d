//! `--results`: results kept for `volref merge`.

use super::failure::{Exit, Failure, bad_input};
use super::partition::PartitionArgument;
use super::suite::Selection;
use super::{output, progress};
use crate::files::kept_file::{self, KeepError};
use crate::files::program_hash;
use crate::judging::{CaseTrials, Judged};
use crate::runs::{ResultFolder, Run};
use crate::suite::{Case, Suite};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Setting of a run that has a name.
pub const NAME: &str = "name";

/// Option for the folder of results.
#[derive(clap::Args, Debug)]
pub struct KeepArgument {
    /// Keep the result of each case in DIR, for volref merge [with --partition: .volref of the suite]
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
}

impl KeepArgument {
    /// The folder of results, made now, before long work; `None` if none are kept.
    ///
    /// # Errors
    ///
    /// If it cannot be made.
    pub fn folder(
        &self,
        partition: &PartitionArgument,
        selection: &Selection,
        suite: &Suite,
    ) -> Result<Option<ResultFolder>, Failure> {
        let mut folder = match &self.results {
            Some(folder) => folder.clone(),
            None if partition.is_whole() => return Ok(None),
            None => selection.kept_folder(suite),
        };
        // A link that the user names is meant; one in the place of .volref is not.
        if self.results.is_some() && folder.is_symlink() {
            folder = folder.canonicalize().unwrap_or(folder);
        }
        ResultFolder::open(&folder).check().map_err(bad_input)?;
        // A folder of the user's holds other files, which version control is to see.
        let is_ours = self.results.is_none() || !folder.exists();
        output::make_folder(&folder)?;
        if is_ours {
            kept_file::hide(&folder);
        }
        Ok(Some(ResultFolder::open(folder)))
    }
}

/// The run of a command on `cases` of a suite and on `others`, which have no files, before a part
/// of them is taken.
pub fn run_of<'c>(
    command: &str,
    suite: &Suite,
    filters: &[String],
    cases: impl IntoIterator<Item = &'c Case>,
    others: impl IntoIterator<Item = String>,
    mut settings: BTreeMap<String, String>,
) -> Run {
    let cases = cases
        .into_iter()
        .map(|case| (case.name.clone(), suite.hash_of(case)));
    let others = others.into_iter().map(|name| (name, String::new()));
    let program = program_hash().unwrap_or("unknown");
    settings.extend([
        ("volref".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("build of volref".to_owned(), program.to_owned()),
    ]);
    Run {
        command: command.to_owned(),
        settings,
        cases: cases.chain(others).collect(),
        is_everything: filters.is_empty(),
    }
}

/// Keeps the results `judged` of the cases of `part`; the others of them were passed over.
///
/// # Errors
///
/// If it cannot be written.
pub fn keep(
    folder: &ResultFolder,
    run: &Run,
    part: &[String],
    judged: &[Judged],
) -> Result<(), Failure> {
    keep_with(folder, run, |run| {
        for judged in judged {
            folder.keep(run, &judged.result.name, Some(judged))?;
        }
        let names: BTreeSet<&str> = judged.iter().map(|of| of.result.name.as_str()).collect();
        let passed_over = part.iter().filter(|name| !names.contains(name.as_str()));
        for name in passed_over {
            folder.keep(run, name, None)?;
        }
        Ok(())
    })
}

/// Keeps results once more, with the causes that were found since.
///
/// # Errors
///
/// If it cannot be written.
pub fn keep_again(folder: &ResultFolder, run: &Run, judged: &[Judged]) -> Result<(), Failure> {
    let id = run.id();
    let mut kept = judged.iter();
    let kept = kept.try_for_each(|judged| folder.keep(&id, &judged.result.name, Some(judged)));
    kept.map_err(not_kept)
}

/// Keeps the findings of a self-test in the cases of a part.
///
/// # Errors
///
/// If it cannot be written.
pub fn keep_trials(folder: &ResultFolder, run: &Run, found: &[CaseTrials]) -> Result<(), Failure> {
    keep_with(folder, run, |run| {
        found.iter().try_for_each(|of| folder.keep_trials(run, of))
    })
}

/// Keeps results by `keep`, called with the identifier of the run, and prints their folder.
fn keep_with(
    folder: &ResultFolder,
    run: &Run,
    keep: impl FnOnce(&str) -> Result<(), KeepError>,
) -> Result<(), Failure> {
    let kept = folder.begin(run).and_then(|run| keep(&run).map(|()| run));
    let id = kept.map_err(not_kept)?;
    let place = folder.path().join(id);
    progress::note(&format!("results kept in {}", place.display()));
    Ok(())
}

fn not_kept(error: KeepError) -> Failure {
    let message = format!("the results cannot be kept: {error}");
    let help = "the verdicts hold, but volref merge would miss them; choose another folder with --results DIR";
    Failure::new(Exit::BadInput, message, Some(help))
}

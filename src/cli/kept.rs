//! Which part of a suite a command judges, and results kept for `volref merge`.

use super::failure::{Exit, Failure, bad_input};
use super::partition::PartitionArgument;
use super::suite::Selection;
use super::{output, progress};
use crate::files::program_hash;
use crate::judging::{CaseTrials, Judged, ResultFolder, Run};
use crate::suite::{Case, Suite};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Setting of a run that has a name.
pub const NAME: &str = "name";

/// Options for the suite, the part of its cases, and the folder of results.
#[derive(clap::Args, Debug)]
pub struct PartArguments {
    #[command(flatten)]
    pub selection: Selection,
    #[command(flatten)]
    pub partition: PartitionArgument,
    /// Keep the result of each case in DIR, for volref merge [with --partition: .volref of the suite]
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
}

impl PartArguments {
    /// The results of `command` on `cases`, all of its parts, in a folder that is made now, before long work; `None` if none
    /// are kept.
    ///
    /// # Errors
    ///
    /// If the folder cannot be made.
    pub fn kept(
        &self,
        suite: &Suite,
        command: &str,
        filters: &[String],
        cases: &[&Case],
        mut settings: BTreeMap<String, String>,
    ) -> Result<Option<KeptResults>, Failure> {
        let mut folder = match &self.results {
            Some(folder) => folder.clone(),
            None if self.partition.is_whole() => return Ok(None),
            None => self.selection.kept_folder(suite),
        };
        // A link that the user names is meant; one in the place of .volref is not.
        if self.results.is_some() && folder.is_symlink() {
            folder = folder.canonicalize().unwrap_or(folder);
        }
        let results = ResultFolder::open(&folder);
        results.check().map_err(bad_input)?;
        // A folder of the user's holds other files, which version control is to see.
        let is_ours = self.results.is_none() || !folder.exists();
        output::make_folder(&folder)?;
        if is_ours {
            results.hide();
        }
        let program = program_hash().unwrap_or("unknown");
        settings.extend([
            ("volref".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("build of volref".to_owned(), program.to_owned()),
        ]);
        let hashed = |case: &&Case| (case.name.clone(), suite.hash_of(case));
        let run = Run {
            command: command.to_owned(),
            settings,
            cases: cases.iter().map(hashed).collect(),
            is_everything: filters.is_empty(),
        };
        Ok(Some(KeptResults(results, run)))
    }
}

/// Results of a run that are kept in a folder.
pub struct KeptResults(ResultFolder, Run);

impl KeptResults {
    /// Keeps what was found in the `cases` of a part, and says where.
    ///
    /// # Errors
    ///
    /// If it cannot be written.
    pub fn keep(
        &self,
        cases: &[String],
        judged: &[Judged],
        trials: &[CaseTrials],
    ) -> Result<(), Failure> {
        let KeptResults(folder, run) = self;
        let kept = folder.keep(run, cases.to_vec(), judged, trials.to_vec());
        let place = kept.map_err(|error| {
            let message = format!("the results cannot be kept: {error}");
            let help = "the verdicts hold, but volref merge would miss them; choose another folder with --results DIR";
            Failure::new(Exit::BadInput, message, Some(help))
        })?;
        progress::note(&format!("results kept in {}", place.display()));
        Ok(())
    }
}

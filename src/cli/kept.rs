//! `--results`: results kept for `volref merge`.

use super::failure::{Exit, Failure};
use super::partition::PartitionArgument;
use super::suite::Selection;
use super::{output, progress};
use crate::suite::{Case, Judged, KeepError, ResultFolder, Run, Suite, program_hash};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Where the results of cases are kept.
#[derive(clap::Args, Debug)]
pub struct KeepArgument {
    /// Keep the result of each case in DIR, for volref merge [with --partition: .volref of the suite]
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
}

/// What the folder of results follows from.
type Context<'c> = (&'c PartitionArgument, &'c Selection, &'c Suite);

/// What a command is to judge, before a part of it is taken.
pub struct Whole {
    pub command: &'static str,
    /// Names, each with a hash of what the case is judged by.
    pub cases: Vec<(String, String)>,
    /// Whether no filter left any out.
    pub is_everything: bool,
}

impl Whole {
    pub fn new<'c>(
        command: &'static str,
        suite: &Suite,
        filters: &[String],
        cases: impl IntoIterator<Item = &'c Case>,
        others: impl IntoIterator<Item = String>,
    ) -> Whole {
        let cases = cases
            .into_iter()
            .map(|case| (case.name.clone(), suite.hash_of(case)));
        let others = others.into_iter().map(|name| (name, String::new()));
        Whole {
            command,
            cases: cases.chain(others).collect(),
            is_everything: filters.is_empty(),
        }
    }
}

impl KeepArgument {
    /// Whether results are kept.
    pub fn keeps(&self, partition: &PartitionArgument) -> bool {
        self.results.is_some() || !partition.is_whole()
    }

    /// Where results are to be kept, made if need be.
    fn folder(&self, (partition, selection, suite): Context<'_>) -> Option<PathBuf> {
        match &self.results {
            Some(folder) => Some(folder.clone()),
            None if partition.is_whole() => None,
            None => Some(selection.kept_folder(suite)),
        }
    }

    /// Fails if results are to be kept where they cannot be; called before long work.
    ///
    /// # Errors
    ///
    /// If the folder cannot be made.
    pub fn check(&self, context: Context<'_>) -> Result<(), Failure> {
        match self.folder(context) {
            Some(folder) => output::make_folder(&folder),
            None => Ok(()),
        }
    }

    /// Keeps what was `judged`, if it is to be kept: of `part`, whatever was not judged was passed over.
    ///
    /// # Errors
    ///
    /// If it cannot be written.
    pub fn keep(
        &self,
        whole: Whole,
        mut settings: BTreeMap<String, String>,
        part: &[String],
        judged: &[Judged],
        context: Context<'_>,
    ) -> Result<(), Failure> {
        let Some(root) = self.folder(context) else {
            return Ok(());
        };
        let program = program_hash().unwrap_or("unknown");
        settings.extend([
            ("volref".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("build of volref".to_owned(), program.to_owned()),
        ]);
        let run = Run {
            command: whole.command.to_owned(),
            settings,
            cases: whole.cases,
            is_everything: whole.is_everything,
        };
        let folder = ResultFolder::open(root);
        let keep = || -> Result<(), KeepError> {
            folder.begin(&run)?;
            for judged in judged {
                folder.keep(&run, &judged.result.name, Some(judged))?;
            }
            let names: BTreeSet<&str> = judged.iter().map(|of| of.result.name.as_str()).collect();
            let passed_over = part.iter().filter(|name| !names.contains(name.as_str()));
            for name in passed_over {
                folder.keep(&run, name, None)?;
            }
            Ok(())
        };
        let kept = keep();
        if kept.is_ok() {
            let place = folder.path().join(run.id());
            progress::note(&format!("results kept in {}", place.display()));
        }
        kept.map_err(|error| {
            let message = format!("the results cannot be kept: {error}");
            let help = "the verdicts hold, but volref merge would miss them; choose another folder with --results DIR";
            Failure::new(Exit::BadInput, message, Some(help))
        })
    }
}

//! `--results`: results kept for `volref merge`.

use super::failure::{Exit, Failure};
use super::partition::PartitionArgument;
use super::suite::Selection;
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

/// What a command is to judge, before a part of it is taken.
pub struct Whole {
    pub command: &'static str,
    pub cases: Vec<String>,
    /// Whether no filter left any out.
    pub is_everything: bool,
    /// Hash of what the cases are judged by.
    pub suite: String,
}

impl Whole {
    pub fn new<'c>(
        command: &'static str,
        suite: &Suite,
        filters: &[String],
        cases: impl IntoIterator<Item = &'c Case> + Clone,
        others: impl IntoIterator<Item = String>,
    ) -> Whole {
        let names = cases.clone().into_iter().map(|case| case.name.clone());
        Whole {
            command,
            cases: names.chain(others).collect(),
            is_everything: filters.is_empty(),
            suite: suite.hash_of(cases),
        }
    }
}

impl KeepArgument {
    /// Whether results are kept.
    pub fn keeps(&self, partition: &PartitionArgument) -> bool {
        self.results.is_some() || !partition.is_whole()
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
        (partition, selection, suite): (&PartitionArgument, &Selection, &Suite),
    ) -> Result<(), Failure> {
        let root = match &self.results {
            Some(folder) => folder.clone(),
            None if partition.is_whole() => return Ok(()),
            None => selection.kept_folder(suite),
        };
        let program = program_hash().unwrap_or("unknown");
        settings.extend([
            ("suite".to_owned(), whole.suite),
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
        keep().map_err(|error| {
            let message = format!("the results cannot be kept: {error}");
            let help = "the verdicts hold, but volref merge would miss them; choose another folder with --results DIR";
            Failure::new(Exit::BadInput, message, Some(help))
        })
    }
}

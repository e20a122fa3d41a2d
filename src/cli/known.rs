//! Options of `validate` for known failures.

use super::failure::{Exit, Failure, exit};
use super::{is_in_ci, output};
use crate::files::regular_file::{self, note_input};
use crate::judging::{CaseResult, Judged, KnownFailures, KnownStatus};
use crate::suite::Suite;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Longest file read: 4 MiB, far more than a suite has cases for.
const MOST_BYTES: u64 = 1 << 22;

/// The known failures of a renderer.
#[derive(clap::Args, Debug)]
pub struct KnownArgument {
    /// Known failures: a TOML file with a table for each case or pattern, such as ["sampled/opaque"] or
    /// ["sampled !sampled/opaque"], and in it reason, and if wanted verdict, cause, bound, share and link. They do not
    /// fail the run; one that is new, mended or worse does
    #[arg(long, value_name = "FILE")]
    known: Option<PathBuf>,
    /// Make or update the file of --known: new failures come in, without a reason, and mended ones go out. The exit code
    /// is 0 then, unless an image that cannot be listed is missing, undecided or without a valid golden
    #[arg(long, requires = "known")]
    known_update: bool,
}

/// A file of known failures that a run is held against.
pub struct KnownFile<'a> {
    path: &'a Path,
    known: KnownFailures,
    is_updated: bool,
}

impl KnownArgument {
    /// The file, if one was given; it names cases of the `suite`.
    pub fn read(&self, suite: &Suite) -> Result<Option<KnownFile<'_>>, Failure> {
        let Some(path) = self.known.as_deref() else {
            return Ok(None);
        };
        if self.known_update && is_in_ci() {
            let message = "--known-update changes a file, and the environment variable CI is set";
            let help = "run it where you work, give each new failure a reason, and commit the file";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
        let shown = path.display().to_string();
        let text = match self.known_update && !path.exists() {
            true => String::new(),
            false => text_of(path)?,
        };
        match self.known_update {
            true => output::check(&[Some(path)], &[])?,
            false => note_input(path),
        }
        Ok(Some(KnownFile {
            path,
            known: KnownFailures::parse(&text, &shown, suite, self.known_update)?,
            is_updated: self.known_update,
        }))
    }
}

fn text_of(path: &Path) -> Result<String, Failure> {
    let read = regular_file::read_unnoted(path, MOST_BYTES).map_err(|error| error.to_string());
    let text = read.and_then(|bytes| String::from_utf8(bytes).map_err(|error| error.to_string()));
    text.map_err(|error| {
        let message = format!("cannot read the known failures {}: {error}", path.display());
        let help = "--known-update writes the file";
        Failure::new(Exit::BadInput, message, Some(help))
    })
}

impl KnownFile<'_> {
    /// Notes in `result` what the file says of it.
    pub fn mark(&self, result: &mut CaseResult) {
        result.known = self.known.of(result);
    }

    /// Notes what the file says of all results, now that causes were searched; rewrites it if that was asked for.
    /// Returns the text to print.
    pub fn finish(&self, judged: &mut [Judged]) -> Result<String, Failure> {
        for judged in judged.iter_mut() {
            self.mark(&mut judged.result);
        }
        let results: Vec<&CaseResult> = judged.iter().map(|judged| &judged.result).collect();
        let text = self.in_words(&results);
        if !self.is_updated {
            return Ok(text);
        }
        let known = results.iter().filter_map(|it| it.known.as_ref());
        if known.clone().all(|known| known.change.is_none()) {
            return Ok(text + "the file of known failures is as it was\n");
        }
        let path = self.path.display();
        output::write(self.path, self.known.updated(&results).as_bytes())?;
        let new = count(results.iter().copied(), KnownStatus::New);
        Ok(text + &format!("{path} is written; {new} new entries need a reason\n"))
    }

    /// The exit code: after an update all failures that can be listed are.
    pub fn exit(&self, results: &[CaseResult]) -> Exit {
        if !self.is_updated {
            return exit(results);
        }
        let others = results.iter().filter(|result| result.known.is_none());
        let others = others.map(|result| result.cause.into());
        Exit::first_of(others.chain([Exit::Passed]))
    }

    /// A line of counts, and one for each result of which the file does not say what is so.
    fn in_words(&self, results: &[&CaseResult]) -> String {
        let counts =
            KnownStatus::ALL.map(|(status, name)| (count(results.iter().copied(), status), name));
        let counts = counts.iter();
        let counts = counts.filter(|(count, name)| *count > 0 || *name == "known");
        let counts = counts.map(|(count, name)| format!("{count} {name}"));
        let counts: Vec<String> = counts.collect();
        let mut text = format!("\nknown failures: {}\n", counts.join(", "));
        for known in results.iter().filter_map(|result| result.known.as_ref()) {
            if let Some(change) = &known.change {
                text.push_str(&format!("{:<12}  {change}\n", known.status.name()));
            }
        }
        text
    }
}

fn count<'r>(results: impl Iterator<Item = &'r CaseResult>, status: KnownStatus) -> usize {
    let known = results.filter_map(|result| result.known.as_ref());
    known.filter(|known| known.status == status).count()
}

/// Adds the counts to the `summary` of results as JSON.
pub fn count_in(summary: &mut Value, results: &[CaseResult]) {
    for (status, name) in KnownStatus::ALL {
        summary[name] = json!(count(results.iter(), status));
    }
}

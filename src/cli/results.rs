//! Result files of `verify` and `validate`.

use super::command_line::command_line;
use super::failure::{Exit, Failure};
use super::known::count_in;
use super::output::{self, Json};
use super::page::ReportPage;
use crate::judging::{CaseResult, Judged, JudgedWith};
use crate::naming::Diagnosis;
use crate::report::{self, Page};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Destinations of the results.
#[derive(clap::Args, Debug)]
pub struct ResultFiles {
    #[command(flatten)]
    pub json: Json,
    /// Write the results as JUnit XML, for build servers
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    #[command(flatten)]
    pub page: ReportPage,
}

/// Results of a command on the suite.
#[derive(Default)]
pub struct Findings<'f> {
    /// `verify` or `validate`.
    pub command: &'f str,
    /// Result and evidence of each case.
    pub judged: Vec<Judged>,
    /// Findings of the search for the mistakes behind the images.
    pub found: Diagnosis,
    /// What loosens the judgements.
    pub judged_with: JudgedWith,
    /// True if the results are held against known failures.
    pub has_known: bool,
    /// Command, and how images were read.
    pub origin: Option<Value>,
}

impl Findings<'_> {
    /// The results alone.
    pub fn results(&self) -> Vec<CaseResult> {
        let judged = self.judged.iter();
        judged.map(|judged| judged.result.clone()).collect()
    }
}

impl ResultFiles {
    /// Fails if a file cannot be written; called before long work.
    pub fn check(&self) -> Result<(), Failure> {
        let page = self.page.file();
        self.page.check()?;
        let outputs = [self.json.file(), self.junit.as_deref(), page.as_deref()];
        output::check(&outputs, &[])
    }

    /// Fails if files are asked for that only results fill.
    pub fn check_no_results(&self) -> Result<(), Failure> {
        if self.junit.is_none() && !self.page.is_asked() {
            return Ok(());
        }
        let message =
            "--junit and --report write results of verify or validate, and there are none here";
        Err(Failure::new(Exit::Undecided, message, None))
    }

    /// Writes the requested files, and returns the text to print: `text`, or JSON instead.
    pub fn write(&self, findings: Findings<'_>, mut text: String) -> Result<String, Failure> {
        let both = |judged: Judged| (judged.result, judged.evidence);
        let (results, evidence): (Vec<_>, Vec<_>) = findings.judged.into_iter().map(both).unzip();
        if let Some(path) = &self.junit {
            let junit = report::results_junit(&results, &findings.judged_with);
            output::write(path, junit.as_bytes())?;
        }
        let page = Page {
            title: &format!("volref {}", findings.command),
            command: &command_line(),
            judged_with: &findings.judged_with.in_words(),
            results: &results,
            evidence: &evidence,
            found: &findings.found,
        };
        self.page.write(&page, &mut text)?;
        let mut json = report::results_json(findings.command, &results);
        if findings.command == "validate" {
            json["looks_like"] = json!(findings.found.likely);
            json["judged_with"] = json!(findings.judged_with);
        }
        if findings.has_known {
            count_in(&mut json["summary"], &results);
        }
        if let Some(origin) = &findings.origin {
            json["origin"] = origin.clone();
        }
        self.json.instead_of(text, &json)
    }
}

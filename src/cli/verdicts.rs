//! Printed verdicts of `validate`, and the search for the mistakes behind failures.

use super::progress;
use super::{interrupt, is_in_ci, output};
use crate::conventions::Profile;
use crate::judging::{CaseResult, Cause, Judged, JudgedWith, Verdict};
use crate::naming::{ConventionSearch, Diagnosis, Predictions, Search, SearchStep, diagnosis};
use crate::report;
use crate::suite::{Case, Suite};
use std::time::Duration;

/// Output while cases are judged.
pub struct PrintedVerdicts {
    /// True if verdicts are printed: not if standard output is for JSON.
    pub speaks: bool,
    /// Length of the longest name.
    pub widest: usize,
    /// True if cases without an image are only counted.
    pub folds_missing: bool,
    /// True if cases that noise leaves open are decided later.
    pub waits: bool,
}

impl PrintedVerdicts {
    pub fn print(&self, text: &str) {
        if self.speaks {
            output::print(text);
        }
    }

    /// True if `result` is not listed.
    fn folds(&self, result: &CaseResult) -> bool {
        let is_missing = (result.verdict, result.cause) == (Verdict::Missing, Cause::OtherRenderer);
        self.folds_missing && is_missing
    }

    pub fn verdict(&self, result: &CaseResult) {
        if !self.folds(result) {
            self.print(&report::verdict_text(result, self.widest));
        }
    }

    /// Prints how many cases are not listed, how many have each verdict, and what loosens the judgements.
    pub fn summary(&self, results: &[CaseResult], judged_with: &JudgedWith) {
        let folded = results.iter().filter(|result| self.folds(result)).count();
        if folded > 0 {
            let cases = report::number_of(folded, "case");
            self.print(&format!("{cases} without an image; --verbose lists them\n"));
        }
        self.print(&report::summary_text(results));
        self.print(&report::judged_with_text(judged_with));
    }
}

/// Option for the search for the cause of a failure.
#[derive(clap::Args, Debug)]
pub struct ExplainArgument {
    /// Limit of the search for the cause of each failing image, after all verdicts: time budget in seconds of a two-core
    /// machine. Work is counted, so results do not depend on the machine; 0 for no search [default: 10; 0 where the
    /// environment variable CI is set, unless --accept-conventions asks for the search]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = search_time)]
    explain: Option<f64>,
}

/// A time limit for the search: not negative, and finite.
fn search_time(text: &str) -> Result<f64, String> {
    let expected = "the time for a search is a number of seconds up to 1e9; 0 means no search";
    output::number(text, |it| (0.0..=1e9).contains(&it), expected)
}

/// The search for the causes of failures: conventions first, then mistakes.
pub struct CauseSearch {
    /// Limit of the work for each case.
    seconds: f64,
    /// True if nobody gave a limit: there is no search where CI is set.
    is_left_out: bool,
}

impl CauseSearch {
    /// Runs `work` with a search within the limit of `argument`; `is_asked` if a verdict depends on it. A first Ctrl-C
    /// ends the search alone.
    pub fn run<T>(
        argument: &ExplainArgument,
        is_asked: bool,
        work: impl FnOnce(&mut CauseSearch) -> T,
    ) -> T {
        let is_wanted = is_asked || !is_in_ci();
        let default = if is_wanted { Search::BUDGET } else { 0 };
        let mut search = CauseSearch {
            seconds: argument.explain.unwrap_or(default.into()),
            is_left_out: argument.explain.is_none(),
        };
        interrupt::can_be_cut_short(|| work(&mut search))
    }

    /// Says that a search for the causes of failures begins, if there are any.
    pub fn announce(&self, judged: &[Judged]) {
        let failed = judged.iter().filter(|judged| judged.differs()).count();
        if failed > 0 && self.seconds > 0.0 {
            progress::note(&format!(
                "looking for the mistake in failing cases ({failed}), at most {} s of work for each (--explain 0 skips \
                 the search)",
                self.seconds
            ));
        }
    }

    /// Searches the conventions behind images of `cases` that differ, and prints each verdict that changes by them: a
    /// pass if they are `accepted`.
    pub fn conventions(
        &mut self,
        suite: &Suite,
        cases: &[&Case],
        judged: &mut [Judged],
        accepted: bool,
        said: &PrintedVerdicts,
    ) {
        let failed = judged.iter().filter(|judged| judged.differs()).count();
        if failed == 0 || self.seconds == 0.0 {
            return;
        }
        let store = suite.store();
        let bar = progress::image("looking for the mistake");
        let report = |step: &SearchStep| progress::mistake(&bar, step);
        let search = ConventionSearch::watched(&interrupt::is_cut_short, &report);
        let mut heading = "\nafter the search for conventions:\n";
        for judged in judged.iter_mut().filter(|judged| judged.differs()) {
            let case = cases.iter().find(|case| case.name == judged.result.name);
            let Some(case) = case.filter(|_| !interrupt::is_cut_short()) else {
                continue;
            };
            search.explain_mismatch(case, &store, judged, self.seconds, accepted);
            if judged.result.verdict == Verdict::Convention {
                bar.suspend(|| {
                    said.print(std::mem::take(&mut heading));
                    said.verdict(&judged.result);
                });
            }
        }
    }

    /// Names the likely mistakes behind failed images; returns also the text to print.
    pub fn mistakes(
        &mut self,
        cases: &[&Case],
        profile: Option<&Profile>,
        judged: &mut [Judged],
    ) -> (Diagnosis, String) {
        let is_open = |judged: &&Judged| judged.result.search_ended == Some(false);
        let failed = judged.iter().filter(is_open).count();
        if failed == 0 || self.seconds == 0.0 {
            let said = if failed > 0 && self.is_left_out {
                LEFT_OUT
            } else {
                ""
            };
            return (Diagnosis::default(), said.to_owned());
        }
        let bar = progress::image("looking for the mistake");
        let search = Search {
            budget: Some(Duration::from_secs_f64(self.seconds)),
            predictions: &Predictions::default(),
            interrupted: &interrupt::is_cut_short,
            progress: &|step| progress::mistake(&bar, step),
        };
        let found = diagnosis(cases, profile, judged, &search);
        let text = report::likely_text(&found, self.seconds);
        (found, text)
    }
}

/// Said where CI is set and nobody asked for the search.
const LEFT_OUT: &str = "\nno cause was looked for, since the environment variable CI is set; --explain 10 looks for it\n";

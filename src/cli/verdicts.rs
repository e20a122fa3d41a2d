//! Printed verdicts of `validate`, and the search for the mistakes behind failures.

use super::{interrupt, output, progress};
use crate::conventions::Profile;
use crate::judging::{CaseResult, Cause, Judged, Verdict};
use crate::naming::{Likenesses, Predictions, Search, is_number_found, likeness};
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

    /// Number of cases not listed.
    pub fn without_image(&self, results: &[CaseResult]) -> String {
        let folded = results.iter().filter(|result| self.folds(result));
        let names: Vec<&str> = folded.map(|result| result.name.as_str()).collect();
        report::without_image_text(&names)
    }
}

/// Names the likely mistakes behind failed images, within `explain` seconds; returns also the text
/// to print. Ctrl-C ends the search.
pub fn named(
    explain: f64,
    suite: &Suite,
    cases: &[&Case],
    profile: Option<&Profile>,
    judged: &mut [Judged],
) -> (Likenesses, String) {
    let failed = judged.iter().filter(|judged| judged.differs()).count();
    if failed == 0 || explain == 0.0 {
        return (Likenesses::default(), String::new());
    }
    let predictions = Predictions::of_the_user();
    if let Some(reason) = predictions.refusal() {
        progress::note(&format!("the cache of predictions is not used: {reason}"));
    }
    let (found, was_cut_short) = interrupt::can_be_cut_short(|| {
        let bar = progress::mistakes(failed, explain);
        let search = Search {
            budget: Some(Duration::from_secs_f64(explain)),
            predictions: &predictions,
            interrupted: &interrupt::is_cut_short,
            progress: &|step| progress::mistake(&bar, step),
        };
        let found = likeness(cases, suite.cases(), profile, judged, &search);
        bar.finish_and_clear();
        for judged in judged.iter_mut() {
            if has_finding(&judged.result) {
                judged.result.drop_as_if();
            }
        }
        found
    });
    let text = report::likely_text(&found, was_cut_short, explain);
    (found, text)
}

/// True if a mistake is named, or a change of numbers that was rendered agrees with the image.
fn has_finding(result: &CaseResult) -> bool {
    !result.looks_like.is_empty() || is_number_found(&result.difference)
}

//! Results for people.

use crate::compare::Gate;
use crate::suite::{CaseResult, ERROR_OF_TOLERANCE, Likeness, Summary, Verdict};

/// A line for each case, the reason below each that did not pass, and a summary.
pub fn results_text(results: &[CaseResult]) -> String {
    let widest = results
        .iter()
        .map(|result| result.name.len())
        .max()
        .unwrap_or(0);
    let mut text = String::new();
    for result in results {
        let verdict = result.verdict.name();
        text.push_str(&format!(
            "{verdict:<12}  {:<widest$}  {:>6.2} s",
            result.name, result.seconds
        ));
        if let (Verdict::Pass, Some(&share)) =
            (result.verdict, result.metrics.get(ERROR_OF_TOLERANCE))
        {
            text.push_str(&format!("  {:>6}", closeness(share)));
            if result.gate == Gate::Analytic {
                text.push_str(&format!("  {}", result.reason));
            }
        }
        text.push('\n');
        if result.verdict != Verdict::Pass {
            for line in result.reason.lines() {
                text.push_str(&format!("              {line}\n"));
            }
        }
        for note in &result.notes {
            text.push_str(&format!("              note: {note}\n"));
        }
    }
    if results
        .iter()
        .any(|result| result.metrics.contains_key(ERROR_OF_TOLERANCE))
    {
        text.push_str(
            "\nThe number is the error of what is known beforehand, as a share of what it may be: \
             0 is exact, 1 the edge.\n",
        );
    }
    let summary = Summary::of(results);
    let counts = [
        (summary.pass, "passed"),
        (summary.fail, "failed"),
        (summary.inconclusive, "inconclusive"),
        (summary.missing, "missing"),
        (summary.error, "in error"),
    ];
    let said: Vec<_> = counts
        .into_iter()
        .filter(|&(count, word)| count > 0 || word == "passed")
        .map(|(count, word)| format!("{count} {word}"))
        .collect();
    let cases = if results.len() == 1 { "case" } else { "cases" };
    text.push_str(&format!(
        "\n{} {cases}: {}\n",
        results.len(),
        said.join(", ")
    ));
    text
}

/// An error as a share of what it may be, in few characters.
fn closeness(share: f64) -> String {
    match share {
        0.0 => "0".to_owned(),
        share if share < 5e-4 => "<0.001".to_owned(),
        share => format!("{share:.3}"),
    }
}

/// What failing images look like, most likely first.
pub fn likely_text(results: &[CaseResult], likely: &[Likeness]) -> String {
    let mut text = String::new();
    for known in likely {
        let cases = if known.of == 1 { "case" } else { "cases" };
        text.push_str(&format!(
            "\nlooks like  {} ({} of {} {cases}",
            known.mistake, known.explains, known.of
        ));
        if known.explains < known.of {
            text.push_str(&format!(": {}", known.cases.join(", ")));
        }
        text.push_str(&format!(")\n            {}\n", known.advice));
    }
    let has_failed = results.iter().any(|result| result.verdict == Verdict::Fail);
    if likely.is_empty() && has_failed {
        text.push_str("\nlooks like no mistake of the catalogue\n");
    }
    text
}

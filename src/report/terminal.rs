//! Results for people.

use crate::suite::{CaseResult, Likeness, Summary, Verdict};

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
            "{verdict:<12}  {:<widest$}  {:>6.2} s\n",
            result.name, result.seconds
        ));
        if result.verdict != Verdict::Pass {
            for line in result.reason.lines() {
                text.push_str(&format!("              {line}\n"));
            }
        }
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

/// What failing images look like, most likely first; nothing if they look like nothing known.
pub fn likely_text(likely: &[Likeness]) -> String {
    let mut text = String::new();
    for Likeness {
        mistake,
        advice,
        explains,
        of,
    } in likely
    {
        let cases = if *of == 1 { "case" } else { "cases" };
        text.push_str(&format!(
            "\nlooks like  {mistake} ({explains} of {of} {cases})\n            {advice}\n"
        ));
    }
    text
}

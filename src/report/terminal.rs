//! Results for people.

use crate::conventions::Profile;
use crate::judging::{CaseResult, Cause, JudgedWith, KnownStatus, Verdict};
use crate::naming::{Diagnosis, NOTHING_KNOWN};
use std::collections::BTreeMap;

/// Length of the longest of `names`; 0 without any.
pub fn widest(names: impl IntoIterator<Item: AsRef<str>>) -> usize {
    let lengths = names.into_iter().map(|name| name.as_ref().len());
    lengths.max().unwrap_or(0)
}

/// A number with its noun: `1 case`, `2 cases`.
pub(crate) fn number_of(number: usize, noun: &str) -> String {
    match number {
        1 => format!("1 {noun}"),
        _ => format!("{number} {noun}s"),
    }
}

/// A line for each family with cases that passed, every other case with its reason, and a summary.
pub(crate) fn families_text(results: &[CaseResult]) -> String {
    let mut families: BTreeMap<&str, (Vec<&CaseResult>, usize)> = BTreeMap::new();
    let mut others = Vec::new();
    for result in results {
        let (passed, all) = families.entry(&result.family).or_default();
        *all += 1;
        match result.verdict {
            Verdict::Pass => passed.push(result),
            _ => others.push(result),
        }
    }
    families.retain(|_, (passed, _)| !passed.is_empty());
    let mut rows = Vec::new();
    for (family, (passed, all)) in families {
        let seconds: f64 = passed.iter().map(|result| result.seconds).sum();
        rows.push((family, format!("{} of {all} pass", passed.len()), seconds));
    }
    let wide = widest(rows.iter().map(|row| row.0));
    let of_counts = widest(rows.iter().map(|row| &row.1));
    let mut text = String::new();
    for (family, passed, seconds) in &rows {
        text.push_str(&format!(
            "{family:<wide$}  {passed:>of_counts$}  {seconds:>7.2} s\n"
        ));
    }
    if !rows.is_empty() && !others.is_empty() {
        text.push('\n');
    }
    text + &verdicts_text(&others) + &summary_text(results)
}

/// A line for each case, the reason below each that did not pass, and a summary.
pub(crate) fn results_text(results: &[CaseResult]) -> String {
    verdicts_text(&results.iter().collect::<Vec<_>>()) + &summary_text(results)
}

fn verdicts_text(results: &[&CaseResult]) -> String {
    let widest = widest(results.iter().map(|result| &result.name));
    let lines = results.iter().map(|result| verdict_text(result, widest));
    lines.collect()
}

/// A line for `result`, whose name is given room for `widest` letters, and the reason below unless
/// it passed.
pub fn verdict_text(result: &CaseResult, widest: usize) -> String {
    let known = result.known.as_ref();
    let known = known.filter(|known| known.status == KnownStatus::Known);
    let verdict = known.map_or(result.verdict.name(), |known| known.status.name());
    let mut text = format!(
        "{verdict:<12}  {:<widest$}  {:>6.2} s",
        result.name, result.seconds
    );
    if let Some(known) = known {
        let words = known.in_words();
        let said = words.split_once(": ").map_or("", |(_, said)| said);
        text.push_str(&format!("\n              {said}\n"));
        return text;
    }
    text.push('\n');
    let mut below: Vec<String> = Vec::new();
    if result.verdict != Verdict::Pass {
        below.extend(result.reason.lines().map(str::to_owned));
    }
    let accepts = match result.cause {
        Cause::None => "--accept-conventions accepted it",
        _ => "--accept-conventions accepts it",
    };
    let profile = result.profile.as_deref();
    match (profile, profile.and_then(Profile::shipped_name)) {
        (_, Some(name)) => below.push(format!("{accepts}; --as {name} judges by that profile")),
        (Some(profile), None) => {
            below.push(format!("{accepts}; --as FILE judges by this file:"));
            below.extend(profile.lines().map(|line| format!("    {line}")));
        }
        (None, None) if result.verdict == Verdict::Convention => below.push(accepts.to_owned()),
        (None, None) => {}
    }
    below.extend(result.notes.iter().map(|note| format!("note: {note}")));
    for line in below {
        text.push_str(&format!("              {line}\n"));
    }
    text
}

/// How many cases there are of each verdict.
pub(super) fn counts_text(results: &[CaseResult]) -> String {
    let counts = Verdict::ALL.map(|(verdict, _, words)| match verdict.count(results) {
        1 if verdict == Verdict::Error => "1 error".to_owned(),
        0 if verdict != Verdict::Pass => String::new(),
        count => format!("{count} {words}"),
    });
    let said = counts.into_iter().filter(|words| !words.is_empty());
    let said: Vec<String> = said.collect();
    format!("{}: {}", number_of(results.len(), "case"), said.join(", "))
}

/// Number of cases by verdict.
pub(crate) fn summary_text(results: &[CaseResult]) -> String {
    format!("\n{}\n", counts_text(results))
}

/// What loosens the judgements; empty where nothing does.
pub(crate) fn judged_with_text(judged_with: &JudgedWith) -> String {
    match judged_with.in_words() {
        words if words.is_empty() => words,
        words => format!("judged with: {words}\n"),
    }
}

/// Likely mistakes, most likely first, and the extent of the search: at most `seconds` of work for each case.
pub fn likely_text(found: &Diagnosis, seconds: f64) -> String {
    let mut text = String::new();
    for known in &found.likely {
        let (mistake, explains, cases) =
            (&known.mistake, known.explains, number_of(known.of, "case"));
        text.push_str(&format!("\nlooks like  {mistake} ({explains} of {cases}"));
        if known.explains < known.of {
            text.push_str(&format!(": {}", known.cases.join(", ")));
        }
        text.push_str(&format!(")\n            {}\n", known.advice));
    }
    let unfinished = &found.unfinished;
    let unexplained = &found.unexplained;
    let mut measured = unexplained
        .iter()
        .filter(|it| !it.difference.is_empty())
        .peekable();
    let is_silent = found.likely.is_empty() && measured.peek().is_none();
    if is_silent && !unexplained.is_empty() && unfinished.is_empty() {
        text.push_str(&format!("\n{NOTHING_KNOWN}\n"));
    }
    for result in measured {
        let case = &result.name;
        let head = if result.change_agrees {
            "a change of a parameter explains it"
        } else {
            &format!("{NOTHING_KNOWN}; measured")
        };
        text.push_str(&format!("\n{case}: {head}:\n"));
        for sentence in &result.difference {
            text.push_str(&format!("            {sentence}\n"));
        }
    }
    if !unfinished.is_empty() {
        let names: Vec<&str> = unfinished.iter().map(|search| &*search.case).collect();
        text.push_str(&format!(
            "\nthe search ended early in {}; run again with --explain {} to continue\n",
            names.join(", "),
            MORE_TIME * seconds
        ));
    }
    text
}

/// Whoever goes on with a search is advised to give it this many times the time: what was rendered
/// is kept, and of the pairs of mistakes hundreds may be left.
const MORE_TIME: f64 = 6.0;

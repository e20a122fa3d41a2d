//! Results for people.

use crate::conventions::Profile;
use crate::judging::{CaseResult, JudgedWith, KnownStatus, Verdict};
use crate::naming::{Likenesses, SearchStep, Stage};
use crate::suite::ERROR_OF_TOLERANCE;
use std::collections::BTreeMap;

/// Length of the longest of `names`; 0 without any.
pub fn widest(names: impl IntoIterator<Item: AsRef<str>>) -> usize {
    let lengths = names.into_iter().map(|name| name.as_ref().len());
    lengths.max().unwrap_or(0)
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
    let rows: Vec<_> = families.into_iter().map(family_row).collect();
    let widths = [0, 1, 2].map(|column| widest(rows.iter().map(|row| &row[column])));
    let mut text = String::new();
    for [family, passed, worst, seconds] in &rows {
        text.push_str(&format!("{family:<0$}  {passed:>1$}", widths[0], widths[1]));
        if widths[2] > 0 {
            text.push_str(&format!("   {worst:<0$}", widths[2]));
        }
        text.push_str(&format!("  {seconds:>7} s\n"));
    }
    if !rows.is_empty() && !others.is_empty() {
        text.push('\n');
    }
    text + &verdicts_text(&others) + &summary_text(results)
}

/// Name, cases that passed of all, worst error of a known answer and seconds of a family.
fn family_row((family, (passed, all)): (&str, (Vec<&CaseResult>, usize))) -> [String; 4] {
    let shares = passed
        .iter()
        .filter_map(|result| result.metrics.get(ERROR_OF_TOLERANCE));
    let worst = shares.copied().reduce(f64::max);
    let worst = worst.map(|share| format!("worst {} of its tolerance", closeness(share)));
    let seconds: f64 = passed.iter().map(|result| result.seconds).sum();
    [
        family.to_owned(),
        format!("{} of {all} pass", passed.len()),
        worst.unwrap_or_default(),
        format!("{seconds:.2}"),
    ]
}

/// Share of the first number of a scene from which on a pass says that less would not be seen: what the suite
/// promises of the mean of an image.
const UNSEEN: f64 = 0.02;

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
    if let (Verdict::Pass, Some(&share)) = (result.verdict, result.metrics.get(ERROR_OF_TOLERANCE))
    {
        text.push_str(&format!("  {:>6}", closeness(share)));
    }
    text.push('\n');
    let mut below: Vec<String> = Vec::new();
    if result.verdict != Verdict::Pass {
        below.extend(result.reason.lines().map(str::to_owned));
    } else if let Some(first) = result.detectable.first()
        && first.words.ends_with('%')
        && first.change > UNSEEN
    {
        below.push(format!(
            "an error below {} would not be seen: --decide beside --run takes more samples",
            first.words
        ));
    }
    let accepts = "--accept-conventions accepts it";
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
    let said: Vec<String> = counts
        .into_iter()
        .filter(|words| !words.is_empty())
        .collect();
    let cases = if results.len() == 1 { "case" } else { "cases" };
    format!("{} {cases}: {}", results.len(), said.join(", "))
}

/// Number of cases by verdict.
pub(crate) fn summary_text(results: &[CaseResult]) -> String {
    let mut text = String::new();
    if results
        .iter()
        .any(|result| result.metrics.contains_key(ERROR_OF_TOLERANCE))
    {
        text.push_str(
            "\nThe number is the error as a fraction of its tolerance: 0 is exact, 1 is the \
            limit.\n",
        );
    }
    text.push_str(&format!("\n{}\n", counts_text(results)));
    text
}

/// What loosens the judgements; empty where nothing does.
pub(crate) fn judged_with_text(judged_with: &JudgedWith) -> String {
    match judged_with.in_words() {
        words if words.is_empty() => words,
        words => format!("judged with: {words}\n"),
    }
}

/// An error as a share of what it may be, in few characters.
fn closeness(share: f64) -> String {
    match share {
        0.0 => "0".to_owned(),
        share if share < 5e-4 => "<0.001".to_owned(),
        share => format!("{share:.3}"),
    }
}

/// Likely mistakes, most likely first, and the extent of the search: at most `seconds` for each
/// case, unless it `was_cut_short` by the user.
pub fn likely_text(found: &Likenesses, was_cut_short: bool, seconds: f64) -> String {
    let mut text = String::new();
    for known in &found.likely {
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
    let unfinished = &found.unfinished;
    let is_said = found.unexplained.iter().any(|it| !it.difference.is_empty());
    if found.likely.is_empty() && !found.unexplained.is_empty() && unfinished.is_empty() && !is_said
    {
        text.push_str(&format!("\n{}\n", found.nothing_known(None)));
    }
    let measured = found
        .unexplained
        .iter()
        .filter(|it| !it.difference.is_empty());
    for result in measured.clone().take(MOST_MEASURED) {
        let case = &result.name;
        let is_open = unfinished.iter().any(|search| search.case == *case);
        let head = if result.change_agrees {
            "a change of a parameter explains it"
        } else if is_open {
            "not explained yet; measured"
        } else {
            &format!("{}; measured", found.nothing_known(Some(case)))
        };
        text.push_str(&format!("\n{case}: {head}:\n"));
        for sentence in &result.difference {
            text.push_str(&format!("            {sentence}\n"));
        }
    }
    let more = measured.count().saturating_sub(MOST_MEASURED);
    if more > 0 {
        text.push_str(&format!(
            "\n{more} more cases that nothing known explains: --json and --report say what was measured\n"
        ));
    }
    if !unfinished.is_empty() {
        let named = ["", "no mistake was found: "][usize::from(found.likely.is_empty())];
        let search = unfinished_text(unfinished, was_cut_short, seconds);
        text.push_str(&format!("\n{named}{search}\n"));
    }
    text
}

/// Sentence on the searches that were ended, by the user or by the limit of work, as many `seconds` take.
fn unfinished_text(unfinished: &[SearchStep], was_cut_short: bool, seconds: f64) -> String {
    // After the mistakes come closer looks at the nearest, and fits.
    let has_tried_all = |of: &SearchStep| of.stage == Stage::Singles && of.done == of.of;
    let why = if was_cut_short {
        "was interrupted".to_owned()
    } else if unfinished.iter().all(has_tried_all) {
        format!("left out closer looks after {seconds} s of work")
    } else {
        format!("reached its limit of {seconds} s of work")
    };
    let name = |of: &SearchStep| {
        let (case, stage) = (&of.case, of.stage.name());
        let done = match of.done == of.of {
            false => format!("{} of {} {stage} tried", of.done, of.of),
            true => format!("all {} {stage} tried", of.of),
        };
        format!("{case} ({done})")
    };
    let mut names: Vec<String> = unfinished.iter().take(MOST_UNFINISHED).map(name).collect();
    if unfinished.len() > MOST_UNFINISHED {
        let more = unfinished.len() - MOST_UNFINISHED;
        names.push(format!("{more} more"));
    }
    format!(
        "the search {why} in {}; run again with --explain {} to continue",
        names.join(", "),
        MORE_TIME * seconds
    )
}

/// Cases whose differences are described rather than counted, at most: three lines each, as for
/// mistakes.
const MOST_MEASURED: usize = 5;

/// Searches that were not finished that are named rather than counted, at most.
const MOST_UNFINISHED: usize = 3;

/// Whoever goes on with a search is advised to give it this many times the time: what was rendered
/// is kept, and of the pairs of mistakes hundreds may be left.
const MORE_TIME: f64 = 6.0;

//! Results of a self-test, for people and for programs.

use super::terminal::widest;
use crate::judging::{MistakeTrials, SelfTest, Trial};
use crate::variations::mistakes;
use serde_json::{Value, json};

/// The matrix of mistakes and cases, the results for correct images, and a verdict.
pub(crate) fn self_test_text(test: &SelfTest) -> String {
    let mut text = String::from("cases\n");
    for (index, case) in test.cases.iter().enumerate() {
        text.push_str(&format!("  {:>2}  {case}\n", index + 1));
    }
    let widest = widest(test.mistakes.iter().map(|row| &row.mistake));
    text.push_str("\nmistakes: x caught, . missed, blank not applicable, ? not tried\n");
    let digits =
        |shown: fn(usize) -> String| -> String { (1..=test.cases.len()).map(shown).collect() };
    let tens = digits(|number| match number / 10 {
        0 => " ".to_owned(),
        tens => tens.to_string(),
    });
    let ones = digits(|number| (number % 10).to_string());
    for line in [tens, ones] {
        text.push_str(format!("  {:<widest$}  {line}", "").trim_end());
        text.push('\n');
    }
    let has_occasion =
        |row: &&MistakeTrials| row.trials.iter().any(|trial| *trial != Trial::NoOccasion);
    for row in test.mistakes.iter().filter(has_occasion) {
        let marks: String = row.trials.iter().map(|trial| mark(*trial)).collect();
        text.push_str(format!("  {:<widest$}  {marks}", row.mistake).trim_end());
        text.push('\n');
    }
    text.push_str("\ncorrect images\n");
    for row in &test.benign {
        let asked = row.accepted + row.rejected.len();
        text.push_str(&format!(
            "  {:<widest$}  {} of {asked} cases accept it\n",
            row.variant, row.accepted
        ));
        for rejection in &row.rejected {
            text.push_str(&format!("      {}: {}\n", rejection.case, rejection.reason));
        }
    }
    for unusable in &test.unusable {
        text.push_str(&format!(
            "\n{} cannot be tested: {}\n",
            unusable.case, unusable.reason
        ));
    }
    for name in &test.uncaught {
        text.push_str(&format!("\n{name} is caught by no case\n"));
    }
    for promise in &test.broken_promises {
        text.push_str(&format!(
            "\nnot caught, although its manifest requires it: {promise}\n"
        ));
    }
    let rejected: usize = test.benign.iter().map(|row| row.rejected.len()).sum();
    text.push_str(&format!(
        "\n{} mistakes caught, {} not; {rejected} correct images rejected\n",
        caught(test),
        test.uncaught.len()
    ));
    text
}

fn caught(test: &SelfTest) -> usize {
    let rows = test.mistakes.iter();
    rows.filter(|row| row.trials.contains(&Trial::Caught))
        .count()
}

fn mark(trial: Trial) -> char {
    match trial {
        Trial::Caught => 'x',
        Trial::Missed => '.',
        Trial::NoOccasion => ' ',
        Trial::NotTried => '?',
    }
}

/// The self-test as JSON.
pub(crate) fn self_test_json(test: &SelfTest) -> Value {
    let cases_where = |row: &MistakeTrials, wanted: Trial| -> Vec<&str> {
        let cases = test.cases.iter().zip(&row.trials);
        cases
            .filter(|(_, trial)| **trial == wanted)
            .map(|(case, _)| case.as_str())
            .collect()
    };
    let mistake = |row: &MistakeTrials| {
        json!({
            "name": row.mistake,
            "advice": mistakes::named(row.mistake).map(|mistake| mistake.advice),
            "caught_by": cases_where(row, Trial::Caught),
            "missed_by": cases_where(row, Trial::Missed),
            "no_occasion": cases_where(row, Trial::NoOccasion),
        })
    };
    let rejected: usize = test.benign.iter().map(|row| row.rejected.len()).sum();
    json!({
        "schema": "volref/selftest/1",
        "cases": test.cases,
        "mistakes": test.mistakes.iter().map(mistake).collect::<Vec<_>>(),
        "benign": test.benign,
        "summary": {
            "mistakes": test.mistakes.len(),
            "caught": caught(test),
            "uncaught": test.uncaught,
            "benign_rejected": rejected,
            "broken_promises": test.broken_promises,
            "unusable": test.unusable,
            "passed": test.passed(),
        },
    })
}

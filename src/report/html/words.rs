//! Sentences of a report.

use crate::compare::NON_FINITE;
use crate::judging::{CaseResult, Verdict};
use crate::naming::{Diagnosis, NOTHING_KNOWN};
use crate::report::terminal::counts_text;

/// The result of the suite in a sentence.
pub(super) fn headline(results: &[CaseResult], found: &Diagnosis) -> String {
    if results.is_empty() {
        return "Nothing was compared.".to_owned();
    }
    let failed = Verdict::Fail.count(results);
    let guess = match found.likely.first() {
        Some(it) => format!(
            "; likely cause of {} of {failed}: “{}”",
            it.explains, it.mistake
        ),
        None if found.searched < failed || !found.unfinished.is_empty() => String::new(),
        None if found.unexplained.iter().all(|it| it.change_agrees) => String::new(),
        None => format!("; {}", NOTHING_KNOWN),
    };
    let is_broken = |result: &&CaseResult| result.metrics.contains_key(NON_FINITE.0);
    let broken = match results.iter().filter(is_broken).count() {
        0 => String::new(),
        count => format!("; NaN or infinity in {count}"),
    };
    format!("{}{broken}{guess}.", counts_text(results))
}

/// A mark that tells verdicts apart without colour.
pub(in crate::report) fn symbol(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "✓",
        Verdict::Fail => "✗",
        Verdict::Convention => "≈",
        Verdict::Inconclusive => "?",
        Verdict::Missing => "○",
        Verdict::Error => "!",
    }
}

/// A number with four digits; whole ones as they are.
pub(in crate::report) fn digits(value: f64) -> String {
    if value == value.trunc() && value.abs() < 1e9 {
        return format!("{value:.0}").replace('-', "−");
    }
    let size = value.abs();
    let text = match size {
        _ if !(1e-3..1e6).contains(&size) => format!("{value:.3e}"),
        _ if size < 0.01 => format!("{value:.6}"),
        _ if size < 0.1 => format!("{value:.5}"),
        _ if size < 1.0 => format!("{value:.4}"),
        _ if size < 100.0 => format!("{value:.3}"),
        _ => format!("{value:.1}"),
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-12.0, "−12"),
            (0.123_456, "0.1235"),
            (0.012_345_6, "0.01235"),
            (0.001_234_56, "0.001235"),
            (3.456_78, "3.457"),
            (1234.56, "1234.6"),
            (-1.234_56e-7, "−1.235e−7"),
            (1e9, "1.000e9"),
        ] {
            assert_eq!(digits(value), text);
        }
    }
}

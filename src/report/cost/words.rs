//! Numbers and verdicts, as text, page and plot write them.

use crate::cost::Cost;
use crate::cost::order::{ConvergenceOrder, OrderVerdict};
use crate::cost::timing::{Machine, Times};
use textwrap::{Options, WordSeparator, WordSplitter, fill};

/// Longest line of plain text.
const WIDEST: usize = 100;

/// The scene, with its panel.
pub(super) fn scene(cost: &Cost) -> String {
    match &cost.panel {
        Some(panel) => format!("{}: {panel}", cost.scene),
        None => cost.scene.clone(),
    }
}

/// The order that was fitted, the expected one, and the verdict with its sign.
pub(super) fn order(order: &ConvergenceOrder) -> String {
    let verdict = match order.verdict {
        OrderVerdict::AsExpected => "✓ as expected",
        OrderVerdict::Otherwise => "✗ not as expected",
        OrderVerdict::Undecided => {
            "? undecided: too few settings count, or the order still changes"
        }
        OrderVerdict::NothingExpected => "– no order is expected",
    };
    format!("{}: {verdict}", fitted(order))
}

/// The order that was fitted beside the expected one: `order 1.99, expected 2`.
pub(super) fn fitted(order: &ConvergenceOrder) -> String {
    let fitted = match order.fitted {
        Some(fitted) => format!("order {fitted:.2}"),
        None => "no order".to_owned(),
    };
    match order.expected {
        Some(expected) => format!("{fitted}, expected {expected}"),
        None => fitted,
    }
}

/// An error, with three digits.
pub(super) fn error(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        _ if !value.is_finite() => value.to_string(),
        _ => format!("{value:.2e}"),
    }
}

/// A mean of counts, with three digits.
pub(super) fn count(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 9.995 => format!("{value:.2}"),
        size if size < 99.95 => format!("{value:.1}"),
        size if size < 999_999.5 => format!("{value:.0}"),
        _ => error(value),
    }
}

/// Unit of a time, and how many seconds it has.
fn unit(seconds: f64) -> (&'static str, f64) {
    match seconds {
        _ if seconds < 0.999_5e-6 => ("ns", 1e-9),
        _ if seconds < 0.999_5e-3 => ("µs", 1e-6),
        _ if seconds < 0.999_5 => ("ms", 1e-3),
        _ => ("s", 1.0),
    }
}

/// Median, least and most: `1.23 (1.20–1.31) µs`.
pub(super) fn times(times: &Times) -> String {
    let (unit, size) = unit(times.median);
    let [median, min, max] = [times.median, times.min, times.max].map(|value| count(value / size));
    let noisy = if times.is_noisy { " noisy" } else { "" };
    format!("{median} ({min}–{max}) {unit}{noisy}")
}

/// The timing environment, as facts; a warning where times are worth nothing.
pub(super) fn machine(machine: &Machine) -> Vec<String> {
    let profile = match machine.profile {
        "release" => "release".to_owned(),
        other => format!("{other} build: counts are valid, times are not"),
    };
    vec![
        machine.processor.clone(),
        format!("{} thread", machine.threads),
        machine.platform.clone(),
        machine.compiler.clone(),
        profile,
        format!("target features {}", machine.target_features),
    ]
}

/// The words of `text` in lines that are at most [`WIDEST`] long, each after `indent` blanks; a
/// word that is longer has a line to itself.
pub(crate) fn wrapped(text: &str, indent: usize) -> String {
    let indent = " ".repeat(indent);
    let options = Options::new(WIDEST).break_words(false);
    let options = options.word_splitter(WordSplitter::NoHyphenation);
    let options = options.word_separator(WordSeparator::AsciiSpace);
    let options = options.initial_indent(&indent).subsequent_indent(&indent);
    fill(text, options) + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!(
            [0.0, 1.234_5e-4, 0.999_9, f64::NAN].map(error),
            ["0", "1.23e-4", "1.00e0", "NaN"]
        );
        assert_eq!(
            [0.0, 2.224_6, 9.996, 123.4, 65_536.0, 1.5e7].map(count),
            ["0", "2.22", "10.0", "123", "65536", "1.50e7"]
        );
    }

    #[test]
    fn long_sentences_are_wrapped() {
        let text = wrapped(&"word ".repeat(50), 4);
        assert!(text.lines().all(|line| line.starts_with("    word")));
        assert!(text.lines().all(|line| line.chars().count() <= WIDEST));
        assert_eq!(text.split_whitespace().count(), 50);
    }
}

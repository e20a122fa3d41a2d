//! Axes, logarithmic or not, and their ticks.

use crate::math::{log10, pow};

/// Kind of the numbers along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measure {
    Number,
    Seconds,
}

/// An axis. Its places are logarithms to base 10, or the numbers themselves.
#[derive(Clone, Debug, Default)]
pub(super) struct Axis {
    pub(super) title: String,
    pub(super) low: f64,
    pub(super) high: f64,
    /// Places with a line, and the label of most.
    pub(super) ticks: Vec<(f64, Option<String>)>,
}

/// Decades of free space at either end.
const MARGIN: f64 = 0.25;
/// Decades up to which 2 and 5 are labelled as well as 1.
const FEW: f64 = 1.8;
/// Decades up to which their parts have lines.
const SOME: f64 = 5.0;

impl Axis {
    /// A logarithmic axis from the least to the largest of the places. Several panels have
    /// the same axis where they are made from the same places.
    pub(super) fn log(title: &str, measure: Measure, values: &[f64]) -> Axis {
        let (low, high) = range(values);
        // A single point has an axis too.
        let widening = (0.5 - (high - low)).max(0.0) / 2.0;
        let (low, high) = (low - MARGIN - widening, high + MARGIN + widening);
        let span = high - low;
        let every = (span / 9.0).ceil().max(1.0);
        let mut ticks = Vec::new();
        for decade in low.floor() as i32..=high.floor() as i32 {
            for part in 1..10 {
                let value = f64::from(decade) + log10(f64::from(part));
                let is_labelled = match part {
                    1 => (f64::from(decade) / every).fract() == 0.0,
                    2 | 5 => span <= FEW,
                    _ => false,
                };
                let is_shown = is_labelled || part == 1 || span <= SOME;
                if is_shown && (low..=high).contains(&value) {
                    ticks.push((value, is_labelled.then(|| label(measure, part, decade))));
                }
            }
        }
        Axis {
            title: title.to_owned(),
            low,
            high,
            ticks,
        }
    }

    /// An axis from the least to the largest of the numbers.
    pub(super) fn linear(title: &str, numbers: &[f64]) -> Axis {
        let (low, high) = range(numbers);
        let span = if high > low { high - low } else { 1.0 };
        let (low, high) = (low - 0.04 * span, high + 0.08 * span);
        let rough = span / 6.0;
        let decade = pow(10.0, log10(rough).floor());
        let steps = [1.0, 2.0, 5.0, 10.0].map(|part| part * decade);
        let step = steps.into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(rough);
        let first = (low / step).ceil();
        let count = ((high / step).floor() - first) as usize;
        let tick = |at: usize| {
            let value = (first + at as f64) * step;
            // Nothing of a tick is below a thousandth of a step.
            let text = format!("{value:.6}");
            let text = text.trim_end_matches('0').trim_end_matches('.');
            let text = if text == "-0" { "0" } else { text };
            (value, Some(text.replace('-', "−")))
        };
        Axis {
            title: title.to_owned(),
            low,
            high,
            ticks: (0..=count).map(tick).collect(),
        }
    }

    /// Share of the axis below a place.
    pub(super) fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

/// The least and the largest; of nothing, 0 and 0.
fn range(values: &[f64]) -> (f64, f64) {
    let low = values.iter().copied().reduce(f64::min).unwrap_or(0.0);
    let high = values.iter().copied().reduce(f64::max).unwrap_or(0.0);
    (low, high)
}

/// `part` times ten to the power of `decade`, with its unit.
fn label(measure: Measure, part: u8, decade: i32) -> String {
    let (unit, of) = match (measure, decade) {
        (Measure::Number, _) => ("", 0),
        (_, ..-6) => (" ns", -9),
        (_, -6..-3) => (" µs", -6),
        (_, -3..0) => (" ms", -3),
        (_, 0..) => (" s", 0),
    };
    let decade = decade - of;
    if (-2..=3).contains(&decade) {
        let decimals = usize::try_from(-decade).unwrap_or(0);
        let value = f64::from(part) * pow(10.0, f64::from(decade));
        return format!("{value:.decimals$}{unit}");
    }
    let factor = match part {
        1 => String::new(),
        _ => format!("{part}·"),
    };
    format!("{factor}10{}{unit}", superscript(decade))
}

/// A number, raised.
fn superscript(number: i32) -> String {
    let raised = |letter: char| match letter {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        // 4 to 9 follow one another, and 0 is in front of where 1 would be.
        _ => char::from_u32(0x2070 + letter.to_digit(10).unwrap_or(0)).unwrap_or(letter),
    };
    number.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        let labels = axis.ticks.iter().filter_map(|(_, label)| label.as_deref());
        labels.collect()
    }

    #[test]
    fn few_decades_have_more_labels() {
        let log = |values: &[f64]| Axis::log("", Measure::Number, values);
        assert_eq!(labels(&log(&[1.0, 2.0])), ["10", "20", "50", "100"]);
        assert_eq!(labels(&log(&[-3.0, 0.0])), ["10⁻³", "0.01", "0.1", "1"]);
        assert_eq!(labels(&log(&[-16.0, -1.0])).first().unwrap(), &"10⁻¹⁶");
        assert!(labels(&log(&[-16.0, -1.0])).len() < 10);
        assert_eq!(labels(&log(&[0.3, 0.3])), ["1", "2", "5"]);
    }

    #[test]
    fn times_have_units() {
        let axis = Axis::log("", Measure::Seconds, &[-7.0, 1.0]);
        assert_eq!(
            labels(&axis),
            [
                "100 ns", "1 µs", "10 µs", "100 µs", "1 ms", "10 ms", "100 ms", "1 s", "10 s"
            ]
        );
    }

    #[test]
    fn numbers_have_round_steps() {
        let axis = Axis::linear("", &[0.0, 1.7]);
        assert_eq!(labels(&axis), ["0", "0.5", "1", "1.5"]);
    }
}

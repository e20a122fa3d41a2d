//! Axes, logarithmic or not, and their ticks.

use crate::math::{log10, pow};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// What numbers along an axis are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measure {
    Number,
    Seconds,
}

/// An axis. Its places are logarithms to base 10, or the numbers themselves.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub(super) title: String,
    pub(super) is_log: bool,
    pub(super) low: f64,
    pub(super) high: f64,
    /// Values with a label.
    pub(super) bold: Vec<f64>,
    /// Values without.
    pub(super) light: Vec<f64>,
    measure: Measure,
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
        let mut bold = Vec::new();
        let mut light = Vec::new();
        let mut decade = low.floor();
        while decade <= high {
            for part in 1..10_u8 {
                let value = decade + log10(f64::from(part));
                let is_labelled = match part {
                    1 => (decade / every).fract() == 0.0,
                    2 | 5 => span <= FEW,
                    _ => false,
                };
                if value < low || value > high {
                    continue;
                }
                if is_labelled {
                    bold.push(value);
                } else if part == 1 || span <= SOME {
                    light.push(value);
                }
            }
            decade += 1.0;
        }
        Axis {
            title: title.to_owned(),
            is_log: true,
            low,
            high,
            bold,
            light,
            measure,
        }
    }

    /// An axis from the least to the largest of the numbers.
    pub(super) fn linear(title: &str, numbers: &[f64]) -> Axis {
        let (low, high) = range(numbers);
        let span = if high > low { high - low } else { 1.0 };
        let (low, high) = (low - 0.04 * span, high + 0.08 * span);
        let rough = span / 6.0;
        let decade = pow(10.0, log10(rough).floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|part| part * decade);
        let step = step
            .into_iter()
            .find(|step| *step >= rough)
            .unwrap_or(rough);
        let first = (low / step).ceil();
        let count = ((high / step).floor() - first) as usize;
        Axis {
            title: title.to_owned(),
            is_log: false,
            low,
            high,
            bold: (0..=count).map(|at| (first + at as f64) * step).collect(),
            light: Vec::new(),
            measure: Measure::Number,
        }
    }

    /// What is written at a place.
    pub(super) fn label(&self, value: f64) -> String {
        if !self.is_log {
            // Nothing of a tick is below a thousandth of a step.
            let text = format!("{:.6}", value);
            let text = text.trim_end_matches('0').trim_end_matches('.');
            return if text == "-0" { "0" } else { text }.replace('-', "−");
        }
        let decade = (value + 1e-9).floor();
        let part = pow(10.0, value - decade).round();
        match self.measure {
            Measure::Seconds => seconds(part, decade as i32),
            Measure::Number => number(part, decade as i32),
        }
    }
}

/// Lets `plotters` draw an axis: its places, with our ticks.
impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value - self.low) / (self.high - self.low);
        limit.0 + (share * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            self.light.clone()
        } else {
            self.bold.clone()
        }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

/// The least and the largest; of nothing, 0 and 0.
fn range(values: &[f64]) -> (f64, f64) {
    let low = values.iter().copied().reduce(f64::min).unwrap_or(0.0);
    let high = values.iter().copied().reduce(f64::max).unwrap_or(0.0);
    (low, high)
}

/// `part` times ten to the power of `decade`.
fn number(part: f64, decade: i32) -> String {
    if (-2..=3).contains(&decade) {
        let decimals = usize::try_from(-decade).unwrap_or(0);
        return format!("{:.decimals$}", part * pow(10.0, f64::from(decade)));
    }
    let power = format!("10{}", superscript(decade));
    if part == 1.0 {
        power
    } else {
        format!("{part}·{power}")
    }
}

fn seconds(part: f64, decade: i32) -> String {
    let (unit, of) = match decade {
        ..-6 => ("ns", -9),
        -6..-3 => ("µs", -6),
        -3..0 => ("ms", -3),
        0.. => ("s", 0),
    };
    format!("{} {unit}", number(part, decade - of))
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

    #[test]
    fn few_decades_have_more_labels() {
        let labels = |values: &[f64]| -> Vec<String> {
            let axis = Axis::log("", Measure::Number, values);
            axis.bold.iter().map(|value| axis.label(*value)).collect()
        };
        assert_eq!(labels(&[1.0, 2.0]), ["10", "20", "50", "100"]);
        assert_eq!(labels(&[-3.0, 0.0]), ["10⁻³", "0.01", "0.1", "1"]);
        assert_eq!(labels(&[-16.0, -1.0]).first().unwrap(), "10⁻¹⁶");
        assert!(labels(&[-16.0, -1.0]).len() < 10);
        assert_eq!(labels(&[0.3, 0.3]), ["1", "2", "5"]);
    }

    #[test]
    fn times_have_units() {
        let axis = Axis::log("", Measure::Seconds, &[-7.0, 1.0]);
        let labels: Vec<_> = axis.bold.iter().map(|value| axis.label(*value)).collect();
        assert_eq!(
            labels,
            [
                "100 ns", "1 µs", "10 µs", "100 µs", "1 ms", "10 ms", "100 ms", "1 s", "10 s"
            ]
        );
    }

    #[test]
    fn numbers_have_round_steps() {
        let axis = Axis::linear("", &[0.0, 1.7]);
        let labels: Vec<_> = axis.bold.iter().map(|value| axis.label(*value)).collect();
        assert_eq!(labels, ["0", "0.5", "1", "1.5"]);
    }
}

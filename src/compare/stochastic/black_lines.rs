//! Test for a row or column of black pixels, where the test image does not count its samples.
//!
//! A mean of samples that are not negative is 0 only if all of them are. By Cantelli's inequality one sample
//! of the reference, of mean μ and variance σ², is 0 with a probability of σ²/(σ² + μ²) at most, all of n with the
//! n-th power of that. The n that makes the test image as noisy as it is follows from its differences from the
//! reference: half of it is taken, for pixels in which rare bright samples are yet to come seem to have many. A
//! renderer that finds light less often than the reference has as many black pixels in the lines beside. The
//! larger of both probabilities is taken for each pixel, and pixels are independent.
//!
//! Source: Cantelli 1928, Atti del Congresso Internazionale dei Matematici 6, 47–59.

use super::super::places::lines as in_words;
use super::blocks::DARK;
use super::comparison::{Axis, Comparison};
use super::hits::all_zero;
use super::pixels::{CAUSES, chance};
use super::variance::Stated;
use crate::math;

/// Lines to either side that are looked at.
const BESIDE: usize = 2;

/// A line of which every pixel is black that should not be.
struct BlackLine {
    axis: Axis,
    line: usize,
    /// Logarithm of an upper bound on its probability, times the number of lines.
    log_probability: f64,
}

/// A reason if such a line has a probability of `level` or less.
pub(super) fn judge_black_lines(comparison: &Comparison<'_>, level: f64) -> Option<String> {
    let [
        Stated::Samples(samples),
        Stated::Nothing | Stated::Renderings(_),
    ] = comparison.stated
    else {
        return None;
    };
    let [golden, test] = comparison.films;
    // Rounding to 8 bits makes black of means that are not.
    if test.quantisation().is_some() {
        return None;
    }
    let (width, height) = (golden.width(), golden.height());
    let number = number_of_samples(comparison, samples);
    let bound = |index: usize| {
        let of_channel = |c: usize| {
            let mean = f64::from(golden.radiance()[index][c]);
            // Nearly black values may be rounded to black.
            (mean > DARK).then(|| all_zero(number, mean, golden.variance_at(index, c) * samples))
        };
        // All channels have to be 0, which is no likelier than that one is.
        (0..3).filter_map(of_channel).reduce(f64::min)
    };
    // By pixel, where the reference is not black.
    let bounds: Vec<Option<f64>> = (0..width * height).map(bound).collect();
    let is_black = |index: usize| test.radiance()[index] == [0.0; 3];
    let mut black = Vec::new();
    for axis in Axis::BOTH {
        let [lines, length] = axis.lines([width, height]);
        let lit = |line: usize| {
            let indices = (0..length).map(move |at| axis.index(width, line, at));
            indices.filter(|&index| bounds[index].is_some())
        };
        let share_beside = |side: std::ops::Range<usize>| {
            let pixels = || side.clone().flat_map(lit);
            let count = pixels().filter(|&index| is_black(index)).count();
            (count + 1) as f64 / (pixels().count() + 1) as f64
        };
        for line in (0..lines).filter(|&line| lit(line).all(is_black)) {
            let before = share_beside(line.saturating_sub(BESIDE)..line);
            let after = share_beside(line + 1..(line + 1 + BESIDE).min(lines));
            // At the border of an image one side has no pixels.
            let beside = [(before, line > 0), (after, line + 1 < lines)];
            let beside = beside.into_iter().filter(|(_, exists)| *exists);
            let beside = beside.map(|(share, _)| share).fold(0.0, f64::max);
            let bounds = lit(line).filter_map(|index| bounds[index]);
            let logs = bounds.map(|bound| math::ln(bound.max(beside)));
            black.push(BlackLine {
                axis,
                line,
                log_probability: logs.sum::<f64>() + math::ln((width + height) as f64),
            });
        }
    }
    let least = black
        .into_iter()
        .min_by(|a, b| a.log_probability.total_cmp(&b.log_probability))?;
    let probability = math::exp(least.log_probability);
    (probability <= level).then(|| {
        let name = least.axis.name();
        format!(
            "{} is black: by the light of the reference there and the {name}s beside it, {}{CAUSES}",
            in_words(name, [least.line; 2]),
            chance("it", probability)
        )
    })
}

/// Half the number of samples of which the test image is the mean, if they are like those of the reference, of
/// which there are so many `samples`; one at least.
fn number_of_samples(comparison: &Comparison<'_>, samples: f64) -> f64 {
    let [golden, test] = comparison.films;
    let (mut squares, mut count) = (0.0, 0.0);
    for (index, (a, b)) in golden.radiance().iter().zip(test.radiance()).enumerate() {
        for c in 0..3 {
            let of_sample = golden.variance_at(index, c) * samples;
            if of_sample > 0.0 {
                let difference = f64::from(b[c]) - f64::from(a[c]);
                squares += difference * difference / of_sample;
                count += 1.0;
            }
        }
    }
    // Differences below those of the golden's own noise say no more.
    let number = (0.5 * count / squares).min(samples);
    if number.is_finite() {
        number.max(1.0)
    } else {
        1.0
    }
}

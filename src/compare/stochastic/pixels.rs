//! Tests of single pixels: too many outliers, differences without noise, black without cause,
//! copied values.

use super::super::significance::{at_least, deviation, holm};
use super::Metrics;
use super::blocks::{DARK, Difference};
use super::comparison::Comparison;
use super::variance::Stated;
use crate::compare::around;
use crate::math;

/// A pixel beyond this many standard errors is counted.
const FAR: f64 = 5.0;

/// Counts of single pixels.
#[derive(Default)]
pub(super) struct PixelDifferences {
    /// Values of each channel.
    values: u64,
    /// Pixels beyond [`FAR`], by channel.
    far: [u64; 3],
    /// Pixels that differ although neither image has noise there, in all channels.
    contrary: u64,
    /// Pixels with noise beyond that of rounding.
    noisy: u64,
    /// Noisy pixels with the same bits in both images.
    copied: u64,
}

impl PixelDifferences {
    pub fn new(comparison: &Comparison<'_>) -> PixelDifferences {
        let [reference, test] = comparison.films;
        let mut pixels = PixelDifferences::default();
        let rounding = comparison.rounding;
        for index in 0..reference.radiance().len() {
            let (a, b) = (reference.radiance()[index], test.radiance()[index]);
            let mut is_noisy = false;
            for c in 0..3 {
                let stated = comparison.films.map(|film| film.variance_at(index, c));
                let difference = Difference::of(a[c].into(), b[c].into(), stated[1], rounding);
                let [guard_a, guard_b] = comparison.shape.guard(stated, f64::from(a[c]));
                let variance = (stated[0] + stated[1]).max(guard_a + guard_b);
                let z = deviation(difference.beyond_rounding(), variance).abs();
                pixels.far[c] += u64::from(z > FAR);
                pixels.contrary += u64::from(z == f64::INFINITY);
                is_noisy |= stated[0].max(stated[1]) > difference.rounding * difference.rounding;
            }
            pixels.values += 1;
            pixels.noisy += u64::from(is_noisy);
            pixels.copied += u64::from(is_noisy && a == b);
        }
        pixels
    }

    /// Test for outliers, where both images state their noise: else that of a pixel is not known.
    pub fn judge_far(&self, level: f64, metrics: &mut Metrics) -> Option<String> {
        // Chebyshev, for any distribution of that variance.
        let each = 1.0 / (FAR * FAR);
        let probabilities = self.far.map(|far| at_least(far, self.values, each));
        let most = self.far[0].max(self.far[1]).max(self.far[2]);
        metrics.push(("far_pixels", most as f64));
        (holm(&probabilities, level) > 0).then(|| {
            format!(
                "{most} of {} pixels are off by more than {FAR} standard errors; noise of any \
                 distribution would put at most 1 pixel in {} that far off",
                self.values,
                FAR * FAR
            )
        })
    }

    /// Test for differences without noise; `samples` are those of a pixel of both images.
    pub fn judge_contrary(
        &self,
        samples: [u32; 2],
        level: f64,
        metrics: &mut Metrics,
    ) -> Option<String> {
        let [a, b] = samples.map(f64::from);
        metrics.push(("contrary_pixels", self.contrary as f64));
        let each = math::exp(a * math::ln(a / (a + b)) + b * math::ln(b / (a + b)));
        // One share for what noise cannot make of single pixels: half for these, half for black ones.
        (self.contrary > 0 && each * (3 * self.values) as f64 <= 0.5 * level).then(|| {
            format!(
                "{} values differ where both images state a noise of 0",
                self.contrary
            )
        })
    }

    pub fn judge_copied(&self, level: f64, metrics: &mut Metrics) -> Option<String> {
        metrics.push(("copied_pixels", self.copied as f64));
        // No number of normal noise above its rounding is likelier than 0.4, no number of events
        // other than none likelier than 1/e, no side of a coin thrown twice than 1/2.
        (at_least(self.copied, self.noisy, 0.5) <= level).then(|| {
            let what = if self.copied == self.noisy {
                "it is the same image, not an independent estimate"
            } else {
                "part of it is copied"
            };
            format!(
                "{} of {} noisy pixels are bit-identical to the reference: {what}",
                self.copied, self.noisy
            )
        })
    }
}

/// Largest number of black pixels that are said to have causes of single ones.
const MOST_LOST: usize = 16;

/// Causes of single black pixels.
const CAUSES: &str = "; possible causes are a NaN replaced by 0, or a pixel that was never written";

/// Probability below which no digit of it means anything.
const RARE: f64 = 1e-12;

/// Test for black pixels, where both images state the number of their samples.
pub(super) fn judge_black(
    comparison: &Comparison<'_>,
    level: f64,
    metrics: &mut Metrics,
) -> Option<String> {
    let [golden, test] = comparison.films;
    let width = golden.width();
    let considered = chances_of_black(comparison).unwrap_or_default();
    let is_black = |at: usize| test.radiance()[at] == [0.0; 3];
    let black = considered.iter().filter(|(at, _)| is_black(*at));
    let count = black.clone().count();
    metrics.push(("black_pixels", count as f64));
    let &(first, least) = black.clone().min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let expected: f64 = considered.iter().map(|(_, chance)| chance).sum();
    // Half of that share for the one that is least likely, half for their number.
    let is_unlikely = least * considered.len() as f64 <= 0.25 * level;
    let are_many = many_by_chance(count as f64, expected) <= 0.25 * level;
    (is_unlikely || are_many).then(|| {
        format!(
            "{}, such as ({}, {}): {}{}",
            match count {
                1 => "a pixel is black".to_owned(),
                many => format!("{many} pixels are black"),
            },
            first % width,
            first / width,
            if is_unlikely {
                let seldom = if least < RARE { "less than " } else { "" };
                let images = 1.0 / least.max(RARE);
                format!("by the light around it, chance makes that one black {seldom}once in {images:.0e} images")
            } else {
                format!("chance would make some {expected:.0} black")
            },
            // Where geometry is missing or moved, whole regions are black.
            if count > MOST_LOST { "" } else { CAUSES }
        )
    })
}

/// Radius in pixels of the neighbourhood whose variance a black pixel may have.
const REACH: usize = 2;

/// Upper bounds on the probability with which noise makes pixels of the test image 0 in all channels, by index;
/// `None` where the samples of an image are unknown.
///
/// A mean of n samples that are not negative is 0 only if all of them are. By Cantelli's inequality a
/// sample of mean μ and variance σ² is 0 with a probability of σ²/(σ² + μ²) at most, all n with the
/// n-th power of that, whatever their distribution; for light that either arrives or does not it is
/// exact. The mean is the golden's. The variance of a sample is the larger of the golden's and of
/// the largest that the test image states for any pixel up to two away: a renderer that finds light
/// by chance has much of it, and a black pixel knows nothing of its own.
///
/// Source: Cantelli 1928, Atti del Congresso Internazionale dei Matematici 6, 47–59.
fn chances_of_black(comparison: &Comparison<'_>) -> Option<Vec<(usize, f64)>> {
    let samples = match comparison.stated {
        [Stated::Samples(of_golden), Stated::Samples(of_test)] => [of_golden, of_test],
        // It has no noise; of a sample of the test image the guard says more.
        [Stated::Known, Stated::Samples(of_test)] => [0.0, of_test],
        _ => return None,
    };
    let [golden, test] = comparison.films;
    // Rounding to 8 bits makes black of means that are not.
    if test.quantisation().is_some() {
        return None;
    }
    let size = [golden.width(), golden.height()];
    let bound = |index: usize| {
        let of_channel = |c: usize| {
            let mean = f64::from(golden.radiance()[index][c]);
            let [_, known] = comparison.shape.guard([0.0; 2], mean);
            let of_pixel = |at: usize| {
                let stated = comparison.films.map(|film| film.variance_at(at, c));
                (stated[0] * samples[0]).max(stated[1] * samples[1])
            };
            let near = around(index, size, REACH).map(of_pixel);
            let variance = near.fold(known * samples[1], f64::max);
            // Nearly black values may be rounded to black.
            (mean > DARK)
                .then(|| math::exp(samples[1] * math::ln(variance / (variance + mean * mean))))
        };
        // All channels have to be 0, which is no likelier than that one is.
        let bound = (0..3).filter_map(of_channel).fold(1.0, f64::min);
        (bound < 1.0).then_some((index, bound))
    };
    Some((0..size[0] * size[1]).filter_map(bound).collect())
}

/// Upper bound on the probability that `count` or more independent events happen, whose expected
/// number is `expected`.
///
/// Source: Chernoff 1952, Annals of Mathematical Statistics 23, 493–507.
fn many_by_chance(count: f64, expected: f64) -> f64 {
    if count <= expected {
        return 1.0;
    }
    if expected == 0.0 {
        return 0.0;
    }
    math::exp(count - expected + count * math::ln(expected / count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_events_of_many_are_no_chance() {
        // One of a mean of 1e-9: e·1e-9 at most.
        assert!((many_by_chance(1.0, 1e-9) / 1e-9 - crate::math::exp(1.0)).abs() < 1e-6);
        assert_eq!(many_by_chance(3.0, 4.0), 1.0);
        assert_eq!(many_by_chance(1.0, 0.0), 0.0);
        // Six where one is expected: e⁵/6⁶.
        assert!((many_by_chance(6.0, 1.0) - crate::math::exp(5.0) / 46656.0).abs() < 1e-9);
    }
}

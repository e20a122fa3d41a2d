//! Tests of single pixels: too many outliers, differences without noise, black without cause,
//! copied values.

use super::super::places::lines;
use super::super::significance::{at_least, deviation, holm};
use super::Metrics;
use super::blocks::{DARK, Difference};
use super::comparison::{Axis, Comparison};
use super::hits::{Hits, all_zero};
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
    /// Lines of pixels that repeat the line before.
    repeated: Option<Repeated>,
    /// Black pixels, and the number expected by chance.
    black: BlackPixels,
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
        let hits = Hits::of(reference, test);
        pixels.black = BlackPixels::of(comparison, &hits).unwrap_or_default();
        pixels.repeated = Repeated::of(comparison, &hits);
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
                "{} pixels and channels differ where neither image has any noise",
                self.contrary
            )
        })
    }

    /// Test for black pixels, where the test image states its noise and the number of its samples.
    pub fn judge_black(&self, level: f64, metrics: &mut Metrics) -> Option<String> {
        let BlackPixels {
            count,
            expected,
            least,
            considered,
            first,
            together,
            ends,
        } = self.black;
        metrics.push(("black_pixels", count as f64));
        // Half of that for the one that is least likely, half for their number; of both bounds on a probability
        // the smaller was taken, so that each has half again.
        let is_unlikely = least * considered as f64 <= 0.125 * level;
        let are_many = many_by_chance(count, expected) <= 0.125 * level;
        (count > 0 && (is_unlikely || are_many)).then(|| {
            format!(
                "{}{}, such as ({}, {}): {}{}",
                match count {
                    1 => "a pixel is black".to_owned(),
                    many => format!("{many} pixels are black"),
                },
                rectangle(count, ends).unwrap_or_default(),
                first[0],
                first[1],
                if is_unlikely {
                    format!("by the light around it, {}", chance("that one", least))
                } else {
                    format!("chance would make some {expected:.0} black")
                },
                // Where geometry is missing or moved, whole regions are black.
                if together { "" } else { CAUSES }
            )
        })
    }

    pub fn judge_copied(&self, level: f64, metrics: &mut Metrics) -> Option<String> {
        metrics.push(("copied_pixels", self.copied as f64));
        // No number of normal noise above its rounding is likelier than 0.4, no number of events
        // other than none likelier than 1/e, no side of a coin thrown twice than 1/2. Half of the share is that
        // of repeated lines.
        if let Some(repeated) = self
            .repeated
            .as_ref()
            .filter(|it| it.is_rejected(0.5 * level))
        {
            return Some(repeated.in_words());
        }
        (at_least(self.copied, self.noisy, 0.5) <= 0.5 * level).then(|| {
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

/// Pixels of the test image that are exactly 0 in all channels, and their expected number by noise.
///
/// A mean of n samples that are not negative is 0 only if all of them are. By Cantelli's inequality a
/// sample of mean μ and variance σ² is 0 with a probability of σ²/(σ² + μ²) at most, all n with the
/// n-th power of that, whatever their distribution; for light that either arrives or does not it is
/// exact. The mean is the golden's. The variance of a sample is the larger of the golden's and of
/// the largest that the test image states for any pixel up to two away: a renderer that finds light
/// by chance has much of it, and a black pixel knows nothing of its own. One wild sample near by makes that
/// bound useless, so that there is a second one, of the samples near by that are not 0: see the file
/// `hits.rs`.
///
/// Source: Cantelli 1928, Atti del Congresso Internazionale dei Matematici 6, 47–59.
#[derive(Clone, Copy, Debug, Default)]
struct BlackPixels {
    count: u64,
    /// Upper bound on their mean number in a correct image.
    expected: f64,
    /// Upper bound on the probability of the least likely of them, among all pixels considered.
    least: f64,
    considered: u64,
    first: [usize; 2],
    /// True if one of them has a black neighbour in its row and one in its column.
    together: bool,
    /// The least and the greatest column and row of them.
    ends: [[usize; 2]; 2],
}

/// Where `count` pixels between two columns and rows lie, if they fill the rectangle between them.
fn rectangle(count: u64, [least, greatest]: [[usize; 2]; 2]) -> Option<String> {
    let [columns, rows] = [0, 1].map(|axis| greatest[axis] + 1 - least[axis]);
    (count > 1 && (columns * rows) as u64 == count).then(|| {
        let [columns, rows] = [("column", 0), ("row", 1)]
            .map(|(name, axis)| lines(name, [least[axis], greatest[axis]]));
        format!(", all in {columns} and {rows}")
    })
}

/// Causes of single black pixels, and of single rows and columns.
pub(super) const CAUSES: &str =
    "; possible causes are a NaN replaced by 0, or a pixel that was never written";

/// Probability below which no digit of it means anything.
const RARE: f64 = 1e-12;

/// Frequency with which chance makes `what` black, of this `probability`, in words.
pub(super) fn chance(what: &str, probability: f64) -> String {
    let seldom = if probability < RARE { "less than " } else { "" };
    format!(
        "chance makes {what} black {seldom}once in {:.0e} images",
        1.0 / probability.max(RARE)
    )
}

/// Radius in pixels of the neighbourhood whose variance a black pixel may have.
const REACH: usize = 2;

impl BlackPixels {
    /// Black pixels of a comparison; `None` where the samples of an image are unknown.
    fn of(comparison: &Comparison<'_>, hits: &Hits) -> Option<BlackPixels> {
        let (of_golden, of_test) = match comparison.stated {
            [Stated::Samples(of_golden), Stated::Samples(of_test)] => (of_golden, of_test),
            // It has no noise; of a sample of the test image the guard says more.
            [Stated::Known, Stated::Samples(of_test)] => (0.0, of_test),
            _ => return None,
        };
        let [golden, test] = comparison.films;
        // Rounding to 8 bits makes black of means that are not.
        if test.quantisation().is_some() {
            return None;
        }
        let (width, height) = (golden.width(), golden.height());
        let [golden_noise, test_noise] = [golden.noise()?, test.noise()?];
        let mut black = BlackPixels::default();
        for index in 0..width * height {
            let [x, y] = [index % width, index / width];
            let mut likeliest = 1.0_f64;
            for c in 0..3 {
                let mean = f64::from(golden.radiance()[index][c]);
                // Nearly black values may be rounded to black.
                if mean <= DARK {
                    continue;
                }
                let mut variance = if comparison.shape.is_known {
                    comparison.shape.guard([0.0; 2], mean)[1] * of_test
                } else {
                    0.0
                };
                for other in around(index, [width, height], REACH) {
                    let stated = f64::from(test_noise.variance()[other][c]);
                    variance = variance.max(stated * of_test);
                    let stated = f64::from(golden_noise.variance()[other][c]);
                    variance = variance.max(stated * of_golden);
                }
                // All channels have to be 0, which is no likelier than that one is.
                likeliest = likeliest.min(all_zero(of_test, mean, variance));
            }
            if likeliest == 1.0 {
                continue;
            }
            likeliest = likeliest.min(hits.none_at(x, y));
            black.expected += likeliest;
            black.considered += 1;
            if test.radiance()[index] == [0.0; 3] {
                if black.count == 0 {
                    black.least = 1.0;
                    black.ends = [[x, y]; 2];
                }
                let [least, greatest] = &mut black.ends;
                *least = [least[0].min(x), least[1].min(y)];
                *greatest = [greatest[0].max(x), greatest[1].max(y)];
                if likeliest < black.least {
                    (black.least, black.first) = (likeliest, [x, y]);
                }
                black.count += 1;
                let is_black = |at: usize| {
                    golden.radiance()[at] != [0.0; 3] && test.radiance()[at] == [0.0; 3]
                };
                let across = x > 0 && is_black(index - 1) || x + 1 < width && is_black(index + 1);
                let down =
                    y > 0 && is_black(index - width) || y + 1 < height && is_black(index + width);
                black.together |= across && down;
            }
        }
        Some(black)
    }
}

/// Least number of samples that are not 0 in the pixels beside a pair, and of those that are: of light that arrives
/// in most samples or in few, many pixels have the same mean.
const VARIED: f64 = 3.0;

/// The line of the test image whose pixels repeat those of the line before most certainly: a renderer that never
/// wrote it, or that enlarged an image. Means of independent samples are equal with a probability of 1/2 at most
/// where their number that is not 0 varies, which the pixels on both sides of a pair show: a pair cannot be chosen
/// by its own.
struct Repeated {
    axis: Axis,
    line: usize,
    /// Pixels that are the same as those before, and of how many.
    count: [u64; 2],
    /// Probability of that, times the number of lines.
    probability: f64,
}

impl Repeated {
    fn of(comparison: &Comparison<'_>, hits: &Hits) -> Option<Repeated> {
        let [_, test] = comparison.films;
        let noise = test.noise().filter(|_| test.quantisation().is_none())?;
        let samples = f64::from(noise.samples());
        let rounding = comparison.rounding;
        let is_varied = |i: usize| {
            let hits = hits.of_test[i];
            hits >= VARIED && samples - hits >= VARIED
        };
        // Beyond a rounding to either side.
        let is_noisy = |i: usize| {
            (0..3).any(|c| {
                let value = f64::from(test.radiance()[i][c]);
                let step = 2.0 * Difference::of(value, value, 0.0, rounding).rounding;
                test.variance_at(i, c) > step * step
            })
        };
        let (width, height) = (test.width(), test.height());
        let mut all = Vec::new();
        for axis in Axis::BOTH {
            let [lines, length] = axis.lines([width, height]);
            let index = |line: usize, at: usize| axis.index(width, line, at);
            for line in 1..lines {
                let beside = [line.checked_sub(2), (line + 1 < lines).then_some(line + 1)];
                let is_asked = |at: &usize| {
                    let mut beside = beside.iter().flatten();
                    beside.all(|&other| is_varied(index(other, *at))) && is_noisy(index(line, *at))
                };
                let mut count = [0; 2];
                for at in (0..length).filter(is_asked) {
                    let [before, here] =
                        [line - 1, line].map(|line| test.radiance()[index(line, at)]);
                    count[0] += u64::from(before == here);
                    count[1] += 1;
                }
                all.push((axis, line, count));
            }
        }
        let lines = all.len() as f64;
        let repeated = all.into_iter().map(|(axis, line, count)| Repeated {
            axis,
            line,
            count,
            probability: lines * at_least(count[0], count[1], 0.5),
        });
        repeated.min_by(|a, b| a.probability.total_cmp(&b.probability))
    }

    fn is_rejected(&self, level: f64) -> bool {
        self.probability <= level
    }

    fn in_words(&self) -> String {
        let what = self.axis.name();
        format!(
            "{} of {} noisy pixels of {what} {} are bit-identical to those of {what} {}: part of the image is \
             repeated",
            self.count[0],
            self.count[1],
            self.line,
            self.line - 1
        )
    }
}

/// Upper bound on the probability that `count` or more independent events happen, whose expected
/// number is `expected`.
///
/// Source: Chernoff 1952, Annals of Mathematical Statistics 23, 493–507.
fn many_by_chance(count: u64, expected: f64) -> f64 {
    let count = count as f64;
    if count <= expected {
        return 1.0;
    }
    if expected == 0.0 {
        return 0.0;
    }
    math::exp(count - expected + count * math::ln(expected / count))
}

/// Largest variance of a pixel up to which half precision, which has steps of 2⁻²⁴ there, may have made three numbers
/// one.
const FEW_BITS: f32 = 4.0 / 16_777_216.0;

/// Fewest pixels that show one number for three variances.
const RECOGNISED: u64 = 64;

/// A reason if the test image states the same variance for its three channels, to the bit, wherever
/// those of the reference differ twofold: it is of the luminance, or of one channel. No estimates of
/// different numbers agree in so many pixels, so there is no chance to be allowed for.
pub(super) fn judge_one_variance(comparison: &Comparison<'_>) -> Option<String> {
    let [golden, test] = comparison.films.map(|film| film.noise());
    let pairs = golden?.variance().iter().zip(test?.variance());
    let (mut different, mut same) = (0, 0);
    for (golden, test) in pairs {
        let least = golden.iter().copied().fold(f32::INFINITY, f32::min);
        let most = golden.iter().copied().fold(0.0, f32::max);
        if most > 2.0 * least && test.iter().any(|variance| *variance > FEW_BITS) {
            different += 1;
            same += u64::from(test[0] == test[1] && test[1] == test[2]);
        }
    }
    (same >= RECOGNISED && same == different).then(|| {
        format!(
            "the variances of red, green and blue are one number in each of {same} pixels where they \
             should differ: state that of each channel, not of the luminance"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_events_of_many_are_no_chance() {
        // One of a mean of 1e-9: e·1e-9 at most.
        assert!((many_by_chance(1, 1e-9) / 1e-9 - crate::math::exp(1.0)).abs() < 1e-6);
        assert_eq!(many_by_chance(3, 4.0), 1.0);
        assert_eq!(many_by_chance(1, 0.0), 0.0);
        // Six where one is expected: e⁵/6⁶.
        assert!((many_by_chance(6, 1.0) - crate::math::exp(5.0) / 46656.0).abs() < 1e-9);
    }
}

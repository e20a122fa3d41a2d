//! Samples that are not 0: how many a pixel of the test image has at least, and how likely a pixel next to it has
//! none.
//!
//! Take n numbers with the mean m, whose mean has the estimated variance v. At least `n/(1 + (n − 1)·v/m²)` of them
//! are not 0: by Cauchy and Schwarz `(Σx)² ≤ k·Σx²`.
//!
//! A pixel has no such sample in the test image although it has r of them in the reference, where others next to it
//! have K in the test image and R in the reference. If light arrives there as many times more or less often in the one
//! image as in the other, this has a probability of `(1 − r/(r + R + K))^K` at most, given all counts but how they are
//! divided (the exact test of Fisher 1935, "The Logic of Inductive Inference", J. Royal Statistical Society 98, 39–82).
//! It falls with r and with K, of which there are lower bounds, and grows with R, which is all samples of the reference
//! at most: a lower bound in its place would be too small where samples that are not 0 vary most. To the
//! brightness of pixels a renderer may fit the probability with which it goes on with a path, so that r/R is not taken
//! to be larger than the ratio of their brightness. The pixel is compared with each of the four squares of 3 × 3 pixels
//! of which it is a corner: at an edge, what it shows is a mixture of what some of them show.

use crate::film::Film;
use crate::math;

/// Pixels on a side of a square next to a pixel.
const SIDE: usize = 3;

/// Upper bound on the probability that all of so many `samples` that are not negative are 0, of this mean and
/// variance of one, by Cantelli's inequality.
pub(super) fn all_zero(samples: f64, mean: f64, variance: f64) -> f64 {
    math::exp(samples * math::ln(variance / (variance + mean * mean)))
}

/// Bounds on the samples of the pixels of two images that are not 0.
pub(super) struct Hits {
    width: usize,
    height: usize,
    /// Their number in the test image, at least.
    pub of_test: Vec<f64>,
    /// Their number in the reference, at least.
    of_reference: Vec<f64>,
    /// Samples of a pixel of the reference.
    samples: f64,
    /// Brightness of the reference.
    brightness: Vec<f64>,
}

impl Hits {
    pub fn of([reference, test]: [&Film; 2]) -> Hits {
        let brightness = |pixel: &[f32; 3]| pixel.iter().copied().map(f64::from).sum();
        Hits {
            width: reference.width(),
            height: reference.height(),
            of_test: numbers(test),
            of_reference: numbers(reference),
            samples: reference
                .noise()
                .map_or(0.0, |noise| noise.samples().into()),
            brightness: reference.radiance().iter().map(brightness).collect(),
        }
    }

    /// Upper bound on the probability that all samples of a pixel are 0; 1 where nothing can be said.
    pub fn none_at(&self, x: usize, y: usize) -> f64 {
        let before = |at: usize| (at + 1).checked_sub(SIDE).map(|first| first..at + 1);
        let after = |at: usize, length: usize| (at + SIDE <= length).then_some(at..at + SIDE);
        let (mut likeliest, mut squares) = (0.0_f64, 0);
        let here = x + self.width * y;
        for columns in [before(x), after(x, self.width)].into_iter().flatten() {
            for rows in [before(y), after(y, self.height)].into_iter().flatten() {
                let (mut hits, mut brightest) = (0.0, 0.0_f64);
                for row in rows.clone() {
                    for other in columns.clone().map(|column| column + self.width * row) {
                        hits += self.of_test[other];
                        brightest = brightest.max(self.brightness[other]);
                    }
                }
                hits -= self.of_test[here];
                let others = (SIDE * SIDE - 1) as f64;
                let by_brightness = self.brightness[here] / brightest;
                let as_often = by_brightness.min(self.of_reference[here] / self.samples);
                let share = as_often / (as_often + others + hits / self.samples);
                let none = math::exp(hits * math::ln_1p(-share));
                likeliest = likeliest.max(if none.is_finite() { none } else { 1.0 });
                squares += 1;
            }
        }
        if squares > 0 { likeliest } else { 1.0 }
    }
}

/// Least number of samples of each pixel that are not 0 in its best channel; 0 without a statement of noise.
fn numbers(film: &Film) -> Vec<f64> {
    let Some(noise) = film.noise() else {
        return vec![0.0; film.radiance().len()];
    };
    let samples = f64::from(noise.samples());
    let of_pixel = |(mean, variance): (&[f32; 3], &[f32; 3])| {
        let of_channel = |c: usize| match f64::from(mean[c]) {
            0.0 => 0.0,
            mean => samples / (1.0 + (samples - 1.0) * f64::from(variance[c]) / (mean * mean)),
        };
        (0..3).map(of_channel).fold(0.0, f64::max)
    };
    let pixels = film.radiance().iter().zip(noise.variance());
    pixels.map(of_pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Moments;

    /// Eight samples, of which some are 0.
    #[test]
    fn no_more_samples_are_counted_than_are_not_0() {
        for (samples, expected) in [
            ([0.0; 8], 0.0),
            ([3.0; 8], 8.0),
            ([0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 5.0, 0.0], 2.0),
            ([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 7.0], 1.0),
        ] {
            let moments: Moments = samples.into_iter().collect();
            let film = Film::of_moments([1, 1], &[[moments; 3]], 8);
            // A film keeps eight bits of a variance.
            assert!((numbers(&film)[0] - expected).abs() < 0.01, "{samples:?}");
        }
        let moments: Moments = [0.0, 1.0, 2.0, 9.0].into_iter().collect();
        let film = Film::of_moments([1, 1], &[[moments; 3]], 4);
        assert!(numbers(&film)[0] < 3.0);
    }
}

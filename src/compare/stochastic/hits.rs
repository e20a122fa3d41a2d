//! Samples that are not 0: how many a pixel of the test image has at least, and how likely a pixel next to it has
//! none.
//!
//! Of n numbers with the mean m, whose mean has the estimated variance v, at least `n/(1 + (n − 1)·v/m²)` are not 0:
//! by Cauchy and Schwarz `(Σx)² ≤ k·Σx²`.
//!
//! If a sample is not 0 as often in a pixel as in m others, and K samples of all are not, then none of these lies in
//! the pixel with a probability of `(m/(m + 1))^K` at most, whatever the numbers are (the test of Fisher 1935, "The
//! Logic of Inductive Inference", J. Royal Statistical Society 98, 39–82). If it is so only f times as often, of
//! `(m/(m + f))^K`. The pixel is compared with each of the four squares of 3 × 3 pixels of which it is a corner: at an
//! edge, what it shows is a mixture of what some of them show. How much less often light arrives there than in the
//! square is the reference's to say, by the same bound on its samples and by its brightness, to which a renderer may
//! fit the probability with which it goes on with a path.

use crate::film::Film;
use crate::math;

/// Pixels on a side of a square next to a pixel.
const SIDE: usize = 3;

/// Bounds on the samples of the pixels of two images that are not 0.
pub(super) struct Hits {
    width: usize,
    height: usize,
    /// Their number in the test image, at least.
    pub of_test: Vec<f64>,
    /// Their number in the reference, at least.
    of_reference: Vec<f64>,
    /// Brightness of the reference.
    brightness: Vec<f64>,
}

impl Hits {
    pub fn of(reference: &Film, test: &Film) -> Hits {
        let brightness = |pixel: &[f32; 3]| pixel.iter().copied().map(f64::from).sum();
        Hits {
            width: reference.width(),
            height: reference.height(),
            of_test: numbers(test),
            of_reference: numbers(reference),
            brightness: reference.radiance().iter().map(brightness).collect(),
        }
    }

    /// Upper bound on the probability that all samples of a pixel are 0; 1 where nothing can be said.
    pub fn none_at(&self, x: usize, y: usize) -> f64 {
        let before = |at: usize| (at + 1).checked_sub(SIDE).map(|first| first..at + 1);
        let after = |at: usize, length: usize| (at + SIDE <= length).then_some(at..at + SIDE);
        let (mut likeliest, mut squares) = (0.0_f64, 0);
        for columns in [before(x), after(x, self.width)].into_iter().flatten() {
            for rows in [before(y), after(y, self.height)].into_iter().flatten() {
                let (mut hits, mut most, mut brightest) = (0.0, 0.0_f64, 0.0_f64);
                for row in rows.clone() {
                    for other in columns.clone().map(|column| column + self.width * row) {
                        hits += self.of_test[other];
                        most = most.max(self.of_reference[other]);
                        brightest = brightest.max(self.brightness[other]);
                    }
                }
                let here = x + self.width * y;
                hits -= self.of_test[here];
                let others = (SIDE * SIDE - 1) as f64;
                let as_often =
                    (self.of_reference[here] / most).min(self.brightness[here] / brightest);
                let none = math::exp(-hits * math::ln_1p(as_often / others));
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

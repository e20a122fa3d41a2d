//! Images in coarse pixels, and what one of them leaves of the difference of two others.
//!
//! Where pixels are means of random samples, a coarse pixel is a block of 8 × 8 of them. It has an eighth of their
//! noise, and costs little to predict: a render of an eighth of the size has the same means. Without random numbers
//! a coarse pixel is a pixel.

use super::stochastic::{BLOCK, FALSE_ALARM, judge_at};
use super::unexplained::{BOUND, SquaredDistance};
use crate::film::Film;
use crate::math::Sum;

/// Coarse pixels: their means, and the variances of those.
#[derive(Clone, Debug)]
pub(crate) struct Coarse {
    pub columns: usize,
    pub rows: usize,
    means: Vec<[f64; 3]>,
    variances: Vec<[f64; 3]>,
    /// Variances by which differences are weighed: at least what is due, since few samples that missed the light claim to
    /// have no noise.
    guards: Vec<[f64; 3]>,
    /// The image states no noise: its variances are guesses.
    is_guessed: bool,
    /// Random samples in each; `None` if unknown, and where there is no noise.
    samples: Option<f64>,
}

/// Probability with which an image with a change is said to disagree with a rendering of that change.
const DISAGREES: f64 = 0.01;

/// Part of a predicted change that an image has: the coefficient of its difference from the golden on that change, by
/// least squares weighed by noise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Amount {
    /// 0 for none of it, and 1 for all.
    pub value: f64,
    /// Standard error of that.
    pub error: f64,
    /// Decrease of the squared difference by the change, in variances.
    pub gain: f64,
}

impl Amount {
    /// True if the image has so much of the change that at most a `share` of its square is left, beyond doubt.
    pub fn leaves(&self, share: f64) -> bool {
        (self.value - 1.0).abs() + BOUND * self.error <= share.sqrt()
    }
}

impl Coarse {
    /// The image as it is: each coarse pixel is one pixel.
    pub fn of_pixels(film: &Film) -> Coarse {
        Coarse::with_edge(film, 1)
    }

    /// Blocks of 8 × 8 pixels; incomplete ones at the edges are left out. An image too small for a block stays as it is.
    pub fn of_blocks(film: &Film) -> Coarse {
        match film.width().min(film.height()) {
            0..BLOCK => Coarse::with_edge(film, 1),
            _ => Coarse::with_edge(film, BLOCK),
        }
    }

    fn with_edge(film: &Film, edge: usize) -> Coarse {
        let (columns, rows) = (film.width() / edge, film.height() / edge);
        let count = (edge * edge) as f64;
        let (mut means, mut variances) = (Vec::new(), Vec::new());
        for at in 0..columns * rows {
            let corner = [at % columns * edge, at / columns * edge];
            let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
            for y in corner[1]..corner[1] + edge {
                for index in (corner[0]..corner[0] + edge).map(|x| x + film.width() * y) {
                    for c in 0..3 {
                        mean[c] += f64::from(film.radiance()[index][c]) / count;
                        variance[c] += film.variance_at(index, c) / (count * count);
                    }
                }
            }
            if film.noise().is_none() && edge > 1 {
                variance = guessed_variance(film, corner, edge).map(|variance| variance / count);
            }
            means.push(mean);
            variances.push(variance);
        }
        let noise = film.noise().filter(|noise| !noise.is_of_renderings());
        Coarse {
            columns,
            rows,
            means,
            guards: variances.clone(),
            is_guessed: film.noise().is_none(),
            variances,
            samples: noise.map(|noise| f64::from(noise.samples()) * count),
        }
    }

    /// With guards against too little noise, if it is spread over the image as in `golden`. How much there is in all
    /// follows from the samples, or else from the noise itself. A guess is no less than its guard.
    pub fn with_noise_spread_like(mut self, golden: &Coarse) -> Coarse {
        let by_samples = golden.samples.zip(self.samples);
        for c in 0..3 {
            let sum = |image: &Coarse| -> f64 { image.variances.iter().map(|v| v[c]).sum() };
            let by_noise = || sum(&self) / sum(golden);
            let ratio = by_samples.map_or_else(by_noise, |(golden, own)| golden / own);
            if ratio.is_finite() {
                let due = self.guards.iter_mut().zip(&golden.variances);
                due.for_each(|(own, due)| own[c] = own[c].max(ratio * due[c]));
            }
        }
        if self.is_guessed {
            self.variances.clone_from(&self.guards);
        }
        self
    }

    /// The same image without noise of its own.
    pub fn without_noise(mut self) -> Coarse {
        self.variances.fill([0.0; 3]);
        self.guards.fill([0.0; 3]);
        self
    }

    /// A black image of this size.
    pub fn black(&self) -> Coarse {
        let mut black = self.clone().without_noise();
        black.means.fill([0.0; 3]);
        black
    }

    /// This image as noisy as `other`.
    fn with_noise_of(&self, other: &Coarse) -> Coarse {
        Coarse {
            means: self.means.clone(),
            ..other.clone()
        }
    }

    /// As an image of its own. One that does not count its samples states no noise.
    fn film(&self) -> Film {
        let narrow = |values: &[[f64; 3]]| values.iter().map(|v| v.map(|x| x as f32)).collect();
        let (columns, rows, means) = (self.columns, self.rows, narrow(&self.means));
        match self.samples {
            Some(samples) => {
                let samples = samples.min(f64::from(u32::MAX)) as u32;
                Film::with_noise(columns, rows, means, narrow(&self.variances), samples)
            }
            None => Film::new(columns, rows, means),
        }
    }

    /// True if there are as many coarse pixels in each row and column.
    pub fn has_size_of(&self, other: &Coarse) -> bool {
        (self.columns, self.rows) == (other.columns, other.rows)
    }

    /// The means of all channels, pixel by pixel.
    pub fn values(&self) -> Vec<f64> {
        self.means.as_flattened().to_vec()
    }

    /// Weights of squared differences of `test` from this golden, by channel: relative to the brightness of the golden
    /// and its mean, and small where there is much noise. The noise is the golden's: that of a test image is smaller
    /// where it happens to be dark.
    pub fn weights(&self, test: &Coarse) -> Vec<f64> {
        let sum = |image: &Coarse| -> f64 { image.variances.as_flattened().iter().sum() };
        let ratio = sum(test) / sum(self);
        let noise = 1.0 + if ratio.is_finite() { ratio } else { 0.0 };
        let means = self.means.as_flattened();
        let mean = means.iter().map(|mean| mean.abs()).sum::<f64>() / means.len() as f64;
        let values = means.iter().zip(self.variances.as_flattened());
        let weight = |(value, variance): (&f64, &f64)| {
            let bright = value.abs() + mean;
            let weight = 1.0 / (bright * bright + 16.0 * variance * noise);
            if weight.is_finite() { weight } else { 1.0 }
        };
        values.map(weight).collect()
    }

    /// Mean squared difference of `test` from this prediction by the `weights` of a golden, noise taken out.
    pub fn distance(&self, test: &Coarse, weights: &[f64]) -> SquaredDistance {
        let (mut squares, mut errors, mut spread) =
            (Sum::default(), Sum::default(), Sum::default());
        for at in 0..self.means.len() {
            let (mut square, mut error) = (0.0, 0.0);
            for (c, weight) in weights[3 * at..3 * at + 3].iter().enumerate() {
                let difference = self.means[at][c] - test.means[at][c];
                let stated = self.variances[at][c] + test.variances[at][c];
                square += weight * (difference * difference - stated);
                let variance = self.guards[at][c] + test.guards[at][c];
                // The square of a normal number of mean m has the variance 2 v² + 4 v m². The channels may share their
                // noise: their errors add up.
                let of_square = variance * (2.0 * variance + 4.0 * difference * difference);
                error += weight * of_square.sqrt();
            }
            squares.add(square);
            errors.add(error * error);
            spread.add(square * square);
        }
        // What one block carries alone may be a rare bright path: the error is at least that by which blocks differ.
        let variance = match errors.value() {
            0.0 => 0.0,
            errors => errors.max(spread.value()),
        };
        let count = 3.0 * self.means.len() as f64;
        SquaredDistance {
            value: squares.value() / count,
            error: variance.sqrt() / count,
        }
    }

    /// [`Amount`] of the change from `golden` to this prediction that `test` has; `None` where noise hides the change.
    pub fn amount_in(&self, test: &Coarse, golden: &Coarse) -> Option<Amount> {
        let (mut in_test, mut in_change) = (Sum::default(), Sum::default());
        let (mut error_in_test, mut error_in_change) = (Sum::default(), Sum::default());
        for at in 0..self.means.len() {
            let (mut of_test, mut of_change) = (0.0, 0.0);
            for c in 0..3 {
                let base = golden.means[at][c];
                let [change, difference] = [self, test].map(|it| it.means[at][c] - base);
                let of_both = self.variances[at][c] + golden.variances[at][c];
                let noise = of_both + test.guards[at][c];
                if noise <= 0.0 {
                    continue;
                }
                in_test.add((change * difference - golden.variances[at][c]) / noise);
                in_change.add((change * change - of_both) / noise);
                of_test += change.abs() / noise.sqrt();
                of_change += (of_both * (2.0 * of_both + 4.0 * change * change)).sqrt() / noise;
            }
            error_in_test.add(of_test * of_test);
            error_in_change.add(of_change * of_change);
        }
        let [size, error] = [in_change.value(), error_in_change.value().sqrt()];
        let value = in_test.value() / size;
        (size > 0.0).then(|| Amount {
            value,
            error: (error_in_test.value() + value * value * error * error).sqrt() / size,
            gain: 2.0 * in_test.value() - size,
        })
    }

    /// True if `test` agrees with this prediction by the rule of the gate with noise: blocks are judged as pixels.
    pub fn agrees(&self, test: &Coarse) -> bool {
        self.agrees_at(test, DISAGREES)
    }

    fn agrees_at(&self, test: &Coarse, level: f64) -> bool {
        judge_at(&self.film(), &test.film(), level).is_ok_and(|judgement| judgement.passed)
    }

    /// True if `test`, which has noise, agrees with this prediction where a `golden` as noisy would not.
    pub fn is_told(&self, test: &Coarse, golden: &Coarse) -> bool {
        self.agrees_at(test, FALSE_ALARM) && !golden.with_noise_of(self).agrees(test)
    }

    /// This golden with the effect of a change, from renderings with the same random numbers `before` and `after` it.
    pub fn moved(&self, before: &Coarse, after: &Coarse) -> Coarse {
        let mut moved = self.clone();
        let effects = before.means.iter().zip(&after.means);
        for (mean, (before, after)) in moved.means.iter_mut().zip(effects) {
            *mean = std::array::from_fn(|c| mean[c] + (after[c] - before[c]));
        }
        moved
    }
}

/// Variance of a pixel within a block of an image that does not state it, by the differences of
/// neighbours that are left when all that is linear is taken away.
///
/// Source: Immerkær 1996, "Fast noise variance estimation", Computer Vision and Image
/// Understanding 64(2), with squares in place of absolute values.
fn guessed_variance(film: &Film, corner: [usize; 2], edge: usize) -> [f64; 3] {
    const MASK: [f64; 9] = [1.0, -2.0, 1.0, -2.0, 4.0, -2.0, 1.0, -2.0, 1.0];
    // Sum of the squares of the mask.
    const POWER: f64 = 36.0;
    let mut sums = [0.0; 3];
    let inside = |axis: usize| corner[axis] + 1..corner[axis] + edge - 1;
    for (x, y) in inside(1).flat_map(|y| inside(0).map(move |x| (x, y))) {
        for (c, sum) in sums.iter_mut().enumerate() {
            let value = |k: usize| {
                let index = x + k % 3 - 1 + film.width() * (y + k / 3 - 1);
                f64::from(film.radiance()[index][c])
            };
            let left: f64 = (0..9).map(|k| MASK[k] * value(k)).sum();
            *sum += left * left / POWER;
        }
    }
    let count = (inside(0).len() * inside(1).len()) as f64;
    sums.map(|sum| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Stream};

    /// Pixels of this mean and a noise of uniform numbers with standard deviation 0.2, stated or not.
    fn noisy(mean: f64, seed: u64, states_noise: bool) -> Coarse {
        let edge = 64;
        let pixel = |index: usize| {
            let stream = Stream::new(seed, index as u32, 0);
            std::array::from_fn(|c| {
                let u = stream.uniform(0, Purpose::Camera, c as u32);
                (mean + (u - 0.5) * 0.2 * 12_f64.sqrt()) as f32
            })
        };
        let pixels = (0..edge * edge).map(pixel).collect();
        Coarse::of_blocks(&match states_noise {
            true => Film::with_noise(edge, edge, pixels, vec![[0.04; 3]; edge * edge], 16),
            false => Film::new(edge, edge, pixels),
        })
    }

    #[test]
    fn what_makes_the_image_explains_it_and_the_rest_does_not() {
        let golden = noisy(1.0, 1, true);
        for states in [true, false] {
            let test = noisy(1.1, 2, states).with_noise_spread_like(&golden);
            let weights = golden.weights(&test);
            let whole = golden.distance(&test, &weights);
            // A difference of 0.1 beside a mean of 1, relative to that and the mean of the image.
            assert!(
                (whole.value - 0.0025).abs() < 3.0 * whole.error,
                "{whole:?}"
            );
            let [right, other] = [1.1, 1.02].map(|mean| noisy(mean, 3, true));
            let left = right.distance(&test, &weights);
            assert!(left.at_least() == 0.0 && left.at_most() > 0.0, "{left:?}");
            assert!(right.is_told(&test, &golden));
            assert!(!other.is_told(&test, &golden));
            assert!(!noisy(1.0, 4, true).is_told(&test, &golden));
            let amount = right.amount_in(&test, &golden).unwrap();
            assert!(
                (amount.value - 1.0).abs() < 4.0 * amount.error,
                "{amount:?}"
            );
        }
    }

    #[test]
    fn slopes_are_not_taken_for_noise() {
        let pixels = (0..64).map(|i| [(i % 8) as f32, (i / 8) as f32, 1.0]);
        let film = Film::new(8, 8, pixels.collect());
        assert_eq!(guessed_variance(&film, [0, 0], 8), [0.0; 3]);
    }
}

//! Differences of the pixels of two images, with their weights and their noise.

use super::stochastic::BLOCK;
use crate::film::Film;
use crate::math::Sum;

/// Differences of the pixels, weighed by the brightness of the golden.
pub(super) struct Pixels<'f> {
    pub golden: &'f Film,
    pub test: &'f Film,
    /// Mean brightness of the golden.
    pub mean: f64,
    /// Variance of the differences over that of the golden, by channel; none without noise.
    noise_over_golden: Option<[f64; 3]>,
}

impl<'f> Pixels<'f> {
    pub fn new(golden: &'f Film, test: &'f Film) -> Option<Pixels<'f>> {
        let mut pixels = Pixels {
            golden,
            test,
            mean: golden.mean_magnitude().filter(|&mean| mean > 0.0)?,
            noise_over_golden: None,
        };
        pixels.noise_over_golden = pixels.unstated_noise();
        Some(pixels)
    }

    /// Noise of a test image that does not state it, where the golden does: by the second
    /// differences of the difference, free of everything linear. Where the golden is known, it is
    /// taken to be spread as radiance is, as in the stochastic gate.
    fn unstated_noise(&self) -> Option<[f64; 3]> {
        self.golden.noise()?;
        if self.test.noise().is_some() {
            return None;
        }
        let width = self.golden.width();
        let mut ratios = [0.0; 3];
        for (c, ratio) in ratios.iter_mut().enumerate() {
            let (mut squares, mut variances) = (Sum::default(), Sum::default());
            for row in 0..self.golden.height() {
                for column in 1..width.saturating_sub(1) {
                    let i = column + width * row;
                    let d = |i: usize| self.difference(i, c);
                    let second = d(i - 1) - 2.0 * d(i) + d(i + 1);
                    let weight = self.weight(i, c);
                    // The squares of 1, −2 and 1 sum to 6.
                    squares.add(weight * second * second / 6.0);
                    variances.add(weight * self.shape_of_noise(i, c));
                }
            }
            *ratio = squares.value() / variances.value();
        }
        ratios
            .iter()
            .all(|ratio| ratio.is_finite())
            .then_some(ratios)
    }

    /// Variance of a pixel of an image that does not state it, up to a factor.
    fn shape_of_noise(&self, i: usize, c: usize) -> f64 {
        let noise = self.golden.noise();
        match noise {
            Some(noise) if noise.is_known() => self.value(i, c).abs(),
            _ => self.golden.variance_at(i, c),
        }
    }

    pub fn value(&self, i: usize, c: usize) -> f64 {
        f64::from(self.golden.radiance()[i][c])
    }

    pub fn difference(&self, i: usize, c: usize) -> f64 {
        f64::from(self.test.radiance()[i][c]) - self.value(i, c)
    }

    /// Square of the difference, weighed, without that of the noise.
    pub fn square(&self, i: usize, c: usize) -> f64 {
        let difference = self.difference(i, c);
        self.weight(i, c) * (difference * difference - self.variance(i, c))
    }

    /// Variance of the difference.
    pub fn variance(&self, i: usize, c: usize) -> f64 {
        let of = |film: &Film| film.variance_at(i, c);
        match self.noise_over_golden {
            Some(ratios) => ratios[c] * self.shape_of_noise(i, c),
            None => of(self.golden) + of(self.test),
        }
    }

    /// Weight of a difference: by relative differences, except near black.
    pub fn weight(&self, i: usize, c: usize) -> f64 {
        let size = self.value(i, c).abs() + self.mean;
        1.0 / (size * size)
    }

    /// Sum of the channels of the golden.
    pub fn brightness(&self, i: usize) -> f64 {
        (0..3).map(|c| self.value(i, c)).sum()
    }

    /// Change of the golden per pixel, to the right and down.
    pub fn slope(&self, i: usize, c: usize) -> [f64; 2] {
        let width = self.golden.width();
        let [x, y] = [i % width, i / width];
        let along = |at: usize, count: usize, step: usize| {
            let before = if at > 0 { i - step } else { i };
            let after = if at + 1 < count { i + step } else { i };
            let length = (after - before) / step;
            if length == 0 {
                0.0
            } else {
                (self.value(after, c) - self.value(before, c)) / length as f64
            }
        };
        [along(x, width, 1), along(y, self.golden.height(), width)]
    }

    /// True for a pixel at least a tenth as bright as the mean.
    pub fn is_lit(&self, i: usize) -> bool {
        self.brightness(i) > 0.3 * self.mean
    }

    /// Square of the golden's slope, weighed.
    pub fn steepness(&self, i: usize) -> f64 {
        let of = |c: usize| {
            let [x, y] = self.slope(i, c);
            self.weight(i, c) * (x * x + y * y)
        };
        (0..3).map(of).sum()
    }

    pub fn block(&self, i: usize) -> [usize; 2] {
        let width = self.golden.width();
        [i % width / BLOCK, i / width / BLOCK]
    }
}

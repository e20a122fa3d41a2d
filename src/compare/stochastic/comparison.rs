//! Two images compared block by block, with variances that are not stated filled in.

use super::super::significance::deviation;
use super::blocks::{Block, Channel, Rounding, Variance, blocks, parts};
use super::variance::{NoiseShape, Stated, unstated};
use crate::film::Film;

/// Two images of one size, at least one of which states its noise.
#[derive(Clone)]
pub(super) struct Comparison<'f> {
    /// Reference and test image.
    pub films: [&'f Film; 2],
    /// Blocks, row by row from the top.
    pub blocks: Vec<Block>,
    /// The noise that each image states.
    pub stated: [Stated; 2],
    /// The completion of variances that are not stated.
    pub shape: NoiseShape,
    /// Probability with which noise that is not stated may be underestimated.
    pub level: f64,
    /// Rounding of the values of the test image.
    pub rounding: Rounding,
}

/// Variance of a channel of a block by both estimates.
fn variance(stated: [Stated; 2], shape: &NoiseShape, channel: &Channel) -> Variance {
    let mut own = channel.stated;
    if let Some(silent) = unstated(stated) {
        own[silent] = (channel.spread - own[1 - silent]).max(0.0);
    }
    Variance {
        own,
        guard: shape.guard(channel.stated, channel.radiance),
    }
}

impl<'f> Comparison<'f> {
    /// `level` is the probability with which the noise of an image that does not state it may be
    /// underestimated.
    pub fn new(reference: &'f Film, test: &'f Film, level: f64) -> Comparison<'f> {
        let films = [reference, test];
        let rounding = Rounding::of(test);
        let comparison = Comparison {
            films,
            blocks: blocks(films, rounding),
            stated: films.map(Stated::by),
            shape: NoiseShape::default(),
            level,
            rounding,
        };
        comparison.completed(1.0)
    }

    /// Completes variances from statements and from the spread of differences, for a test image with
    /// `times` its samples.
    fn completed(mut self, times: f64) -> Comparison<'f> {
        self.shape = NoiseShape::new(self.stated, &self.blocks, self.level, times);
        for channel in self.blocks.iter_mut().flat_map(|block| &mut block.channels) {
            channel.variance = variance(self.stated, &self.shape, channel);
        }
        self
    }

    /// This comparison with the variances for `times` the samples in the test image: its noise is
    /// that much smaller, that of the reference unchanged.
    pub fn with_samples(&self, times: f64) -> Comparison<'f> {
        let reference = self.shape.share_of_reference;
        let mut more = self.clone();
        for channel in more.blocks.iter_mut().flat_map(|block| &mut block.channels) {
            channel.stated[1] /= times;
            channel.spread *= reference + (1.0 - reference) / times;
        }
        more.stated[1] = more.stated[1].times(times);
        more.completed(times)
    }

    /// Rows and columns of a pixel, as blocks.
    pub fn lines(&self) -> [Vec<Block>; 2] {
        let [reference, _] = self.films;
        let (width, height) = (reference.width(), reference.height());
        let line = |columns, rows| {
            let mut line = Block::new(self.films, self.rounding, columns, rows);
            for channel in &mut line.channels {
                channel.variance = variance(self.stated, &self.shape, channel);
            }
            line
        };
        [
            (0..height).map(|y| line(0..width, y..y + 1)).collect(),
            (0..width).map(|x| line(x..x + 1, 0..height)).collect(),
        ]
    }

    /// Number of blocks in a row.
    pub fn columns(&self) -> usize {
        parts(self.films[0].width()).count()
    }

    /// Number of blocks and channels tested for a bias.
    pub fn asked(&self) -> usize {
        3 * self.blocks.len()
    }

    /// Degrees of freedom of the variance of a block that is its [own](Variance::own): one less
    /// than samples for each pixel, or one less than pixels where it is taken from their spread.
    /// The smaller of the two images' numbers, a lower bound of Welch's.
    pub fn degrees(&self, block: &Block) -> f64 {
        let pixels = block.pixels() as f64;
        match self.numbers() {
            [Some(a), Some(b)] => pixels * f64::from(a.min(b) - 1),
            _ => (pixels - 1.0).max(1.0),
        }
    }

    /// Number of values behind the variances of reference and test image, where they state their
    /// noise.
    pub fn numbers(&self) -> [Option<u32>; 2] {
        self.films
            .map(|film| film.noise().map(|noise| noise.samples()))
    }

    /// The channels of the whole image.
    pub fn totals(&self) -> [Channel; 3] {
        let mut totals = [Channel::default(); 3];
        for block in &self.blocks {
            for (total, channel) in totals.iter_mut().zip(&block.channels) {
                total.radiance += channel.radiance;
                total.difference.add(channel.difference);
                total.variance.own[0] += channel.variance.own();
                for (sum, stated) in total.stated.iter_mut().zip(channel.stated) {
                    *sum += stated;
                }
            }
        }
        totals
    }

    /// Deviation of the whole image, in standard errors. If one image does not state its noise and is the brighter one, its
    /// own variance alone counts: k rare events make it brighter by at most √k of the standard errors that they cause.
    pub fn deviation(&self, total: &Channel) -> f64 {
        let beyond = total.difference.beyond_rounding();
        let is_brighter = match unstated(self.stated) {
            Some(0) => beyond < 0.0,
            Some(_) => beyond > 0.0,
            None => false,
        };
        let variance = if is_brighter {
            total.variance.own()
        } else {
            self.variance_of_whole(total)
        };
        deviation(beyond, variance)
    }

    /// The larger variance of the whole image, own or guard.
    pub fn variance_of_whole(&self, total: &Channel) -> f64 {
        let guard = self.shape.guard_of_whole(total.stated, total.radiance);
        total.variance.own().max(guard)
    }
}

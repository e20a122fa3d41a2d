//! Two images, put together block by block.

use super::super::significance::deviation;
use super::variance::{NoiseShape, Stated, unstated};
use crate::film::Film;
use crate::math::Moments;
use std::ops::Range;

/// Pixels on a side of a block. What is left over at the edges goes to the last blocks.
pub const BLOCK: usize = 8;

/// Radiance added to the mean of a block before a bias is taken relative to it: the absolute
/// part of the tolerance of the deterministic gate.
pub const DARK: f64 = 1e-3;

/// Sums over one channel of the image.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Total {
    pub difference: Difference,
    /// [Own](Variance::own) variance.
    pub own: f64,
    /// That which reference and test image state; 0 where one does not.
    pub stated: [f64; 2],
}

/// Relative rounding error of half precision, 11 significant bits.
const HALF_ROUNDING: f64 = 1.0 / 2048.0;
/// Below this half precision has fewer bits.
const SMALLEST_HALF: f64 = 1.0 / 16384.0;

/// A sum of differences, test minus reference.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Difference {
    pub value: f64,
    /// How much of it the rounding of the test image's means to 16 bits can explain.
    pub rounding: f64,
}

impl Difference {
    /// Of one pixel with the value `a` in the reference and `b` in the test image.
    pub fn of(a: f64, b: f64) -> Difference {
        Difference {
            value: b - a,
            // Most renderers write half precision unless asked for more: by 2⁻¹¹ of a value, or 2⁻²⁵
            // of a very small one. References are of 32 bits, whose rounding is nothing beside.
            rounding: HALF_ROUNDING * a.abs().max(b.abs()).max(SMALLEST_HALF),
        }
    }

    /// What rounding does not explain.
    pub fn beyond_rounding(&self) -> f64 {
        let beyond = (self.value.abs() - self.rounding).max(0.0);
        beyond.copysign(self.value)
    }

    pub fn add(&mut self, other: Difference) {
        self.value += other.value;
        self.rounding += other.rounding;
    }
}

/// What is known of the variance of a difference of sums, by where it comes from: reference and
/// test image. See the [module](super) on why there are two answers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Variance {
    /// As the images state, or as the differences spread.
    pub own: [f64; 2],
    /// By the finer of the two images.
    pub guard: [f64; 2],
}

impl Variance {
    pub fn own(&self) -> f64 {
        self.own[0] + self.own[1]
    }

    pub fn guard(&self) -> f64 {
        self.guard[0] + self.guard[1]
    }

    /// The larger of the two.
    pub fn largest(&self) -> f64 {
        self.own().max(self.guard())
    }
}

/// Sums over one channel of a block.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Channel {
    /// Of the reference.
    pub radiance: f64,
    pub difference: Difference,
    /// Of the squares of what rounding does not explain.
    pub squares: f64,
    /// Of the variances that reference and test image state; 0 where one does not.
    pub stated: [f64; 2],
    /// Variance of the sum of the differences, from how they spread within the block.
    pub spread: f64,
    pub variance: Variance,
}

/// A block of pixels.
#[derive(Clone)]
pub(super) struct Block {
    pub columns: Range<usize>,
    pub rows: Range<usize>,
    pub channels: [Channel; 3],
}

impl Block {
    fn new(films: [&Film; 2], columns: Range<usize>, rows: Range<usize>) -> Block {
        let mut block = Block {
            columns,
            rows,
            channels: Default::default(),
        };
        let [reference, test] = films;
        let mut spreads = [Moments::default(); 3];
        for index in block.indices(reference.width()) {
            let (a, b) = (reference.radiance()[index], test.radiance()[index]);
            for (c, channel) in block.channels.iter_mut().enumerate() {
                let difference = Difference::of(f64::from(a[c]), f64::from(b[c]));
                let beyond = difference.beyond_rounding();
                channel.radiance += f64::from(a[c]);
                channel.squares += beyond * beyond;
                channel.difference.add(difference);
                spreads[c].add(difference.value);
                for (image, film) in films.into_iter().enumerate() {
                    let noise = film.noise();
                    channel.stated[image] +=
                        noise.map_or(0.0, |noise| f64::from(noise.variance()[index][c]));
                }
            }
        }
        let pixels = block.pixels() as f64;
        for (channel, spread) in block.channels.iter_mut().zip(spreads) {
            // One pixel alone has no spread: nothing can be said of it.
            channel.spread = spread.variance().unwrap_or(f64::INFINITY) * pixels;
        }
        block
    }

    /// Of the pixels, in an image of that many columns.
    pub fn indices(&self, width: usize) -> impl Iterator<Item = usize> + use<> {
        let columns = self.columns.clone();
        let row = move |row| columns.clone().map(move |column| row * width + column);
        self.rows.clone().flat_map(row)
    }

    pub fn pixels(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// What a bias of `channel` is relative to: its sum over the block, and a little more.
    pub fn floor(&self, channel: usize) -> f64 {
        self.channels[channel].radiance.abs() + DARK * self.pixels() as f64
    }
}

/// `length` pixels in parts of at least [`BLOCK`], or one part of all.
pub(super) fn parts(length: usize) -> impl Iterator<Item = Range<usize>> + Clone {
    let count = (length / BLOCK).max(1);
    (0..count).map(move |i| {
        let end = if i + 1 == count {
            length
        } else {
            (i + 1) * BLOCK
        };
        i * BLOCK..end
    })
}

/// Two images of one size, at least one of which states its noise.
pub(super) struct Comparison<'f> {
    /// Reference and test image.
    pub films: [&'f Film; 2],
    /// Row by row from the top.
    pub blocks: Vec<Block>,
    /// What they say of their noise.
    pub stated: [Stated; 2],
    /// How the variances were completed.
    pub shape: NoiseShape,
    /// Probability with which noise that is not stated may be underestimated.
    level: f64,
}

impl<'f> Comparison<'f> {
    /// `level` is the probability with which the noise of an image that does not state it may be
    /// underestimated.
    pub fn new(reference: &'f Film, test: &'f Film, level: f64) -> Comparison<'f> {
        let films = [reference, test];
        let mut blocks = Vec::new();
        for rows in parts(reference.height()) {
            for columns in parts(reference.width()) {
                blocks.push(Block::new(films, columns, rows.clone()));
            }
        }
        Comparison::completed(films, films.map(Stated::by), blocks, level, 1.0)
    }

    /// With the variances of `blocks` from what is stated and from how differences spread, of a test
    /// image with `times` the samples that it was looked at with.
    fn completed(
        films: [&'f Film; 2],
        stated: [Stated; 2],
        mut blocks: Vec<Block>,
        level: f64,
        times: f64,
    ) -> Comparison<'f> {
        let shape = NoiseShape::new(stated, &blocks, level, times);
        for block in &mut blocks {
            for channel in &mut block.channels {
                channel.variance = Variance {
                    own: match unstated(stated) {
                        None => channel.stated,
                        Some(silent) => {
                            let mut own = channel.stated;
                            own[silent] = (channel.spread - own[1 - silent]).max(0.0);
                            own
                        }
                    },
                    guard: shape.guard(channel.stated),
                };
            }
        }
        Comparison {
            films,
            blocks,
            stated,
            shape,
            level,
        }
    }

    /// As far as variances go, what this would be with `times` the samples in the test image: its
    /// noise is that much smaller, and that of the reference stays.
    pub fn with_samples(&self, times: f64) -> Comparison<'f> {
        let reference = self.shape.share_of_reference;
        let mut blocks = self.blocks.clone();
        for channel in blocks.iter_mut().flat_map(|block| &mut block.channels) {
            channel.stated[1] /= times;
            channel.spread *= reference + (1.0 - reference) / times;
        }
        let [of_reference, of_test] = self.stated;
        let stated = [of_reference, of_test.times(times)];
        Comparison::completed(self.films, stated, blocks, self.level, times)
    }

    /// Blocks and channels, of which each is asked for a bias.
    pub fn asked(&self) -> usize {
        3 * self.blocks.len()
    }

    /// Degrees of freedom of the variance of a block that is its [own](Variance::own): one less
    /// than samples for each pixel, or one less than pixels where it is taken from their spread.
    /// Of two images' the smaller number, which Welch's exceeds.
    pub fn degrees(&self, block: &Block) -> f64 {
        let pixels = block.pixels() as f64;
        match self.numbers() {
            [Some(a), Some(b)] => pixels * f64::from(a.min(b) - 1),
            _ => (pixels - 1.0).max(1.0),
        }
    }

    /// Numbers that the variances of reference and test image are the spread of, where they state
    /// their noise.
    pub fn numbers(&self) -> [Option<u32>; 2] {
        self.films
            .map(|film| film.noise().map(|noise| noise.samples()))
    }

    /// The channels of the whole image.
    pub fn totals(&self) -> [Total; 3] {
        let mut totals = [Total::default(); 3];
        for block in &self.blocks {
            for (total, channel) in totals.iter_mut().zip(&block.channels) {
                total.difference.add(channel.difference);
                total.own += channel.variance.own();
                for (sum, stated) in total.stated.iter_mut().zip(channel.stated) {
                    *sum += stated;
                }
            }
        }
        totals
    }

    /// How far the whole image is off, in standard errors. Where one image does not state its
    /// noise and is the brighter one, by its own variance alone: k rare events make it brighter by
    /// √k of the standard errors that they cause themselves, at most.
    pub fn deviation(&self, total: &Total) -> f64 {
        let beyond = total.difference.beyond_rounding();
        let is_brighter = match unstated(self.stated) {
            Some(0) => beyond < 0.0,
            Some(_) => beyond > 0.0,
            None => false,
        };
        let variance = match is_brighter {
            true => total.own,
            false => self.variance_of_whole(total),
        };
        deviation(beyond, variance)
    }

    /// The larger variance of the whole image, own or guard.
    pub fn variance_of_whole(&self, total: &Total) -> f64 {
        total.own.max(self.shape.guard_of_whole(total.stated))
    }
}

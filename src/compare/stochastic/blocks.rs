//! Sums over the blocks of two images.

use crate::film::{Film, Quantisation};
use crate::math::Moments;
use std::ops::Range;

/// Pixels on a side of a block. The last blocks take the remaining pixels at the edges.
pub const BLOCK: usize = 8;

/// Radiance added to the mean of a block before a bias is taken relative to it: the absolute
/// part of the tolerance of the deterministic gate.
pub const DARK: f64 = 1e-3;

/// Relative rounding error of half precision, 11 significant bits.
const HALF_ROUNDING: f64 = 1.0 / 2048.0;
/// Relative error of a sum in single precision for each sample: an addition rounds by 2⁻²⁴ of the sum so
/// far at most, half of the whole sum on average.
const SUM_ROUNDING: f64 = 1.0 / 33_554_432.0;

/// Rounding of a value that `printf` wrote, to six decimals, in radiance. Half floats near 0 have steps of 2⁻²⁴, which are
/// finer. Beside [`DARK`] this is 0.05 %.
const DECIMALS: f64 = 5e-7;

/// Rounding of the values of a test image, in the formats that it may have gone through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounding {
    quantisation: Option<Quantisation>,
    /// Share of a value.
    relative: f64,
    /// Renderings that were rounded each.
    renderings: f64,
}

impl Rounding {
    pub fn of(test: &Film) -> Rounding {
        let samples = test.samples().map_or(0.0, |samples| samples as f64);
        let renderings = f64::from(test.renderings().unwrap_or(1));
        let in_sums = samples / renderings * SUM_ROUNDING;
        Rounding {
            quantisation: test.quantisation(),
            // A sum that loses more than half precision is a fault.
            relative: HALF_ROUNDING + in_sums.min(HALF_ROUNDING),
            renderings,
        }
    }

    /// Error that codes of 8 bits make in a pixel: half a code, and the part of its noise that the
    /// [largest code cuts off](super::cut_off). It is `a` in the reference, and `b` in the test image, which states this
    /// variance.
    fn of_codes(&self, a: f64, b: f64, variance: f64) -> f64 {
        self.quantisation.map_or(0.0, |it| {
            let below = it.largest() - a;
            let of_rendering = variance * self.renderings;
            let cut_off = 0.5 * ((of_rendering + below * below).sqrt() - below);
            it.half_code(b) + cut_off
        })
    }
}

/// A sum of differences, test minus reference.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Difference {
    pub value: f64,
    /// Part of it that [rounding](Rounding) of the test image's means can explain. Roundings of a smooth image
    /// share their sign over whole regions, and those of pixels without noise are the same in each of them, so
    /// that in sums they add up.
    pub rounding: f64,
    /// Sum of the squares of these parts, by pixel.
    pub rounding_squares: f64,
    /// Part of that which codes of 8 bits make: half a code of each pixel, and what is cut off of its noise.
    pub half_codes: f64,
}

impl Difference {
    /// Difference of one pixel with the value `a` in the reference and `b` in the test image, which has this
    /// rounding and states this variance.
    pub fn of(a: f64, b: f64, variance: f64, rounding: Rounding) -> Difference {
        let half_codes = rounding.of_codes(a, b, variance);
        // Most renderers write half precision unless asked for more. References are of 32 bits, whose
        // rounding is nothing beside.
        let of_format = (rounding.relative * a.abs().max(b.abs())).max(DECIMALS);
        let rounding = half_codes + of_format;
        Difference {
            value: b - a,
            rounding,
            rounding_squares: rounding * rounding,
            half_codes,
        }
    }

    /// Part of it that rounding does not explain.
    pub fn beyond_rounding(&self) -> f64 {
        let beyond = (self.value.abs() - self.rounding).max(0.0);
        beyond.copysign(self.value)
    }

    pub fn add(&mut self, other: Difference) {
        self.value += other.value;
        self.rounding += other.rounding;
        self.rounding_squares += other.rounding_squares;
        self.half_codes += other.half_codes;
    }
}

/// Variance of a difference of sums, by its origin: reference and test image. The [module](super)
/// says why there are two estimates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Variance {
    /// Estimate from the images' statements, or from the spread of the differences.
    pub own: [f64; 2],
    /// Estimate from the finer of the two images.
    pub guard: [f64; 2],
}

impl Variance {
    pub fn own(&self) -> f64 {
        self.own[0] + self.own[1]
    }

    pub fn guard(&self) -> f64 {
        self.guard[0] + self.guard[1]
    }

    /// The larger of the two estimates.
    pub fn largest(&self) -> f64 {
        self.own().max(self.guard())
    }
}

/// Sums over one channel of a block, or of the image.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Channel {
    /// Sum of the reference.
    pub radiance: f64,
    pub difference: Difference,
    /// Sum of the squares of what rounding does not explain.
    pub squares: f64,
    /// Sums of the variances that reference and test image state; 0 where one does not.
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
    pub fn new(
        films: [&Film; 2],
        rounding: Rounding,
        columns: Range<usize>,
        rows: Range<usize>,
    ) -> Block {
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
                let stated = films.map(|film| film.variance_at(index, c));
                let difference = Difference::of(a[c].into(), b[c].into(), stated[1], rounding);
                let beyond = difference.beyond_rounding();
                channel.radiance += f64::from(a[c]);
                channel.squares += beyond * beyond;
                channel.difference.add(difference);
                spreads[c].add(difference.value);
                for (sum, stated) in channel.stated.iter_mut().zip(stated) {
                    *sum += stated;
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

    /// Indices of the pixels, in an image of `width` columns.
    pub fn indices(&self, width: usize) -> impl Iterator<Item = usize> + use<> {
        let columns = self.columns.clone();
        let row = move |row| columns.clone().map(move |column| row * width + column);
        self.rows.clone().flat_map(row)
    }

    pub fn pixels(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// Unit of a bias of `channel`: its sum over the block, and a little more.
    pub fn floor(&self, channel: usize) -> f64 {
        self.channels[channel].radiance.abs() + DARK * self.pixels() as f64
    }
}

/// The blocks of two images of one size, row by row from the top.
pub(super) fn blocks(films: [&Film; 2], rounding: Rounding) -> Vec<Block> {
    let rows = parts(films[0].height());
    let places =
        rows.flat_map(|rows| parts(films[0].width()).map(move |columns| (columns, rows.clone())));
    let block = |(columns, rows)| Block::new(films, rounding, columns, rows);
    places.map(block).collect()
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

//! Variances that an image does not state, or underestimates for want of samples.

use super::super::significance::critical;
use super::blocks::{BLOCK, Block, Channel};
use crate::film::Film;
use crate::math;

/// Statement of an image about its noise, with the number of values behind each variance. In the
/// order of how much is known: the finer of two images is the larger.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) enum Stated {
    /// No statement.
    Nothing,
    /// Spread of renderings, each the mean of an unknown number of samples.
    Renderings(f64),
    /// Spread of samples.
    Samples(f64),
    /// No noise: the radiance is known.
    Known,
}

impl Stated {
    pub fn by(film: &Film) -> Stated {
        match film.noise() {
            None => Stated::Nothing,
            Some(noise) if noise.is_known() => Stated::Known,
            Some(noise) if noise.is_of_renderings() => Stated::Renderings(noise.samples().into()),
            Some(noise) => Stated::Samples(noise.samples().into()),
        }
    }

    /// The statement for `times` as many samples.
    pub fn times(self, times: f64) -> Stated {
        match self {
            Stated::Samples(samples) => Stated::Samples(samples * times),
            uncounted => uncounted,
        }
    }
}

/// The noise of both images by that of the finer one: factors on the variances of the finer image
/// that give those of the other.
///
/// Where the reference is known, the finer image has none. The noise of the test image is then taken
/// to be spread as that of light that arrives or does not: a sample is 0 or the same number
/// everywhere, so that variances are in proportion to the radiance.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NoiseShape {
    /// 0: the reference is the finer image, 1: the test image.
    pub fine: usize,
    /// True if the reference is known, and [`coarse`](NoiseShape::coarse) and
    /// [`whole`](NoiseShape::whole) are variances over radiance.
    pub is_known: bool,
    /// Variance of the coarser image over that of the finer, of a block.
    pub coarse: f64,
    /// The ratio of the whole image, where the brightest parts count most.
    pub whole: f64,
    /// Share of the noise of the reference in the spread of the differences over the whole image;
    /// without meaning where both images state theirs.
    pub share_of_reference: f64,
    /// Relative standard error of `whole`, by how the ratio varies from block to block. A bound,
    /// which hangs on the few blocks that are largest, has about three times that of the ratio.
    pub error: f64,
}

/// Standard errors from which the noise of a silent reference is taken to be there: as a
/// deterministic one has none, and one in a thousand may be told otherwise.
const THERE: f64 = 3.0;

/// The image that does not state its noise, if there is one.
pub(super) fn unstated(stated: [Stated; 2]) -> Option<usize> {
    stated.iter().position(|stated| *stated == Stated::Nothing)
}

impl NoiseShape {
    /// `level` is the probability with which a ratio that is estimated may be larger than its bound.
    /// The test image is taken to have `times` the samples that it was looked at with.
    pub fn new(stated: [Stated; 2], blocks: &[Block], level: f64, times: f64) -> NoiseShape {
        let fine = usize::from(stated[1] > stated[0]);
        let silent = unstated(stated);
        let is_known = stated[0] == Stated::Known;
        let pair = |channel: &Channel| {
            let above = match silent {
                None => channel.stated[1 - fine],
                Some(_) => channel.spread,
            };
            let below = match is_known {
                true => channel.radiance.abs(),
                false => channel.stated[fine],
            };
            [above, below]
        };
        let bound = |ratio: &Ratio| match stated {
            [Stated::Samples(a), Stated::Samples(b)] => ratio.value().max(a.max(b) / a.min(b)),
            // Renderings do not say how many samples their spread is the noise of: the ratio is
            // estimated, as it is for an image that states nothing, whose spread is the noise of
            // both.
            _ => {
                let pixels = (BLOCK * BLOCK) as f64;
                let degrees = match stated[1 - fine] {
                    Stated::Renderings(count) | Stated::Samples(count) => pixels * (count - 1.0),
                    _ => pixels - 1.0,
                };
                let bound = ratio.upper_of_more(critical(level), degrees, times);
                // Known values have no share in it.
                let own = f64::from(silent.is_some() && !is_known);
                (bound - own).max(0.0)
            }
        };
        // Relative to the brightness of each block, so that no lamp outweighs the room.
        let of_block = |block: &Block| [0, 1, 2].map(|c| block.floor(c));
        let floors = blocks.iter().map(of_block);
        let image = floors.fold([0.0; 3], |a, b| [0, 1, 2].map(|c| a[c] + b[c]));
        let of_blocks = Ratio::new(blocks, of_block, pair);
        let of_whole = Ratio::new(blocks, |_| image, pair);
        let error = of_whole.error();
        // The share of the finer image, the one that is not silent.
        let share = match of_whole.value() {
            ratio if ratio > 0.0 => (1.0 / ratio).min(1.0),
            _ => 0.0,
        };
        let share_of_reference = match 1.0 - share {
            _ if is_known => 0.0,
            _ if fine == 0 => share,
            left if left > THERE * error => left,
            _ => 0.0,
        };
        NoiseShape {
            fine,
            is_known,
            coarse: bound(&of_blocks),
            whole: bound(&of_whole),
            share_of_reference,
            error: match stated {
                [Stated::Samples(_), Stated::Samples(_)] => error,
                _ => 3.0 * error,
            },
        }
    }

    /// Variances of reference and test image, of which `stated` holds that of the finer one, and
    /// where the reference has `radiance`.
    pub fn guard(&self, stated: [f64; 2], radiance: f64) -> [f64; 2] {
        if self.is_known {
            return [0.0, radiance.abs() * self.coarse];
        }
        let mut guard = [0.0; 2];
        guard[self.fine] = stated[self.fine];
        guard[1 - self.fine] = stated[self.fine] * self.coarse;
        guard
    }

    /// Variance of the difference of whole images, of which `stated` holds that of the finer one, and
    /// of which the reference has `radiance`.
    pub fn guard_of_whole(&self, stated: [f64; 2], radiance: f64) -> f64 {
        if self.is_known {
            return radiance.abs() * self.whole;
        }
        stated[self.fine] * (1.0 + self.whole)
    }
}

/// Variances over those of the finer image. One pair for each block: its channels may share their
/// noise.
struct Ratio(Vec<[f64; 2]>);

impl Ratio {
    /// Ratio of the variances of each channel, relative to the square of a radiance.
    fn new(
        blocks: &[Block],
        radiance: impl Fn(&Block) -> [f64; 3],
        pair: impl Fn(&Channel) -> [f64; 2],
    ) -> Ratio {
        let of_block = |block: &Block| {
            let mut sums = [0.0; 2];
            for (channel, radiance) in block.channels.iter().zip(radiance(block)) {
                let [above, below] = pair(channel);
                sums[0] += above / (radiance * radiance);
                sums[1] += below / (radiance * radiance);
            }
            sums
        };
        Ratio(blocks.iter().map(of_block).collect())
    }

    fn sums(&self) -> [f64; 2] {
        [0, 1].map(|i| self.0.iter().map(|pair| pair[i]).sum())
    }

    /// The ratio of the sums; 0 where the finer image has no noise.
    fn value(&self) -> f64 {
        let [above, below] = self.sums();
        if below > 0.0 { above / below } else { 0.0 }
    }

    /// Upper bound on the ratio, `z` standard errors up. A few bright events in the whole image
    /// count as a Poisson number: k of them are too few for up to λ = k + z²/2 + z·√(k + z²/4),
    /// where λ − k is z·√λ. The same of sums with the excess of a block over the ratio as its
    /// event.
    fn upper(&self, z: f64) -> f64 {
        let [above, below] = self.sums();
        if below <= 0.0 {
            return 0.0;
        }
        let excesses = self.excesses();
        let squares = excesses.clone().map(|excess| excess * excess).sum();
        let largest = excesses.fold(0.0, f64::max);
        (above + excess(z, squares, largest)) / below
    }

    /// Value of [`upper`](Ratio::upper) for an image with `times` the samples, whose variances
    /// above are already that much smaller. Its excess over the ratio stays where it comes from
    /// blocks that are normal, of so many `degrees` of freedom, and where the noise of the images
    /// lies in other places; it falls as the root of the samples where it comes from rare events.
    /// It is taken to fall as the root of that root, and not below what it has of normal blocks.
    fn upper_of_more(&self, z: f64, degrees: f64, times: f64) -> f64 {
        let (value, upper) = (self.value(), self.upper(z));
        let [_, below] = self.sums();
        if upper <= value {
            return upper;
        }
        let variance = |above: f64| 2.0 / degrees * above * above;
        let squares = self.0.iter().map(|[above, _]| variance(*above)).sum();
        let widest = self.0.iter().map(|[above, _]| *above).fold(0.0, f64::max);
        // What the largest of as many normal numbers is about.
        let most = (2.0 * math::ln(self.0.len() as f64)).sqrt();
        let normal = excess(z, squares, most * variance(widest).sqrt()) / below;
        let least = 1.0 / times.sqrt().sqrt();
        value + (upper - value) * (normal / (upper - value)).clamp(least, 1.0)
    }

    /// Relative standard error of [`value`](Ratio::value), from how far single blocks are from it.
    fn error(&self) -> f64 {
        let [above, _] = self.sums();
        let squares: f64 = self.excesses().map(|excess| excess * excess).sum();
        if above > 0.0 {
            squares.sqrt() / above
        } else {
            0.0
        }
    }

    /// Excess of each block over the ratio of all.
    fn excesses(&self) -> impl Iterator<Item = f64> + Clone {
        let ratio = self.value();
        let excess = move |[above, below]: &[f64; 2]| above - ratio * below;
        self.0.iter().map(excess)
    }
}

/// Excess of a sum at `z` standard errors, of parts whose squared excesses have this sum and whose
/// largest is an event that may be rare.
fn excess(z: f64, squares: f64, largest: f64) -> f64 {
    let more = 0.5 * z * largest;
    z * more + z * (squares + more * more).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// k blocks of a thousand hold an event of 1, the finer image knows that any may.
    fn events(k: usize) -> Ratio {
        Ratio(
            (0..1000)
                .map(|i| [f64::from(u8::from(i < k)), 1.0])
                .collect(),
        )
    }

    /// λ events are z standard errors, √λ each, from the k that came.
    #[test]
    fn few_events_may_have_been_many() {
        for (k, z) in [(1, 3.0), (4, 6.0), (30, 6.5)] {
            let expected = 1000.0 * events(k).upper(z);
            assert!(expected > k as f64);
            let errors = (expected - k as f64) / expected.sqrt();
            // For an event, the excess over the ratio is less than 1 by a few in a thousand.
            assert!((errors / z - 1.0).abs() < 0.05, "{k}: {errors}");
        }
        assert_eq!(events(30).value(), 0.03);
    }

    #[test]
    fn an_even_ratio_is_known() {
        let even = Ratio(vec![[0.5, 0.25], [2.0, 1.0], [4.0, 2.0]]);
        assert_eq!((even.value(), even.upper(6.0)), (2.0, 2.0));
        let without = Ratio(vec![[0.5, 0.0]]);
        assert_eq!((without.value(), without.upper(6.0)), (0.0, 0.0));
    }
}

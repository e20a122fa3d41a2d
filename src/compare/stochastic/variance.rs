//! What the variance is where an image cannot know it, or does not say.

use super::super::significance::critical;
use super::blocks::Block;
use crate::film::Film;

/// The noise of both images by that of the finer one: what the variances of the finer image are
/// to be multiplied by to give those of the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// 0: the reference is the finer image, 1: the test image.
    pub fine: usize,
    /// Variance of the coarser image over that of the finer, of a block.
    pub coarse: f64,
    /// The same of the whole image, where the brightest parts count most.
    pub whole: f64,
}

/// The image that does not state its noise, if there is one.
pub(super) fn unstated(films: [&Film; 2]) -> Option<usize> {
    films.iter().position(|film| film.noise().is_none())
}

impl Shape {
    pub fn new(films: [&Film; 2], blocks: &[Block], level: f64) -> Shape {
        let samples = films.map(|film| film.noise().map(|noise| f64::from(noise.samples())));
        // Relative to the brightness of each block, so that no lamp outweighs the room.
        let of_block = |block: &Block| [0, 1, 2].map(|c| block.floor(c));
        let floors = blocks.iter().map(of_block);
        let image = floors.fold([0.0; 3], |a, b| [0, 1, 2].map(|c| a[c] + b[c]));
        let of_image = |_: &Block| image;
        match samples {
            [Some(a), Some(b)] => {
                let fine = if a >= b { 0 } else { 1 };
                let pair = |stated: [f64; 2], _| [stated[1 - fine], stated[fine]];
                let least = a.max(b) / a.min(b);
                Shape {
                    fine,
                    coarse: Ratio::new(blocks, of_block, pair).value().max(least),
                    whole: Ratio::new(blocks, of_image, pair).value().max(least),
                }
            }
            _ => {
                let fine = if samples[0].is_some() { 0 } else { 1 };
                let pair = |stated: [f64; 2], spread| [spread, stated[fine]];
                let z = critical(level);
                // The spread is the noise of both.
                let without = |both: f64| (both - 1.0).max(0.0);
                Shape {
                    fine,
                    coarse: without(Ratio::new(blocks, of_block, pair).upper(z)),
                    whole: without(Ratio::new(blocks, of_image, pair).upper(z)),
                }
            }
        }
    }

    /// Variances of reference and test image, of which `stated` holds that of the finer one.
    pub fn guard(&self, stated: [f64; 2]) -> [f64; 2] {
        let mut guard = [0.0; 2];
        guard[self.fine] = stated[self.fine];
        guard[1 - self.fine] = stated[self.fine] * self.coarse;
        guard
    }

    /// Variance of the difference of whole images, of which `stated` holds that of the finer one.
    pub fn guard_of_whole(&self, stated: [f64; 2]) -> f64 {
        stated[self.fine] * (1.0 + self.whole)
    }
}

/// Variances over those of the finer image. One pair for each block: its channels may share their
/// noise.
struct Ratio(Vec<[f64; 2]>);

impl Ratio {
    /// Of the variances of each channel, relative to the square of a radiance.
    fn new(
        blocks: &[Block],
        radiance: impl Fn(&Block) -> [f64; 3],
        pair: impl Fn([f64; 2], f64) -> [f64; 2],
    ) -> Ratio {
        let of_block = |block: &Block| {
            let mut sums = [0.0; 2];
            for (channel, radiance) in block.channels.iter().zip(radiance(block)) {
                let [above, below] = pair(channel.stated, channel.spread);
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

    /// The most it may be, `z` standard errors up. A few bright events in the whole image count
    /// as a Poisson number: k of them are too few for up to λ = k + z²/2 + z·√(k + z²/4), where
    /// λ − k is z·√λ. The same of sums with the excess of a block over the ratio as its event.
    fn upper(&self, z: f64) -> f64 {
        let [above, below] = self.sums();
        if below <= 0.0 {
            return 0.0;
        }
        let ratio = above / below;
        let (mut squares, mut largest) = (0.0, 0.0_f64);
        for [above, below] in &self.0 {
            let excess = above - ratio * below;
            squares += excess * excess;
            largest = largest.max(excess);
        }
        let more = 0.5 * z * largest;
        (above + z * more + z * (squares + more * more).sqrt()) / below
    }
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
            // Of an event, the excess over the ratio is less than 1 by a few in a thousand.
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

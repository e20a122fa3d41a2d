//! The random numbers of one path.

use super::tracking::{Tentative, TentativeNumbers};
use crate::math::rng::{Purpose, Stream};
use crate::math::sampling::optical_distance;

/// The source of all random numbers of a path, with a count.
///
/// The count is one addition beside about a hundred operations per number, so it needs no kernel of
/// its own: [`Sampler::given`] goes into the counters at the end of the path.
#[derive(Clone, Debug)]
pub struct Sampler {
    stream: Stream,
    bounce: u32,
    /// Pairs given at this bounce, by [`NumberRow`].
    rows: [u32; 3],
    given: u64,
}

/// Tentative collisions that share one row of numbers: every bounce begins each row anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberRow {
    /// The numbers of the free flight.
    FreeFlight,
    /// The numbers of emission along the ray.
    Emission,
    /// The numbers of all transmittances estimated at the bounce, in the order of the estimates.
    Transmittance,
}

impl NumberRow {
    fn purpose(self) -> Purpose {
        match self {
            NumberRow::FreeFlight => Purpose::FreeFlight,
            NumberRow::Emission => Purpose::Emission,
            NumberRow::Transmittance => Purpose::Tracking,
        }
    }
}

impl Sampler {
    /// Upper limit of bounces, exclusive.
    pub const BOUNCES: u32 = Stream::BOUNCES;

    /// The numbers of `stream`, from the first bounce on.
    pub fn new(stream: Stream) -> Sampler {
        Sampler {
            stream,
            bounce: 0,
            rows: [0; 3],
            given: 0,
        }
    }

    /// A sampler for integrals, which use no random numbers.
    pub fn for_integrals() -> Sampler {
        Sampler::new(Stream::new(0, 0, 0))
    }

    /// Continues with the numbers of `bounce`.
    pub(crate) fn begin_bounce(&mut self, bounce: u32) {
        self.bounce = bounce;
        self.rows = [0; 3];
    }

    /// A number for `purpose`, uniform in [0, 1).
    pub fn one(&mut self, purpose: Purpose) -> f64 {
        self.given += 1;
        self.stream.uniform(self.bounce, purpose, 0)
    }

    /// The `index`-th pair of numbers for `purpose`, each uniform in [0, 1).
    pub fn pair(&mut self, purpose: Purpose, index: usize) -> [f64; 2] {
        self.given += 2;
        self.stream.pair(self.bounce, purpose, index as u32)
    }

    /// The tentative collisions of `row`, from the first that has not been given.
    pub fn tentative(&mut self, row: NumberRow) -> SamplerRow<'_> {
        SamplerRow { sampler: self, row }
    }

    /// Numbers given so far.
    pub fn given(&self) -> u64 {
        self.given
    }
}

/// A [`NumberRow`] of a [`Sampler`].
#[derive(Debug)]
pub struct SamplerRow<'s> {
    sampler: &'s mut Sampler,
    row: NumberRow,
}

impl TentativeNumbers for SamplerRow<'_> {
    fn next(&mut self) -> Tentative {
        let index = &mut self.sampler.rows[self.row as usize];
        let pair = *index;
        // Media too deep for it are refused on load: see scene/radiative/media.rs.
        *index = index.wrapping_add(1);
        let [distance, u] = self.sampler.pair(self.row.purpose(), pair as usize);
        Tentative {
            optical_distance: optical_distance(distance),
            u,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_counted() {
        let stream = Stream::new(7, 1, 2);
        let mut sampler = Sampler::new(stream);
        sampler.begin_bounce(3);
        assert_eq!(
            sampler.one(Purpose::Roulette),
            stream.uniform(3, Purpose::Roulette, 0)
        );
        assert_eq!(
            sampler.pair(Purpose::LightPoint, 5),
            stream.pair(3, Purpose::LightPoint, 5)
        );
        assert_eq!(sampler.given(), 3);
    }

    /// A row goes on where it was left, beside the others, and begins anew at every bounce.
    #[test]
    fn rows_go_on_within_a_bounce() {
        let stream = Stream::new(7, 1, 2);
        let mut sampler = Sampler::new(stream);
        let expected = |bounce, purpose, index| {
            let [distance, u] = stream.pair(bounce, purpose, index);
            Tentative {
                optical_distance: optical_distance(distance),
                u,
            }
        };
        for bounce in [0, 1] {
            sampler.begin_bounce(bounce);
            for index in [0, 1] {
                for row in [
                    NumberRow::FreeFlight,
                    NumberRow::Emission,
                    NumberRow::Transmittance,
                ] {
                    assert_eq!(
                        sampler.tentative(row).next(),
                        expected(bounce, row.purpose(), index)
                    );
                }
            }
        }
        assert_eq!(sampler.given(), 24);
    }
}

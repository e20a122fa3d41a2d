//! Random numbers in the order in which a path asks for them.

use crate::math::rng::{Purpose, Stream};

/// Maximum number of random numbers per path.
const MOST: u32 = 1 << 26;

/// The random numbers of one path.
pub struct Random {
    stream: Stream,
    drawn: u32,
}

impl Random {
    /// The random numbers for sample `sample` of pixel index `pixel`, given `seed`.
    pub fn new(seed: u64, pixel: u32, sample: u32) -> Random {
        let stream = Stream::new(seed, pixel, sample);
        Random { stream, drawn: 0 }
    }

    /// The next number, uniform in [0, 1). Once all are drawn it is 1: no more collisions, and no
    /// survival, so that the path ends.
    pub fn next(&mut self) -> f64 {
        let index = self.drawn;
        self.drawn += 1;
        if index < MOST {
            self.stream.uniform(0, Purpose::Reference, index)
        } else {
            1.0
        }
    }

    /// The next two numbers.
    pub fn pair(&mut self) -> [f64; 2] {
        [self.next(), self.next()]
    }

    /// The path asked for more numbers than there are.
    pub fn is_exhausted(&self) -> bool {
        self.drawn > MOST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_without_an_end_is_noticed() {
        let mut random = Random::new(1, 2, 3);
        random.drawn = MOST - 1;
        assert!(random.next() < 1.0 && !random.is_exhausted());
        assert_eq!(random.next(), 1.0);
        assert!(random.is_exhausted());
    }
}

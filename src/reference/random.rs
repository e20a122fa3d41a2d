//! Random numbers in the order in which a path asks for them.

use crate::math::rng::{Purpose, Stream};

/// The random numbers of one path, one after the other.
pub struct Random {
    stream: Stream,
    given: u32,
}

impl Random {
    /// The numbers of sample `sample` of the pixel with index `pixel`, under `seed`.
    pub fn new(seed: u64, pixel: u32, sample: u32) -> Random {
        let stream = Stream::new(seed, pixel, sample);
        Random { stream, given: 0 }
    }

    /// The next number, uniform in [0, 1).
    pub fn next(&mut self) -> f64 {
        let number = self.stream.uniform(0, Purpose::Reference, self.given);
        self.given += 1;
        number
    }
}

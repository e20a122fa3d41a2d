//! Random numbers in the order in which a path asks for them.

use crate::math::rng::{Purpose, Stream};

/// Numbers for one path, at most. A path that draws all of them is reported as endless.
const MOST: u32 = 1 << 26;

/// The random numbers of one path.
pub struct Random {
    stream: Stream,
    drawn: u32,
}

impl Random {
    /// The numbers of sample `sample` of the pixel with index `pixel`, under `seed`.
    pub fn new(seed: u64, pixel: u32, sample: u32) -> Random {
        let stream = Stream::new(seed, pixel, sample);
        Random { stream, drawn: 0 }
    }

    /// The next number, uniform in [0, 1); NaN once all are drawn.
    pub fn next(&mut self) -> f64 {
        if self.is_exhausted() {
            return f64::NAN;
        }
        let number = self.stream.uniform(0, Purpose::Reference, self.drawn);
        self.drawn += 1;
        number
    }

    /// The next two numbers.
    pub fn pair(&mut self) -> [f64; 2] {
        [self.next(), self.next()]
    }

    /// Whether all numbers are drawn.
    pub fn is_exhausted(&self) -> bool {
        self.drawn == MOST
    }
}

//! Random numbers in the order in which a path asks for them.

use crate::math::rng::{Purpose, Stream};

/// Maximum number of random numbers per path.
const MOST: u32 = 1 << 26;

/// A path that drew all its random numbers and did not end.
#[derive(Clone, Copy, Debug)]
pub struct Exhausted {
    /// Index of its pixel.
    pub pixel: u32,
}

/// The random numbers of one path.
pub struct Random {
    stream: Stream,
    pixel: u32,
    drawn: u32,
}

impl Random {
    /// The random numbers for sample `sample` of pixel index `pixel`, given `seed`.
    pub fn new(seed: u64, pixel: u32, sample: u32) -> Random {
        let stream = Stream::new(seed, pixel, sample);
        Random {
            stream,
            pixel,
            drawn: 0,
        }
    }

    /// The next number, uniform in [0, 1).
    pub fn next(&mut self) -> Result<f64, Exhausted> {
        if self.drawn == MOST {
            return Err(Exhausted { pixel: self.pixel });
        }
        let number = self.stream.uniform(0, Purpose::Reference, self.drawn);
        self.drawn += 1;
        Ok(number)
    }

    /// The next two numbers.
    pub fn pair(&mut self) -> Result<[f64; 2], Exhausted> {
        Ok([self.next()?, self.next()?])
    }
}

//! The random numbers of one turn of one path.

use crate::math::rng::{Purpose, Stream};
use crate::render::counters::{Event, Work};

/// The random numbers of the turn with number `bounce`, counted as they are drawn.
#[derive(Clone, Copy, Debug)]
pub struct Draws<'r> {
    /// The numbers of the path.
    pub random: &'r Stream,
    /// Turns before this one.
    pub bounce: u32,
}

impl Draws<'_> {
    /// A number for `purpose`, uniform in [0, 1).
    pub fn one<W: Work>(&self, purpose: Purpose, work: &mut W) -> f64 {
        work.count(Event::RandomDraw);
        self.random.uniform(self.bounce, purpose, 0)
    }

    /// The `index`-th pair of numbers for `purpose`, each uniform in [0, 1).
    pub fn pair<W: Work>(&self, purpose: Purpose, index: usize, work: &mut W) -> [f64; 2] {
        work.count_times(Event::RandomDraw, 2);
        self.random.pair(self.bounce, purpose, index as u32)
    }
}

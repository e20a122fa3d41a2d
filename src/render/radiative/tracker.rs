//! What estimates by tracking need besides the matter: random numbers, memory, and an account.

use super::majorants::Strand;
use super::tracking::{Chance, Effort, Tentative};
use crate::geometry::Span;
use crate::math::ln_1p;
use crate::math::rng::{Purpose, Stream};

/// Random numbers of tentative collisions, for one purpose at one turn of a path.
#[derive(Clone, Copy, Debug)]
pub struct Numbers {
    random: Stream,
    bounce: u32,
    purpose: Purpose,
    /// Pairs drawn so far.
    pub drawn: u32,
}

impl Numbers {
    /// The numbers of turn `bounce` for `purpose`, from the first on.
    pub fn new(random: &Stream, bounce: u32, purpose: Purpose) -> Numbers {
        Numbers {
            random: *random,
            bounce,
            purpose,
            drawn: 0,
        }
    }
}

impl Chance for Numbers {
    fn tentative(&mut self) -> Tentative {
        let [way, u] = self.random.pair(self.bounce, self.purpose, self.drawn);
        // Media too deep for it are refused on load: see scene/radiative/media.rs.
        self.drawn = self.drawn.wrapping_add(1);
        Tentative {
            way: -ln_1p(-way),
            u,
        }
    }
}

/// Memory, random numbers and the account of estimates along rays.
#[derive(Debug)]
pub struct Tracker {
    /// Spans of a shape along a ray.
    pub spans: Vec<Span>,
    strands: Vec<Strand>,
    numbers: Numbers,
    effort: Effort,
}

impl Default for Tracker {
    fn default() -> Tracker {
        Tracker {
            spans: Vec::new(),
            strands: Vec::new(),
            numbers: Numbers::new(&Stream::new(0, 0, 0), 0, Purpose::Tracking),
            effort: Effort::default(),
        }
    }
}

impl Tracker {
    /// Goes on with the random numbers of turn `bounce` of a path. All estimates of
    /// transmittance at that turn share one row of them, in the order in which they are asked.
    pub fn at_turn(&mut self, random: &Stream, bounce: u32) {
        self.numbers = Numbers::new(random, bounce, Purpose::Tracking);
    }

    /// How often an extinction was above its bound since the last call: a fault of the bound.
    pub fn take_violations(&mut self) -> u64 {
        std::mem::take(&mut self.effort.violations)
    }

    /// Memory of strands, random numbers and account, side by side.
    pub(in crate::render) fn parts(&mut self) -> (&mut Vec<Strand>, &mut Numbers, &mut Effort) {
        (&mut self.strands, &mut self.numbers, &mut self.effort)
    }
}

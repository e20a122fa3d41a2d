//! Random numbers, memory and counters of an estimate along a ray.

use super::majorants::HeterogeneousSegment;
use super::sampler::Sampler;
use super::tracking::Effort;
use crate::geometry::Span;
use crate::render::counters::Counters;

/// Random numbers, memory and counters, handed from estimate to estimate along a path.
#[derive(Debug)]
pub struct Tracker<'c> {
    /// Random numbers of the path.
    pub sampler: Sampler,
    /// Memory kept from ray to ray.
    pub scratch: &'c mut TrackerScratch,
    /// Counters of the work done.
    pub work: &'c mut Counters,
}

/// Memory kept from ray to ray, and lookups above their majorants.
#[derive(Debug, Default)]
pub struct TrackerScratch {
    /// Spans of a shape along a ray.
    pub spans: Vec<Span>,
    /// Heterogeneous media along a ray.
    pub heterogeneous: Vec<HeterogeneousSegment>,
    /// Lookups, and those above their majorants.
    pub effort: Effort,
}

impl<'c> Tracker<'c> {
    /// A tracker with the random numbers of `sampler`.
    pub fn new(sampler: Sampler, scratch: &'c mut TrackerScratch, work: &'c mut Counters) -> Self {
        Tracker {
            sampler,
            scratch,
            work,
        }
    }

    /// A tracker for integrals, which use no random numbers.
    pub fn for_integrals(scratch: &'c mut TrackerScratch, work: &'c mut Counters) -> Self {
        Tracker::new(Sampler::for_integrals(), scratch, work)
    }
}

//! The state of a path on its way from the eye.

use super::sampler::Sampler;
use super::segments::MediumSegments;
use super::tracker::{Tracker, TrackerScratch};
use super::variance_reduction::specular_chain::SpecularChain;
use crate::geometry::Ray;
use crate::render::counters::Counters;
use glam::DVec3;

/// A path under way.
#[derive(Debug)]
pub struct PathContext<'c> {
    /// The ray under way.
    pub ray: Ray,
    /// Fraction, by channel, of the radiance along the ray that reaches the eye.
    pub throughput: DVec3,
    /// The part of the throughput that path guiding has brought about, a factor.
    pub guidance: f64,
    /// The bounce at which the ray starts.
    pub previous: PreviousBounce,
    /// Bounces so far: the scattering order of light found next is one more.
    pub depth: u32,
    /// Vertices so far that scatter into a range of directions.
    pub vertices: u32,
    /// Bounces left within the limit of the scene.
    pub bounces_left: u32,
    /// The media along the ray.
    pub segments: &'c mut MediumSegments,
    /// The media along the ray before, if there is one.
    pub previous_segments: &'c mut MediumSegments,
    /// Memory for the media along a connection to a light vertex.
    pub connection: &'c mut MediumSegments,
    /// Random numbers, memory and counters.
    pub tracker: Tracker<'c>,
}

/// The choice of a direction that a ray left in.
#[derive(Clone, Copy, Debug)]
pub enum PreviousBounce {
    /// The eye: no other sampler finds a light along the ray.
    Eye,
    /// A mirror or glass.
    Specular(SpecularChain),
    /// A diffuse surface: the density of the direction, per steradian.
    Surface(f64),
    /// A collision with media.
    Medium(PreviousCollision),
}

/// The collision at which the ray under way starts.
#[derive(Clone, Copy, Debug)]
pub struct PreviousCollision {
    /// Density of the direction, per steradian.
    pub pdf: f64,
    /// The ray that ended at it.
    pub ray: Ray,
    /// Distance of the collision on it.
    pub t: f64,
}

impl PreviousBounce {
    /// Density of the direction, per steradian; `None` where there is no range of directions.
    pub fn pdf(&self) -> Option<f64> {
        match *self {
            PreviousBounce::Eye | PreviousBounce::Specular(_) => None,
            PreviousBounce::Surface(pdf)
            | PreviousBounce::Medium(PreviousCollision { pdf, .. }) => Some(pdf),
        }
    }
}

/// Memory kept from path to path.
#[derive(Debug, Default)]
pub struct Scratch {
    /// The media along the ray under way.
    pub segments: MediumSegments,
    previous_segments: MediumSegments,
    connection: MediumSegments,
    /// Memory of estimates along rays.
    pub tracker: TrackerScratch,
}

impl<'c> PathContext<'c> {
    /// A path that begins at the eye along `ray`, of `limit` bounces at most, with the random
    /// numbers of `sampler`.
    pub fn new(
        ray: Ray,
        limit: u32,
        sampler: Sampler,
        scratch: &'c mut Scratch,
        work: &'c mut Counters,
    ) -> Self {
        PathContext {
            ray,
            throughput: DVec3::ONE,
            guidance: 1.0,
            previous: PreviousBounce::Eye,
            depth: 0,
            vertices: 0,
            bounces_left: limit,
            segments: &mut scratch.segments,
            previous_segments: &mut scratch.previous_segments,
            connection: &mut scratch.connection,
            tracker: Tracker::new(sampler, &mut scratch.tracker, work),
        }
    }

    /// Continues along `ray` after a bounce.
    pub fn go_on(&mut self, ray: Ray, previous: PreviousBounce) {
        self.ray = ray;
        self.previous = previous;
        std::mem::swap(self.segments, self.previous_segments);
        self.depth += 1;
        self.bounces_left -= 1;
        self.tracker.sampler.begin_bounce(self.depth);
    }
}

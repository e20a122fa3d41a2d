//! The samples of a ray, in batches.
//!
//! All samples of a batch are looked up before the first of them is composited. None waits for another, so
//! that a processor works on several at once, and their opacities over their steps are computed together.

use super::compositing::CompositingOrder;
use super::empty_space::Skipping;
use super::steps::Steps;
use crate::render::counters::Work;
use crate::volume::{NodeLine, NodePoints};

/// Samples of a batch, at most.
pub const BATCH: usize = 8;

/// Some samples of a ray. Behind their number, arrays hold anything finite.
#[derive(Clone, Copy, Debug, Default)]
pub struct Batch {
    /// Their number; 0 at the end of the ray.
    pub count: usize,
    /// Distances from the origin of the ray, world units.
    pub distances: [f64; BATCH],
    /// Positions.
    pub points: NodePoints<BATCH>,
    /// Lengths of their steps, relative to the reference length of the opacity.
    pub lengths: [f64; BATCH],
}

/// The samples of a ray, from the first that no batch has held.
#[derive(Clone, Copy, Debug)]
pub struct Batches {
    steps: Steps,
    line: NodeLine,
    /// Change of a node coordinate from sample to sample, at most.
    reach: f64,
    /// Length of a step relative to the reference length.
    relative_step: f64,
    reference_length: f64,
    /// Samples held by batches or skipped.
    done: usize,
}

impl Batches {
    /// All samples at `steps` along `line`; `reference_length` is that of the opacity, world units.
    #[inline(always)]
    pub fn new(steps: Steps, line: NodeLine, reference_length: f64) -> Batches {
        Batches {
            steps,
            line,
            reach: line.reach(steps.length()),
            reference_length,
            relative_step: steps.length() / reference_length,
            done: 0,
        }
    }

    /// Puts the next samples into `batch`, of which `skipping` leaves out those in empty space.
    #[inline(always)]
    pub fn next<O: CompositingOrder, W: Work>(
        &mut self,
        batch: &mut Batch,
        skipping: Option<&impl Skipping>,
        work: &mut W,
    ) {
        batch.count = 0;
        if skipping.is_none() {
            self.whole::<O>(batch);
        }
        let all = self.steps.count();
        while self.done < all && batch.count < BATCH {
            let (t, length) = self.steps.sample(O::index(self.done, all));
            let nodes = self.line.at(t);
            if let Some(skipping) = skipping {
                let skipped = skipping.transparent_samples(nodes, self.reach, work);
                if skipped > 0 {
                    self.done = all.min(self.done + skipped);
                    continue;
                }
            }
            self.done += 1;
            batch.distances[batch.count] = t;
            for (axis, points) in batch.points.iter_mut().enumerate() {
                points[batch.count] = nodes.0[axis];
            }
            // The last step of a ray is shorter.
            batch.lengths[batch.count] = if length == self.steps.length() {
                self.relative_step
            } else {
                length / self.reference_length
            };
            batch.count += 1;
        }
    }

    /// Fills `batch` with whole steps, if the ray has as many left.
    #[inline(always)]
    fn whole<O: CompositingOrder>(&mut self, batch: &mut Batch) {
        let all = self.steps.count();
        if all - self.done < BATCH {
            return;
        }
        let ends = [self.done, self.done + BATCH - 1].map(|done| O::index(done, all));
        if let Some(distances) = self.steps.whole(ends) {
            self.done += BATCH;
            batch.count = BATCH;
            batch.distances = distances;
            batch.points = self.line.at_several(&distances);
            batch.lengths = [self.relative_step; BATCH];
        }
    }
}

//! Bounds on a density, block by block.

use super::{DensityField, DensityRange, Walk};
use crate::geometry::{Aabb, Line, Span};
use crate::math::Sum;
use glam::{BVec3, DVec3};
use rayon::prelude::*;

/// A box divided into equal blocks, with bounds on a density in each of them.
#[derive(Clone, Debug)]
pub struct Blocks {
    bounds: Aabb,
    counts: [usize; 3],
    size: DVec3,
    ranges: Vec<DensityRange>,
}

impl Blocks {
    /// Bounds on `field` in `counts` blocks (at least one along each axis) of edges `size` from
    /// the smallest corner of `bounds` on. The last block of an axis reaches to the face of
    /// `bounds`, if that is beyond.
    pub fn of(field: &impl DensityField, bounds: Aabb, counts: [usize; 3], size: DVec3) -> Blocks {
        let mut blocks = Blocks {
            bounds,
            counts,
            size,
            ranges: Vec::new(),
        };
        let count: usize = counts.iter().product();
        blocks.ranges = (0..count)
            .into_par_iter()
            .map(|index| {
                let [nx, ny, _] = counts;
                let cell = [index % nx, index / nx % ny, index / (nx * ny)];
                field.range_over(&blocks.cell_bounds(cell))
            })
            .collect();
        blocks
    }

    /// The box that is divided.
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// Bounds on the density in all blocks together.
    pub fn range(&self) -> DensityRange {
        let ranges = self.ranges.iter().copied();
        ranges
            .reduce(DensityRange::union)
            .expect("at least one block")
    }

    /// The mean over all blocks of the middle between their bounds.
    pub(crate) fn typical(&self) -> f64 {
        let middles = self
            .ranges
            .iter()
            .map(|range| 0.5 * (range.low + range.high));
        let sum: Sum = middles.collect();
        sum.value() / self.ranges.len() as f64
    }

    /// The blocks along `line`, which is in the box over `span`.
    pub fn walk(&self, line: &Line, span: Span) -> Walk {
        let origin = (line.origin - self.bounds.min) / self.size;
        Walk::new(self.counts, origin, line.direction / self.size, span)
    }

    /// Bounds on the density in a block.
    pub fn range_in(&self, [i, j, k]: [usize; 3]) -> DensityRange {
        self.ranges[(k * self.counts[1] + j) * self.counts[0] + i]
    }

    /// Bounds on the density in the block around `point`, or in the nearest.
    pub(crate) fn range_at(&self, point: DVec3) -> DensityRange {
        let cell = (point - self.bounds.min) / self.size;
        // Casts clamp at 0.
        let index = |axis: usize| (cell[axis] as usize).min(self.counts[axis] - 1);
        self.range_in([index(0), index(1), index(2)])
    }

    /// The space of a block: its [range](Blocks::range_in) holds there, faces included.
    pub fn cell_bounds(&self, cell: [usize; 3]) -> Aabb {
        let index = |cell: [usize; 3]| DVec3::from_array(cell.map(|index| index as f64));
        let min = self.bounds.min + self.size * index(cell);
        let beyond = self.bounds.min + self.size * index(cell.map(|index| index + 1));
        let is_last = [0, 1, 2].map(|axis| cell[axis] + 1 == self.counts[axis]);
        let max = DVec3::select(BVec3::from_array(is_last), self.bounds.max, beyond);
        // Roundings of the corners must not turn a block over.
        Aabb {
            min: min.min(max),
            max,
        }
    }
}

//! A heterogeneous medium along a ray: majorants block by block, densities in between.

use crate::geometry::{Aabb, Line, Ray, Span};
use crate::optics::Density;
use crate::volume::{DensityField, DensityRange, Visit, Walk};

/// The blocks of a heterogeneous medium along a ray.
#[derive(Clone, Debug)]
pub struct HeterogeneousSegment {
    /// Index of the medium among those of the scene.
    pub medium: usize,
    line: Line,
    walk: Walk,
    /// The visit to the block behind the present gap.
    next_visit: Option<Visit>,
    /// Distance at which the present block, or gap, ends.
    pub end: f64,
    /// Range of the density up to there.
    pub range: DensityRange,
    /// The present block, in the coordinates of the field.
    block: Aabb,
    /// The density last looked up.
    pub density: f64,
}

impl HeterogeneousSegment {
    /// The medium with index `medium`, of this `density`, along `ray` over `span`, which lies in
    /// it; `None` where the span misses the box of the density.
    pub fn new(
        medium: usize,
        density: &Density,
        ray: &Ray,
        span: Span,
    ) -> Option<HeterogeneousSegment> {
        let (line, inside) = density.along(ray, span)?;
        Some(HeterogeneousSegment {
            medium,
            line,
            walk: density.walk(&line, inside),
            next_visit: None,
            end: span.near,
            range: DensityRange::of(0.0),
            block: *density.blocks().bounds(),
            density: 0.0,
        })
    }

    /// Advances to the block, or gap, that begins at distance `t`.
    pub fn advance(&mut self, t: f64, density: &Density) {
        let blocks = density.blocks();
        match self.next_visit.take().or_else(|| self.walk.next()) {
            Some(visit) if visit.span.near > t => {
                self.range = DensityRange::of(0.0);
                self.end = visit.span.near;
                self.next_visit = Some(visit);
            }
            Some(visit) => {
                self.range = blocks.range_in(visit.cell);
                self.block = blocks.cell_bounds(visit.cell);
                self.end = visit.span.far;
            }
            None => {
                self.range = DensityRange::of(0.0);
                self.end = f64::INFINITY;
            }
        }
    }

    /// Looks up `density` at distance `t`, which lies in the present block; a block of density 0
    /// needs no lookup. Adds to `lookups`.
    pub(crate) fn look_up(&mut self, t: f64, density: &Density, lookups: &mut u64) -> f64 {
        self.density = if self.range.high == 0.0 {
            0.0
        } else {
            *lookups += 1;
            // Roundings must not move a point to the next block, whose majorant is another.
            let point = self.line.at(t).clamp(self.block.min, self.block.max);
            density.field().density(point)
        };
        self.density
    }
}

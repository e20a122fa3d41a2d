//! Densities of heterogeneous media.

use super::profiles::{ExponentialProfile, GaussianProfile, LinearProfile};
use crate::geometry::{Aabb, Line, Ray, Span, Transform, forward};
use crate::volume::{
    Blob, Blocks, DensityField, DensityRange, ExponentialLayer, FractalDensity, GridDensity,
    LinearRamp, Walk,
};
use glam::DVec3;
use std::sync::OnceLock;

/// A density, as a factor on the coefficients and the emission of a medium.
#[derive(Clone, Debug)]
pub enum Field {
    /// The density of a grid.
    Grid(GridDensity),
    /// Noise at many scales.
    Noise(FractalDensity),
    /// An exponential layer.
    Exponential(ExponentialLayer),
    /// A linear ramp.
    Linear(LinearRamp),
    /// A Gaussian ball.
    Blob(Blob),
}

impl DensityField for Field {
    forward! { (Field: Grid | Noise | Exponential | Linear | Blob)
        fn density(point: DVec3) -> f64;
        fn range_over(bounds: &Aabb) -> DensityRange;
    }
}

/// A density function placed in the box of a medium.
#[derive(Clone, Debug)]
pub struct Density {
    field: Field,
    /// Where it is, in its own coordinates: the box of a grid, or that of its medium.
    bounds: Aabb,
    /// The box of its medium, in the coordinates of the field.
    medium: Aabb,
    /// The map from the coordinates of the field to the world; `None` if they are the same.
    to_world: Option<Transform>,
    range: DensityRange,
    constant: Option<f64>,
    /// Bounds by block, computed on first use: only tracking needs them.
    blocks: OnceLock<Blocks>,
}

/// Blocks along the longest side of a field that is not a grid.
const BLOCKS: f64 = 32.0;

impl Density {
    /// `field` in the box `bounds`, in the coordinates of the field, moved by `to_world`. The box
    /// is finite and not flat. A grid does not extend beyond its own box.
    pub fn new(field: Field, bounds: Aabb, to_world: Option<Transform>) -> Density {
        let medium = bounds;
        let bounds = match &field {
            Field::Grid(grid) => grid.bounds(),
            _ => medium,
        };
        let mut density = Density {
            range: DensityRange::of(0.0),
            field,
            bounds,
            medium,
            to_world,
            constant: None,
            blocks: OnceLock::new(),
        };
        density.range = match &density.field {
            // Over all of its box its bounds are wide; it is tracked wherever it is.
            Field::Noise(_) => density.blocks().range(),
            field => field.range_over(&bounds),
        };
        // Beyond the box of a grid there is nothing.
        let fills = bounds.min.cmple(medium.min).all() && bounds.max.cmpge(medium.max).all();
        let DensityRange { low, high } = density.range;
        density.constant = (low == high && (fills || high == 0.0)).then_some(high);
        density
    }

    /// The same with another function.
    pub fn with_field(&self, field: Field) -> Density {
        Density::new(field, self.medium, self.to_world)
    }

    /// The field itself.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// Where it is, in its own coordinates: the box of a grid, or that of its medium.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Bounds on the density over its whole box.
    pub fn range(&self) -> DensityRange {
        self.range
    }

    /// The one density of the whole medium, if it is provably the same everywhere.
    pub fn constant(&self) -> Option<f64> {
        self.constant
    }

    /// Whether the density is 0 everywhere.
    pub fn is_nothing(&self) -> bool {
        self.range.high == 0.0
    }

    /// Bounds on the density by block, for tracking.
    pub fn blocks(&self) -> &Blocks {
        if let Some(blocks) = self.blocks.get() {
            return blocks;
        }
        // Not by `get_or_init`: blocks are made by all threads together, and one that waits for
        // the others may be given work that waits for these blocks.
        let blocks = self.made_blocks();
        self.blocks.get_or_init(|| blocks)
    }

    fn made_blocks(&self) -> Blocks {
        if let Field::Grid(grid) = &self.field {
            return grid.blocks();
        }
        let size = self.bounds.size();
        let edge = size.max_element() / BLOCKS;
        // One more than wanted at most, by rounding.
        let counts = (size / edge)
            .ceil()
            .clamp(DVec3::ONE, DVec3::splat(BLOCKS + 1.0));
        let whole = counts.to_array().map(|count| count as usize);
        Blocks::of(&self.field, self.bounds, whole, size / counts)
    }

    /// A single number in place of the density: above 0 if any density is.
    pub(crate) fn typical(&self) -> f64 {
        self.blocks().typical()
    }

    /// Density at a world point: 0 outside the box of a grid; for other fields the point must lie
    /// in their box. Adds 1 to `lookups`, unless the density is known to be 0.
    pub fn at(&self, point: DVec3, lookups: &mut u64) -> f64 {
        match self.inside(point) {
            Some(point) if self.blocks().range_at(point).high > 0.0 => {
                *lookups += 1;
                self.field.density(point)
            }
            _ => 0.0,
        }
    }

    /// The same without a look at the blocks, which need not have been made.
    pub(crate) fn looked_up_at(&self, point: DVec3, lookups: &mut u64) -> f64 {
        let Some(point) = self.inside(point) else {
            return 0.0;
        };
        *lookups += 1;
        self.field.density(point)
    }

    /// A world point in the coordinates of the field; none beyond the box of a grid.
    fn inside(&self, point: DVec3) -> Option<DVec3> {
        let point = match &self.to_world {
            Some(to_world) => to_world.inverse().point(point),
            None => point,
        };
        let outside = point.cmplt(self.bounds.min) | point.cmpgt(self.bounds.max);
        let beyond = matches!(self.field, Field::Grid(_)) && outside.any();
        (!beyond).then_some(point)
    }

    /// A world ray in the coordinates of the field, and the part of `span`, a segment of the ray,
    /// in the box of the field; `None` if there is none.
    pub fn along(&self, ray: &Ray, span: Span) -> Option<(Line, Span)> {
        let (ray, scale) = match &self.to_world {
            Some(to_world) => to_world.ray_to_object(ray)?,
            None => (*ray, 1.0),
        };
        let inside = self.bounds.span(&ray)?;
        let line = Line {
            origin: ray.origin,
            direction: ray.direction * scale,
        };
        let span = span.within(Span::new(inside.near / scale, inside.far / scale));
        (span.near < span.far).then_some((line, span))
    }

    /// The blocks that `line` passes over `span`, which is in the box.
    pub fn walk(&self, line: &Line, span: Span) -> Walk {
        self.blocks().walk(line, span)
    }

    /// Has an integral along lines: [`Density::integral`].
    pub fn is_integrable(&self) -> bool {
        !matches!(self.field, Field::Noise(_))
    }

    /// `∫ density dt` along `line` over `span`, in the box of the field, without discretisation
    /// error: in closed form, or cell by cell. Adds the number of lookups to `lookups`.
    ///
    /// # Panics
    ///
    /// If the field is not [integrable](Density::is_integrable).
    pub fn integral(&self, line: &Line, span: Span, lookups: &mut u64) -> f64 {
        match &self.field {
            Field::Noise(_) => panic!("noise has no integral"),
            // From the denser end on: downwards the density may grow out of nothing to all there is.
            Field::Exponential(layer) => {
                let mut from = line.starting_at(span.near);
                if ExponentialProfile::along(&from, layer).rate < 0.0 {
                    from = Line {
                        origin: line.at(span.far),
                        direction: -line.direction,
                    };
                }
                let profile = ExponentialProfile::along(&from, layer);
                profile.optical_depth(0.0, span.length())
            }
            Field::Linear(ramp) => {
                let profile = LinearProfile::along(&line.starting_at(span.near), ramp);
                let positive = profile.positive_part(0.0, span.length());
                positive.map_or(0.0, |(near, far)| profile.optical_depth(near, far))
            }
            Field::Grid(grid) => grid.integral(*line, span, lookups),
            Field::Blob(blob) => {
                let (centre, width) = blob_along(blob, line);
                let profile = GaussianProfile {
                    peak: blob.density(line.at(centre)),
                    centre,
                    width,
                };
                profile.optical_depth(span.near, span.far)
            }
        }
    }

    /// Appends the points on `line`, over `span`, between which a rule of few points sees all of
    /// the density: at its kinks, and where it falls almost to 0.
    pub(crate) fn append_kinks(&self, line: &Line, span: Span, kinks: &mut Vec<f64>) {
        match &self.field {
            Field::Grid(grid) => {
                let pieces = grid.smooth_segments(*line, span);
                kinks.extend(pieces.map(|piece| piece.far));
            }
            Field::Linear(ramp) => {
                let profile = LinearProfile::along(&line.starting_at(span.near), ramp);
                if let Some((near, far)) = profile.positive_part(0.0, span.length()) {
                    kinks.extend([span.near + near, span.near + far]);
                }
            }
            Field::Blob(blob) => {
                let (centre, width) = blob_along(blob, line);
                let cuts = [-38.0, -6.0, -2.0, 0.0, 2.0, 6.0, 38.0];
                kinks.extend(cuts.map(|widths| centre + widths * width));
            }
            Field::Exponential(layer) => {
                let rate = ExponentialProfile::along(&line.starting_at(span.near), layer).rate;
                let cuts = [1.0, 8.0, 64.0, 745.0].map(|heights| heights / rate.abs());
                // From the denser end on.
                kinks.extend(cuts.map(|distance| {
                    if rate < 0.0 {
                        span.far - distance
                    } else {
                        span.near + distance
                    }
                }));
            }
            Field::Noise(_) => {}
        }
    }
}

/// The point of a line nearest to the centre of a blob, and the width of the blob along it, in
/// world distances.
fn blob_along(blob: &Blob, line: &Line) -> (f64, f64) {
    let squared = line.direction.length_squared();
    let foot = (blob.centre - line.origin).dot(line.direction) / squared;
    (foot, blob.width / squared.sqrt())
}

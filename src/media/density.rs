//! How much of a medium is where.

use super::profiles::{ExponentialProfile, GaussianProfile, LinearProfile};
use crate::geometry::{Aabb, Ray, Span, Transform};
use crate::volume::{
    Blob, Blocks, ConstantDensity, DensityField, DensityRange, ExponentialLayer, FractalDensity,
    GridDensity, LinearRamp, Walk,
};
use glam::DVec3;

/// A density, as a factor on the coefficients and the emission of a medium.
#[derive(Clone, Debug)]
pub enum Field {
    /// The same everywhere.
    Constant(ConstantDensity),
    /// That of a grid.
    Grid(GridDensity),
    /// Noise at many scales.
    Noise(FractalDensity),
    /// A layer that thins with height.
    Exponential(ExponentialLayer),
    /// A linear ramp.
    Linear(LinearRamp),
    /// A ball without an edge.
    Blob(Blob),
}

/// Calls the same method on whatever field it is.
macro_rules! each {
    ($self:expr, $field:ident => $call:expr) => {
        match $self {
            Field::Constant($field) => $call,
            Field::Grid($field) => $call,
            Field::Noise($field) => $call,
            Field::Exponential($field) => $call,
            Field::Linear($field) => $call,
            Field::Blob($field) => $call,
        }
    };
}

impl DensityField for Field {
    fn density(&self, point: DVec3) -> f64 {
        each!(self, field => field.density(point))
    }

    fn range_over(&self, bounds: &Aabb) -> DensityRange {
        each!(self, field => field.range_over(bounds))
    }
}

/// A field in the place where a medium has it, with bounds on it block by block.
#[derive(Clone, Debug)]
pub struct Density {
    field: Field,
    /// From the coordinates of the field to the world; none if they are the same.
    to_world: Option<Transform>,
    blocks: Blocks,
    typical: f64,
}

/// Blocks along the longest side of a field that is no grid.
const BLOCKS: f64 = 32.0;

impl Density {
    /// `field` in the box `bounds`, in the coordinates of the field, moved by `to_world`. A grid
    /// reaches no farther than its own box.
    pub fn new(field: Field, bounds: Aabb, to_world: Option<Transform>) -> Density {
        let blocks = match &field {
            Field::Grid(grid) => grid.blocks(),
            _ => {
                let size = bounds.size();
                let edge = size.max_element() / BLOCKS;
                let counts = (size / edge).ceil().max(DVec3::ONE);
                let counts = counts.to_array().map(|count| count as usize);
                let size =
                    DVec3::from_array(std::array::from_fn(|axis| size[axis] / counts[axis] as f64));
                Blocks::of(&field, bounds, counts, size)
            }
        };
        let typical = blocks.typical();
        Density {
            field,
            to_world,
            blocks,
            typical,
        }
    }

    /// The field itself.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// Bounds on it, block by block.
    pub fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    /// A number that stands in for the density where one has to: above 0 if any density is.
    pub fn typical(&self) -> f64 {
        self.typical
    }

    /// Density at a world point, which is taken to lie in the box of the field. Adds 1 to
    /// `lookups`, unless the block there is known to be empty.
    pub fn at(&self, point: DVec3, lookups: &mut u64) -> f64 {
        let point = match &self.to_world {
            Some(to_world) => to_world.inverse().point(point),
            None => point,
        };
        if self.blocks.range_at(point).high == 0.0 {
            return 0.0;
        }
        *lookups += 1;
        self.field.density(point)
    }

    /// A world ray in the coordinates of the field; `None` if it leaves the range of numbers
    /// there.
    pub fn line(&self, ray: &Ray) -> Option<Line> {
        let Some(to_world) = &self.to_world else {
            return Some(Line {
                origin: ray.origin,
                direction: ray.direction,
            });
        };
        let (ray, scale) = to_world.ray_to_object(ray)?;
        Some(Line {
            origin: ray.origin,
            direction: ray.direction * scale,
        })
    }

    /// Where a world ray is in the box of the field.
    pub fn span(&self, ray: &Ray) -> Option<Span> {
        let (ray, scale) = match &self.to_world {
            Some(to_world) => to_world.ray_to_object(ray)?,
            None => (*ray, 1.0),
        };
        let span = self.blocks.bounds().span(&ray)?;
        Some(Span {
            near: span.near / scale,
            far: span.far / scale,
        })
    }

    /// The blocks that `line` passes on the stretch `span`, which is in the box.
    pub fn walk(&self, line: &Line, span: Span) -> Walk {
        self.blocks.walk(line.origin, line.direction, span)
    }

    /// Whether [`Density::integral`] knows.
    pub fn is_integrable(&self) -> bool {
        !matches!(self.field, Field::Noise(_))
    }

    /// `∫ density dt` along `line` over `span`, in the box of the field, without discretisation
    /// error: in closed form, or cell by cell. Adds the number of look-ups to `lookups`.
    ///
    /// # Panics
    ///
    /// If the field is not [integrable](Density::is_integrable).
    pub fn integral(&self, line: &Line, span: Span, lookups: &mut u64) -> f64 {
        let Line { origin, direction } = *line;
        match &self.field {
            Field::Constant(density) => {
                super::optical_depth(density.density(origin), span.length())
            }
            Field::Noise(_) => panic!("noise has no integral"),
            // From where the stretch begins: far outside, a layer may be beyond all numbers.
            Field::Exponential(layer) => {
                let from = self.from(line, span.near);
                let profile = ExponentialProfile::along(&from, layer, 1.0);
                profile.optical_depth(0.0, span.length())
            }
            Field::Linear(ramp) => {
                let profile = LinearProfile::along(&self.from(line, span.near), ramp, 1.0);
                let positive = profile.positive_part(0.0, span.length());
                positive.map_or(0.0, |(near, far)| profile.optical_depth(near, far))
            }
            Field::Grid(grid) => grid.integral(origin, direction, span, lookups),
            Field::Blob(blob) => {
                let squared = direction.length_squared();
                let foot = (blob.centre - origin).dot(direction) / squared;
                let profile = GaussianProfile {
                    peak: blob.density(origin + direction * foot),
                    centre: foot,
                    width: blob.width / squared.sqrt(),
                };
                profile.optical_depth(span.near, span.far)
            }
        }
    }

    /// Appends the places on `line`, over `span`, where the density is not smooth.
    pub fn append_kinks(&self, line: &Line, span: Span, kinks: &mut Vec<f64>) {
        match &self.field {
            Field::Grid(grid) => {
                let pieces = grid.smooth_stretches(line.origin, line.direction, span);
                kinks.extend(pieces.map(|piece| piece.far));
            }
            Field::Linear(ramp) => {
                let profile = LinearProfile::along(&self.from(line, span.near), ramp, 1.0);
                if let Some((near, far)) = profile.positive_part(0.0, span.length()) {
                    kinks.extend([span.near + near, span.near + far]);
                }
            }
            _ => {}
        }
    }

    /// `line` from distance `t` on, as profiles want it: its direction has any length, and
    /// distances along it remain world distances.
    fn from(&self, line: &Line, t: f64) -> Ray {
        Ray {
            origin: line.at(t),
            direction: line.direction,
        }
    }
}

/// A straight line in the coordinates of a field, parametrised by world distance: `direction` is
/// as long as a world unit is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Where it begins.
    pub origin: DVec3,
    /// How far it goes for a world unit.
    pub direction: DVec3,
}

impl Line {
    /// The point at world distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

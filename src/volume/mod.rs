//! Fields in space. Sampled on a lattice: reading, splatting, storage, interpolation, gradients.
//! As formulas: noise and layers, with bounds over boxes.

mod course_grid;
mod field;
mod file;
mod fractal;
mod gradient;
mod grid;
mod interpolation;
mod lattice;
mod layers;
mod noise_range;
mod obj_points;
mod perlin;
mod splat;

pub use course_grid::{CourseGridError, read_course_grid, write_course_grid};
pub use field::{DensityField, DensityRange};
pub use file::{VolumeError, VolumeFormat, load, load_hashed};
pub use fractal::{FractalDensity, FractalError, FractalParameters, MOST_OCTAVES};
pub use gradient::{gradients, relative_gradients};
pub use grid::{Grid, GridError};
pub use interpolation::{Cell, Lerp, Nearest, Node, Reconstruction, Scalar, Trilinear};
pub use lattice::{Centring, Lattice, LatticeError};
pub use layers::{ConstantDensity, ExponentialLayer, LayerError, LinearRamp};
pub use noise_range::NOISE_BOUND;
pub use obj_points::{ObjError, ObjFault, Point, read_obj_points};
pub use perlin::perlin_noise;
pub use splat::{SplatError, Splatting, splat, splat_weights};

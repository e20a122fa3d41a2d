//! Fields sampled on a lattice: reading, splatting, storage, interpolation, gradients.

mod course_grid;
mod field;
mod file;
mod gradient;
mod grid;
mod interpolation;
mod lattice;
mod obj_points;
mod splat;

pub use course_grid::{CourseGridError, read_course_grid, write_course_grid};
pub use field::{DensityField, DensityRange};
pub use file::{VolumeError, VolumeFormat, load, load_hashed};
pub use gradient::{gradients, relative_gradients};
pub use grid::{Grid, GridError};
pub use interpolation::{Cell, Lerp, Nearest, Node, Reconstruction, Scalar, Trilinear};
pub use lattice::{Centring, Lattice, LatticeError};
pub use obj_points::{ObjError, ObjFault, Point, read_obj_points};
pub use splat::{SplatError, Splatting, splat, splat_weights};

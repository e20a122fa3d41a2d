//! Fields sampled on a lattice: reading, splatting, storage, interpolation, gradients.

mod blob;
mod blocks;
mod course_grid;
mod field;
mod file;
mod gradient;
mod grid;
mod grid_density;
mod interpolation;
mod lattice;
mod obj_points;
mod splat;
mod walk;

pub use blob::Blob;
pub use blocks::Blocks;
pub use course_grid::{CourseGridError, read_course_grid, write_course_grid};
pub use field::{DensityField, DensityRange};
pub use file::{VolumeError, VolumeFormat, load, load_hashed};
pub use gradient::{gradients, relative_gradients};
pub use grid::{Grid, GridError};
pub use grid_density::GridDensity;
pub use interpolation::{
    Cell, Interpolation, Lerp, Nearest, Node, Reconstruction, Scalar, Trilinear,
};
pub use lattice::{Centring, Lattice, LatticeError};
pub use obj_points::{ObjError, ObjFault, Point, read_obj_points};
pub use splat::{SplatError, Splatting, splat, splat_weights};
pub use walk::{Visit, Walk};

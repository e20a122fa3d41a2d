//! Fields in space. Sampled on a lattice: reading, splatting, storage, interpolation, gradients.
//! As formulas: noise and layers, with bounds over boxes.

mod blob;
mod blocks;
mod course_grid;
mod field;
mod file;
mod fractal;
mod gradient;
mod grid;
mod grid_density;
mod interpolation;
mod lattice;
mod layers;
mod load_options;
mod mitsuba_vol;
mod nifti;
mod noise_range;
mod nrrd;
mod obj_points;
mod orientation;
mod perlin;
mod raw_volume;
mod samples;
mod splat;
mod walk;

pub use blob::Blob;
pub use blocks::Blocks;
pub use course_grid::{CourseGridError, read_course_grid, write_course_grid};
pub use field::{DensityField, DensityRange};
pub use file::{FileRead, Loaded, Stored, VolumeError, VolumeFormat, load, load_hashed};
pub use fractal::{FractalDensity, FractalError, FractalParameters, MOST_OCTAVES};
pub use gradient::{gradients, relative_gradients};
pub use grid::{Grid, GridError};
pub use grid_density::GridDensity;
pub use interpolation::{
    Cell, Interpolation, Lerp, Nearest, Node, Reconstruction, Scalar, Trilinear,
};
pub use lattice::{Centring, Lattice, LatticeError};
pub use layers::{ConstantDensity, ExponentialLayer, LayerError, LinearRamp};
pub use load_options::{LoadOptions, NonFinite};
pub use mitsuba_vol::{VolError, read_vol, write_vol};
pub use nifti::{NiftiError, read_nifti};
pub use noise_range::NOISE_BOUND;
pub use nrrd::{NrrdError, NrrdFault, NrrdHeader, read_nrrd, read_nrrd_header};
pub use obj_points::{ObjError, ObjFault, Point, read_obj_points};
pub use orientation::{Axes, Orientation, OrientationError, Steps};
pub use perlin::perlin_noise;
pub use raw_volume::{RawVolume, RawVolumeError};
pub use samples::{Element, Encoding, Endian, Layout, SamplesError};
pub use splat::{SplatError, Splatting, splat, splat_weights};
pub use walk::{Visit, Walk};

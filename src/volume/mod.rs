//! Fields in space. Sampled on a lattice: reading, splatting, storage, interpolation, gradients.
//! As formulas: noise and layers, with bounds over boxes.

mod blob;
mod blocks;
mod course_grid;
mod cubic;
mod error;
mod field;
mod file;
mod format;
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
mod node_line;
mod noise_range;
mod nrrd;
mod obj_points;
mod orientation;
mod parameter;
mod perlin;
mod point_cloud;
mod raw_volume;
mod samples;
mod source;
mod splat;
mod trilinear_batch;
mod walk;

pub use blob::Blob;
pub use blocks::Blocks;
pub use course_grid::{read_course_grid, write_course_grid};
pub use cubic::CubicSegment;
pub use error::{VolumeError, VolumeFault};
pub use field::{DensityField, DensityRange};
pub use file::{Loaded, load, load_hashed, volume_format, volume_formats};
pub use format::{Stored, VolumeFormat};
pub use fractal::{FractalDensity, FractalParameters, MOST_OCTAVES};
pub use gradient::{gradients, relative_gradients};
pub use grid::{Grid, GridError};
pub use grid_density::GridDensity;
pub use interpolation::{
    Cell, Interpolation, Lerp, Nearest, Node, Reconstruction, Scalar, Trilinear,
};
pub use lattice::{Centring, Lattice, LatticeError, NodePoint};
pub use layers::{ConstantDensity, ExponentialLayer, LinearRamp};
pub use load_options::{LoadOptions, NonFinite};
pub use mitsuba_vol::{read_vol, vol_bytes, write_vol};
pub use nifti::read_nifti;
pub use node_line::NodeLine;
pub use noise_range::NOISE_BOUND;
pub use nrrd::{NrrdHeader, read_nrrd, read_nrrd_header};
pub use obj_points::{CloudPoint, read_obj_points};
pub use orientation::{Axes, AxisSteps, Orientation};
pub use parameter::{InvalidParameter, require};
pub use perlin::perlin_noise;
pub use raw_volume::RawVolume;
pub use samples::{Element, Encoding, Endian, Layout};
pub use source::FileRead;
pub use splat::{Splatting, splat, splat_weights};
pub use trilinear_batch::{Cells, NodePoints};
pub use walk::{Visit, Walk};

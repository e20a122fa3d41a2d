//! Fields in space. Sampled on a lattice: reading, splatting, storage, interpolation, gradients.
//! As formulas: noise and layers, with bounds over boxes.

mod blob;
mod blocks;
mod course_grid;
mod error;
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
mod node_line;
mod noise_range;
mod nrrd;
mod obj_points;
mod orientation;
mod perlin;
mod point_cloud;
mod raw_volume;
mod reader;
mod samples;
mod source;
mod splat;
mod walk;

pub use blob::Blob;
pub use blocks::Blocks;
pub use course_grid::{CourseGrid, CourseGridError, read_course_grid, write_course_grid};
pub use error::VolumeError;
pub use field::{DensityField, DensityRange};
pub use file::{Loaded, load, load_hashed, volume_formats, volume_reader};
pub use fractal::{FractalDensity, FractalError, FractalParameters, MOST_OCTAVES};
pub use gradient::{gradients, relative_gradients};
pub use grid::{Grid, GridError};
pub use grid_density::GridDensity;
pub use interpolation::{
    Cell, Interpolation, Lerp, Nearest, Node, Reconstruction, Scalar, Trilinear,
};
pub use lattice::{Centring, Lattice, LatticeError, NodePoint};
pub use layers::{ConstantDensity, ExponentialLayer, LayerError, LinearRamp};
pub use load_options::{LoadOptions, NonFinite};
pub use mitsuba_vol::{MitsubaVol, VolError, read_vol, write_vol};
pub use nifti::{Nifti, NiftiError, read_nifti};
pub use node_line::NodeLine;
pub use noise_range::NOISE_BOUND;
pub use nrrd::{Nrrd, NrrdError, NrrdFault, NrrdHeader, read_nrrd, read_nrrd_header};
pub use obj_points::{CloudPoint, ObjError, ObjFault, read_obj_points};
pub use orientation::{Axes, AxisSteps, Orientation, OrientationError};
pub use perlin::perlin_noise;
pub use point_cloud::PointCloud;
pub use raw_volume::{BareSamples, RawVolume, RawVolumeError};
pub use reader::{Stored, VolumeReader};
pub use samples::{Element, Encoding, Endian, Layout, SamplesError};
pub use source::{FileRead, VolumeSource};
pub use splat::{SplatError, Splatting, splat, splat_weights};
pub use walk::{Visit, Walk};

/// Every format that is read.
pub const VOLUME_READERS: [&dyn VolumeReader; 6] = [
    &PointCloud,
    &CourseGrid,
    &MitsubaVol,
    &Nrrd,
    &Nifti,
    &BareSamples,
];

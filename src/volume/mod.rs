//! Fields sampled on a lattice: storage, interpolation, gradients.

mod gradient;
mod grid;
mod interpolation;
mod lattice;

pub use gradient::gradients;
pub use grid::{Grid, GridError};
pub use interpolation::{Cell, Lerp, Node, Scalar};
pub use lattice::{Lattice, LatticeError};

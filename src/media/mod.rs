//! Optical properties of volumes: media, phase functions, transfer functions.

mod coefficients;
pub mod collocation;
mod colormap;
mod deflection;
mod density;
mod density_line;
mod draine;
mod droplets;
pub mod emission;
pub mod estimators;
mod henyey_greenstein;
mod homogeneous;
mod opacity;
mod optical_depth;
mod phase;
mod phong;
pub mod profiles;
mod transfer_function;
mod transfer_points;

pub use coefficients::{Coefficients, collision_weight, escape_weight, sampled_channel};
pub use colormap::Colormap;
pub use deflection::{Asymmetry, Deflection};
pub use density::{Density, Field};
pub use density_line::DensityLine;
pub use draine::Draine;
pub use droplets::Droplets;
pub use henyey_greenstein::HenyeyGreenstein;
pub use homogeneous::Homogeneous;
pub use opacity::{TransferOpacity, over_length, over_lengths};
pub use optical_depth::{opacity, optical_depth, source_factor, transmittance};
pub use phase::Phase;
pub use phong::Phong;
pub use transfer_function::{Appearance, TransferFunction};
pub use transfer_points::{TransferPoint, TransferPoints, TransferPointsError};

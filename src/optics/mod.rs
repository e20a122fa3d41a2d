//! Optical properties of media and surfaces, and lights.
//!
//! | files | hold |
//! |---|---|
//! | `coefficients`, `homogeneous`, [`emission`], `optical_depth`, `opacity` | absorption, scattering and emission, and what they amount to over a length |
//! | `density`, [`profiles`] | the density of a heterogeneous medium, at a point and along a ray |
//! | `phase`, `henyey_greenstein`, `draine`, `droplets`, `deflection` | phase functions |
//! | `transfer_function`, `transfer_points`, `colormap`, `phong`, `layer` | the appearance of classified volumes, and samples composited |
//! | `material`, `fresnel` | scattering at surfaces |
//! | `light` | light sources without extent |
//! | [`collocation`] | light along a ray by quadrature |

mod coefficients;
pub mod collocation;
mod colormap;
mod deflection;
mod density;
mod draine;
mod droplets;
pub mod emission;
mod fresnel;
mod henyey_greenstein;
mod homogeneous;
mod layer;
mod light;
mod material;
mod opacity;
mod optical_depth;
mod phase;
mod phong;
pub mod profiles;
mod transfer_function;
mod transfer_points;

pub use coefficients::{Coefficients, collision_weight, escape_weight};
pub(crate) use coefficients::{albedo, sampled_channel};
pub use colormap::Colormap;
pub use deflection::{Asymmetry, Deflection};
pub use density::{Density, Field};
pub use draine::Draine;
pub use droplets::Droplets;
pub use fresnel::{Split, reflected, split};
pub use henyey_greenstein::HenyeyGreenstein;
pub use homogeneous::Homogeneous;
pub use layer::Layer;
pub use light::{Directional, Light, Point, Spot};
pub use material::{Material, Sides};
pub(crate) use opacity::over_lengths;
pub use opacity::{TransferOpacity, over_length};
pub use optical_depth::{opacity, optical_depth, source_factor, transmittance};
pub use phase::Phase;
pub use phong::Phong;
pub use transfer_function::{Appearance, TransferFunction};
pub use transfer_points::{TransferPoint, TransferPoints, TransferPointsError};

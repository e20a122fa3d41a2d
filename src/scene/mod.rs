//! Text to a valid [`Scene`]; nothing invalid leaves this room.

mod classified;
mod curve;
mod error;
pub mod format;
mod load;
mod radiative;
pub mod reader;

pub use classified::{Classified, Compositing, Interpolation, Shadow, VolumeSource};
pub use curve::Curve;
pub use error::SceneError;
pub use load::{Model, Panel, SCENE, Scene};
pub use radiative::{AreaLight, Body, Object, Radiative, Scattering};
pub use reader::{Length, Origin, Reading};

//! From text to a valid [`Scene`].

#[macro_use]
mod record;
mod camera;
mod classified;
mod clip;
mod conventions;
mod curve;
mod error;
mod files;
pub mod format;
mod key_lines;
mod length;
mod load;
mod mode;
mod modulation;
mod node_formula;
mod objects;
mod placement;
mod procedural_xml;
mod radiative;
pub mod reader;
mod recipe;
mod requested_sampling;
mod sampling;
mod several;
mod shadow;
mod transfer_function;
mod transport_fault;
mod volume;

pub use classified::{Classified, Compositing};
pub use clip::{Clip, Kept};
pub use conventions::{
    ALTERNATIVES, Alternative, CONVENTIONS, Conventions, Fault, FittedSteps, Gradient, LastStep,
    LightColour, NormalSpace, Precision, StepLength, StoredValues,
};
pub use curve::Curve;
pub use error::SceneError;
pub(crate) use error::{SceneResult, shortened};
pub use files::InputFile;
pub use key_lines::KeyLines;
pub use length::Length;
pub use load::{Model, Panel, SCENE, Scene};
pub use mode::{
    Isosurface, IsosurfaceFault, Isosurfaces, Mode, Projected, Projection, ProjectionFault, Window,
};
pub use modulation::Modulation;
pub use objects::{Objects, OpaqueSurface, Volume};
pub use procedural_xml::{ProceduralMedium, read_procedural};
pub use radiative::{AreaLight, Body, Object, Radiative, Scattering};
pub use reader::{Origin, Reading};
pub use recipe::Recipe;
pub use requested_sampling::{Sampling, Seed};
pub use sampling::samples;
pub use shadow::Shadow;
pub use transport_fault::TransportFault;

//! From text to a valid [`Scene`].

mod camera;
mod classified;
mod conventions;
mod curve;
mod error;
mod excerpt;
mod files;
pub mod format;
mod key_lines;
mod length;
mod load;
mod node_formula;
mod placement;
mod procedural_xml;
mod radiative;
pub mod reader;
mod requested_sampling;
mod sampling;
mod transfer_function;
mod transport_fault;
mod volume;

pub use classified::{Classified, Compositing, Shadow};
pub use conventions::{
    ALTERNATIVES, Alternative, CONVENTIONS, Conventions, FittedSteps, Gradient, LastStep,
    LightColour, Precision, StepLength, StoredValues,
};
pub use curve::Curve;
pub use error::{SceneError, SceneResult};
pub use excerpt::shortened;
pub use files::InputFile;
pub use key_lines::KeyLines;
pub use length::Length;
pub use load::{Model, Panel, SCENE, Scene};
pub use procedural_xml::{ProceduralMedium, read_procedural};
pub use radiative::{AreaLight, Body, Object, Radiative, Scattering};
pub use reader::{Origin, Reading};
pub use requested_sampling::{Sampling, Seed};
pub use sampling::samples;
pub use transport_fault::TransportFault;

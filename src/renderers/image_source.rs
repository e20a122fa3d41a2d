//! Source of the images that are judged: a folder of finished ones, or a renderer.

use super::{OtherRenderer, Rendered};
use crate::suite::{Case, Outputs};

/// Source of images.
pub enum ImageSource {
    /// A folder of finished images.
    Finished(Outputs),
    /// A renderer to run.
    Renderer(Box<OtherRenderer>),
}

impl ImageSource {
    /// False if there is no image of `case`: a renderer has to be run to know.
    pub fn may_have(&self, case: &Case) -> bool {
        let has_none = |outputs: &Outputs| matches!(outputs.find(&case.name), Ok(None));
        !matches!(self, ImageSource::Finished(outputs) if has_none(outputs))
    }

    /// The output for `case`, and its origin.
    pub fn output(&self, case: &Case) -> Rendered {
        match self {
            ImageSource::Finished(outputs) => Rendered::of(outputs.output(&case.name)),
            ImageSource::Renderer(renderer) => renderer.output(case, renderer.options.first),
        }
    }

    /// The renderer, if one is run.
    pub fn renderer(&self) -> Option<&OtherRenderer> {
        match self {
            ImageSource::Finished(_) => None,
            ImageSource::Renderer(renderer) => Some(renderer),
        }
    }
}

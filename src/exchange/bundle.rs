//! Classified volumes as plain numbers.

use super::{Export, Format, Refusal};
use crate::scene::Scene;

/// The numbers and formulas of a classified scene or a curve.
pub fn bundle(_scene: &Scene, _name: &str) -> Result<Export, Refusal> {
    let what = "a bundle holds classified volumes and curves only";
    Err(Refusal::of(Format::Bundle, "radiative", what))
}

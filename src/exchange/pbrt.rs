//! pbrt-v4.
use super::{Export, Format, Refusal};
use crate::scene::{Panel, Radiative};
pub(super) fn scene(_: &Panel, _: &Radiative, _: &str) -> Result<Export, Refusal> {
    Err(Refusal::of(Format::Pbrt, "x", "y"))
}

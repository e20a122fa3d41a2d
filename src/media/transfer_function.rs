//! The classifier: what a density looks like.

use super::{Colormap, TransferOpacity, over_length};
use glam::DVec3;

/// Maps a density to opacity and colour.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    /// Opacity over the reference length.
    pub opacity: TransferOpacity,
    /// Path length `h0` over which [`TransferFunction::opacity`] is stated, world units, > 0.
    pub reference_length: f64,
    /// Colour by density.
    pub colormap: Colormap,
}

impl TransferFunction {
    /// Opacity over a step of `length` world units at `density`: `1 − T(d)^(length/h0)`.
    pub fn opacity(&self, density: f64, length: f64) -> f64 {
        over_length(self.opacity.at(density), length / self.reference_length)
    }

    /// Colour of the material: `colormap(d)`.
    pub fn colour(&self, density: f64) -> DVec3 {
        self.colormap.at(density)
    }

    /// How much light a sample sends out, whatever its colour and shading: `d²`.
    pub fn strength(&self, density: f64) -> f64 {
        density * density
    }

    /// Whether every density up to `density` has an opacity of exactly 0.
    /// Opacity rises with density, so the largest decides.
    pub fn is_transparent_up_to(&self, density: f64) -> bool {
        self.opacity.at(density) == 0.0
    }
}

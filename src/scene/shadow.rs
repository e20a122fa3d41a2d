//! The volume shadow.

/// Volume shadow: the radiance of a sample is multiplied by `min(1, exp(−S/100))`, `S` the
/// integral of density towards the light, counted in units of `reference_step`. With a table of
/// points it is the transmittance of the opacities on the way, each stated over `reference_step`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// Distance between samples along the shadow ray, world units, > 0.
    pub step: f64,
    /// Length that counts as one unit of `S`, or over which opacities hold, world units, > 0.
    pub reference_step: f64,
}

//! The code that renders an image, by the parts it is compiled for.

use crate::scene::Compositing;
use std::fmt;

/// The code that renders an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kernel {
    /// A plot; no light is simulated.
    Curve,
    /// Nothing lies before the background.
    Background,
    /// The ray caster, compiled for these parts.
    RayCaster {
        /// Reconstruction of the density.
        field: FieldKind,
        /// Order of compositing.
        compositing: Compositing,
        /// Phong shading.
        shading: bool,
        /// Volume shadow.
        shadow: bool,
        /// Leaps over regions known to be transparent.
        skip_empty: bool,
    },
    /// Closed forms and integrals along the line of sight, without random numbers.
    LineOfSight {
        /// What it is compiled for.
        parts: Parts,
        /// Whether light is turned, once.
        turned: bool,
    },
    /// Path tracing.
    PathTracer {
        /// What it is compiled for.
        parts: Parts,
        /// How often light is turned at most, if there is a limit.
        limit: Option<u32>,
    },
}

/// Parts of the kernels for surfaces and participating media.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// Media.
    pub media: bool,
    /// Media of no matter are asked where they are, like others.
    pub null_media: bool,
    /// Surfaces.
    pub surfaces: bool,
    /// Light that media send out.
    pub emission: bool,
    /// Coefficients that differ between channels.
    pub chromatic: bool,
    /// Phase functions that prefer a direction.
    pub anisotropic: bool,
    /// Media whose density differs from place to place.
    pub heterogeneous: bool,
}

/// Part of the [canonical text](super::Plan::canonical_text) by which goldens know the plan they were
/// made by: a part that goldens of old know nothing of shows only where it is on.
impl fmt::Debug for Parts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = f.debug_struct("Parts");
        parts
            .field("media", &self.media)
            .field("null_media", &self.null_media)
            .field("surfaces", &self.surfaces)
            .field("emission", &self.emission)
            .field("chromatic", &self.chromatic)
            .field("anisotropic", &self.anisotropic);
        if self.heterogeneous {
            parts.field("heterogeneous", &true);
        }
        parts.finish()
    }
}

impl fmt::Display for Parts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = [
            (self.surfaces, "surfaces"),
            (self.media, "media"),
            (self.emission, "emission"),
            (self.chromatic, "colour"),
            (self.anisotropic, "anisotropic scattering"),
            (self.heterogeneous, "varying density"),
        ];
        let names: Vec<_> = names
            .iter()
            .filter(|(on, _)| *on)
            .map(|(_, name)| *name)
            .collect();
        f.write_str(if names.is_empty() { "nothing" } else { "" })?;
        f.write_str(&names.join(", "))
    }
}

/// How a kernel comes by densities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// Value of the nearest node.
    Nearest,
    /// Trilinear interpolation.
    Trilinear,
    /// The one density of the whole grid.
    Constant,
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Kernel::RayCaster {
            field,
            compositing,
            shading,
            shadow,
            skip_empty,
        } = self
        else {
            return match self {
                Kernel::Curve => f.write_str("plot of the transfer function"),
                Kernel::LineOfSight {
                    parts,
                    turned: false,
                } => {
                    write!(f, "line of sight: {parts}, light not turned")
                }
                Kernel::LineOfSight {
                    parts,
                    turned: true,
                } => {
                    write!(f, "line of sight: {parts}, light turned once")
                }
                Kernel::PathTracer {
                    parts,
                    limit: Some(0),
                } => {
                    write!(f, "path tracer: {parts}, light not turned")
                }
                Kernel::PathTracer { parts, limit: None } => {
                    write!(f, "path tracer: {parts}, any number of turns")
                }
                Kernel::PathTracer {
                    parts,
                    limit: Some(limit),
                } => {
                    write!(f, "path tracer: {parts}, up to {limit} turns")
                }
                _ => f.write_str("background only"),
            };
        };
        let field = match field {
            FieldKind::Nearest => "nearest",
            FieldKind::Trilinear => "trilinear",
            FieldKind::Constant => "constant density",
        };
        let order = match compositing {
            Compositing::FrontToBack => "front to back".to_owned(),
            Compositing::EarlyTermination(below) => format!("front to back down to {below}"),
            Compositing::BackToFront => "back to front".to_owned(),
        };
        write!(f, "ray caster: {field}, {order}")?;
        f.write_str(if *shading { ", Phong" } else { ", unshaded" })?;
        f.write_str(if *shadow {
            ", volume shadow"
        } else {
            ", no shadow"
        })?;
        f.write_str(if *skip_empty {
            ", leaps over empty space"
        } else {
            ", every sample"
        })
    }
}

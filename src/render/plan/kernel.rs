//! The code that renders an image, by what it is compiled for.

use crate::scene::{Classified, Compositing, Curve, Radiative};
use std::fmt;

/// The code that renders an image, and the model that it renders.
#[derive(Clone, Copy, Debug)]
pub enum Kernel<'s> {
    /// A plot; no light is simulated.
    Curve(&'s Curve),
    /// Nothing lies before the background.
    Background(&'s Classified),
    /// The ray caster.
    RayCaster {
        /// What is rendered.
        scene: &'s Classified,
        /// What it is compiled for.
        features: RayCasterFeatures,
    },
    /// Closed forms and integrals along the line of sight, without random numbers.
    LineOfSight {
        /// What is rendered.
        scene: &'s Radiative,
        /// What it is compiled for.
        parts: Parts,
        /// Whether light is turned, once.
        turned: bool,
    },
    /// Path tracing.
    PathTracer {
        /// What is rendered.
        scene: &'s Radiative,
        /// What it is compiled for.
        parts: Parts,
        /// How often light is turned at most, if there is a limit.
        limit: Option<u32>,
    },
}

/// What the ray caster is compiled for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCasterFeatures {
    /// Reconstruction of the density.
    pub field: FieldKind,
    /// Order of compositing.
    pub compositing: Compositing,
    /// Phong shading.
    pub shading: bool,
    /// Volume shadow.
    pub shadow: bool,
    /// Leaps over regions known to be transparent.
    pub skip_empty: bool,
}

/// Parts of the kernels for surfaces and participating media.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

impl fmt::Display for Kernel<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Kernel::Curve(_) => f.write_str("plot of the transfer function"),
            Kernel::Background(_) => f.write_str("background only"),
            Kernel::RayCaster { features, .. } => write!(f, "ray caster: {features}"),
            Kernel::LineOfSight { parts, turned, .. } => {
                let often = if *turned { "turned once" } else { "not turned" };
                write!(f, "line of sight: {parts}, light {often}")
            }
            Kernel::PathTracer { parts, limit, .. } => {
                write!(f, "path tracer: {parts}, ")?;
                match limit {
                    None => f.write_str("any number of turns"),
                    Some(0) => f.write_str("light not turned"),
                    Some(limit) => write!(f, "up to {limit} turns"),
                }
            }
        }
    }
}

impl fmt::Display for RayCasterFeatures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.field {
            FieldKind::Nearest => "nearest",
            FieldKind::Trilinear => "trilinear",
            FieldKind::Constant => "constant density",
        })?;
        match self.compositing {
            Compositing::FrontToBack => f.write_str(", front to back")?,
            Compositing::EarlyTermination(below) => write!(f, ", front to back down to {below}")?,
            Compositing::BackToFront => f.write_str(", back to front")?,
        }
        let words = [
            if self.shading { "Phong" } else { "unshaded" },
            if self.shadow {
                "volume shadow"
            } else {
                "no shadow"
            },
            if self.skip_empty {
                "leaps over empty space"
            } else {
                "every sample"
            },
        ];
        write!(f, ", {}", words.join(", "))
    }
}

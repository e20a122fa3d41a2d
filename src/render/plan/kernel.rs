//! The code that renders an image, by the features that it meets.

use crate::scene::{Classified, Compositing, Curve, Radiative};
use crate::volume::Interpolation;
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
        /// The model rendered.
        scene: &'s Classified,
        /// What it meets.
        features: RayCasterFeatures,
    },
    /// The ray caster for conventions of other renderers, which leaves nothing out.
    Conventional(&'s Classified),
    /// The ray caster for several volumes, surfaces and clips.
    Several(&'s Classified),
    /// The volume-rendering integral of a classified volume, without samples.
    Integral(&'s Classified),
    /// A projection or isosurfaces of a classified volume: exact along each ray, or sampled.
    Field(&'s Classified),
    /// Closed forms and integrals along the line of sight, without random numbers.
    LineOfSight {
        /// The model rendered.
        scene: &'s Radiative,
        /// What it meets.
        features: RadiativeFeatures,
        /// Whether light is scattered, once.
        scatters: bool,
    },
    /// Path tracing.
    PathTracer {
        /// The model rendered.
        scene: &'s Radiative,
        /// What it meets.
        features: RadiativeFeatures,
        /// Highest scattering order, if there is a limit.
        max_order: Option<u32>,
    },
}

/// Features that the ray caster meets.
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
    /// Empty-space skipping: samples in transparent blocks are not taken.
    pub skip_empty: bool,
    /// A map that places the volume in the world: of the plan alone, for kernels ask for it once a ray.
    pub placed: bool,
}

impl RayCasterFeatures {
    /// The features that `scene` asks for, none left out.
    pub(in crate::render) fn asked_for(scene: &Classified) -> RayCasterFeatures {
        RayCasterFeatures {
            field: match scene.interpolation {
                Interpolation::Nearest => FieldKind::Nearest,
                Interpolation::Trilinear => FieldKind::Trilinear,
            },
            compositing: scene.compositing,
            shading: scene.phong.is_some(),
            shadow: scene.shadow.is_some(),
            skip_empty: false,
            placed: scene.to_world.is_some(),
        }
    }
}

/// What the renderers of surfaces and participating media meet: what is not there, they do not look for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RadiativeFeatures {
    /// Media.
    pub media: bool,
    /// Vacuum media, without extinction and emission, are treated like others.
    pub vacuum_media: bool,
    /// Surfaces.
    pub surfaces: bool,
    /// Emission by media.
    pub emission: bool,
    /// Coefficients that differ between channels.
    pub chromatic: bool,
    /// Anisotropic phase functions.
    pub anisotropic: bool,
    /// Heterogeneous media.
    pub heterogeneous: bool,
}

impl RadiativeFeatures {
    /// Anything, but for vacuum media.
    pub const ALL: RadiativeFeatures = RadiativeFeatures {
        media: true,
        vacuum_media: false,
        surfaces: true,
        emission: true,
        chromatic: true,
        anisotropic: true,
        heterogeneous: true,
    };
}

impl fmt::Display for RadiativeFeatures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = [
            (self.surfaces, "surfaces"),
            (self.media, "media"),
            (self.emission, "emission"),
            (self.chromatic, "colour"),
            (self.anisotropic, "anisotropic phase"),
            (self.heterogeneous, "heterogeneous"),
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

/// Reconstruction of densities.
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
            Kernel::Conventional(scene) => {
                let features = RayCasterFeatures::asked_for(scene);
                write!(f, "ray caster: {features}, other conventions")
            }
            Kernel::Several(scene) => {
                write!(f, "ray caster: {} merged", scene.counted_objects())
            }
            Kernel::Integral(_) => f.write_str("integral along each ray, piece by piece"),
            Kernel::Field(scene) => {
                let mode = scene.mode.name().unwrap_or_default();
                let how = if scene.is_exact() {
                    "exact, cell by cell"
                } else {
                    "sampled"
                };
                write!(f, "{mode} along each ray, {how}")
            }
            Kernel::LineOfSight {
                features, scatters, ..
            } => {
                let scattering = if *scatters {
                    "single scattering"
                } else {
                    "no scattering"
                };
                write!(f, "line of sight: {features}, {scattering}")
            }
            Kernel::PathTracer {
                features,
                max_order,
                ..
            } => {
                write!(f, "path tracer: {features}, ")?;
                match max_order {
                    None => f.write_str("scattering of any order"),
                    Some(0) => f.write_str("no scattering"),
                    Some(1) => f.write_str("single scattering"),
                    Some(order) => write!(f, "scattering up to order {order}"),
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
                "empty-space skipping"
            } else {
                "every sample"
            },
        ];
        write!(f, ", {}", words.join(", "))?;
        f.write_str(if self.placed { ", placed by a map" } else { "" })
    }
}

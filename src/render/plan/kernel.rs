//! The code that renders an image, by the features that it meets.

use crate::scene::{Classified, Curve, Radiative};
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
        /// Features that it meets.
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
        /// Features that it meets.
        features: RadiativeFeatures,
        /// Whether light is scattered, once.
        scatters: bool,
    },
    /// Path tracing.
    PathTracer {
        /// The model rendered.
        scene: &'s Radiative,
        /// Features that it meets.
        features: RadiativeFeatures,
        /// Highest scattering order, if there is a limit.
        max_order: Option<u32>,
    },
}

/// Features that the ray caster meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCasterFeatures {
    /// One density in the whole grid, which is not looked up.
    pub constant: bool,
    /// Samples are shaded by the model of Phong.
    pub shading: bool,
    /// The volume throws a shadow onto itself.
    pub shadow: bool,
    /// Empty-space skipping: samples in transparent blocks are not taken.
    pub skip_empty: bool,
}

impl RayCasterFeatures {
    /// The features that `scene` asks for, none left out.
    pub fn asked_for(scene: &Classified) -> RayCasterFeatures {
        RayCasterFeatures {
            constant: false,
            shading: scene.phong.is_some(),
            shadow: scene.shadow.is_some(),
            skip_empty: false,
        }
    }
}

/// Features of a scene that the renderers of surfaces and media meet. They skip the code for the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RadiativeFeatures {
    /// There are media.
    pub media: bool,
    /// Vacuum media, without extinction and emission, are treated like others.
    pub vacuum_media: bool,
    /// There are surfaces.
    pub surfaces: bool,
    /// Media emit light.
    pub emission: bool,
    /// Coefficients of media differ between channels.
    pub chromatic: bool,
    /// Phase functions are anisotropic.
    pub anisotropic: bool,
    /// Densities vary in space.
    pub heterogeneous: bool,
}

impl RadiativeFeatures {
    /// Every feature; vacuum media are skipped, as always.
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

impl fmt::Display for Kernel<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Kernel::Curve(_) => f.write_str("plot of the transfer function"),
            Kernel::Background(_) => f.write_str("background only"),
            Kernel::RayCaster { features, .. } => {
                let leaps = ["", ", over empty space by leaps"][usize::from(features.skip_empty)];
                write!(f, "ray caster{leaps}")
            }
            Kernel::Conventional(_) => f.write_str("ray caster for other conventions"),
            Kernel::Several(scene) => {
                write!(f, "ray caster: {} merged", scene.counted_objects())
            }
            Kernel::Integral(_) => f.write_str("integral along each ray, piece by piece"),
            Kernel::Field(scene) => {
                let mode = scene.mode.name().unwrap_or_default();
                let how = ["sampled", "exact, cell by cell"][usize::from(scene.is_exact())];
                write!(f, "{mode} along each ray, {how}")
            }
            Kernel::LineOfSight { .. } => f.write_str("integral along the line of sight"),
            Kernel::PathTracer { max_order, .. } => match max_order {
                None => f.write_str("path tracer, scattering of any order"),
                Some(order) => write!(f, "path tracer, scattering up to order {order}"),
            },
        }
    }
}

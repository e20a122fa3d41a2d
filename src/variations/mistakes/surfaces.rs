//! Mistakes about surfaces.

use super::{Edit, Mistake};
use crate::optics::Material;
use glam::DVec3;
use std::f64::consts::PI;

pub(super) const MISTAKES: &[Mistake] = &[
    Mistake {
        name: "diffuse-over-pi",
        advice: "diffuse surfaces are too dark by a factor of pi: Lambert's reflection is reflectance / pi, once; sampled by the cosine, the pi of the pdf cancels it",
        edit: Edit::Material(|material| {
            if let Material::Diffuse(reflectance) = material {
                *reflectance /= PI;
            }
        }),
    },
    Mistake {
        name: "diffuse-black",
        advice: "diffuse surfaces reflect nothing: rays that hit them must continue, or sample the lights",
        edit: Edit::Material(|material| {
            if let Material::Diffuse(reflectance) = material {
                *reflectance = DVec3::ZERO;
            }
        }),
    },
    Mistake {
        name: "mirror-black",
        advice: "mirrors are black: a specular reflection cannot be found by sampling lights, so the mirrored ray must be followed and see the lights itself",
        edit: Edit::Material(|material| {
            if let Material::Mirror(reflectance) = material {
                *reflectance = DVec3::ZERO;
            }
        }),
    },
    Mistake {
        name: "glass-inside-out",
        advice: "glass refracts the wrong way: its index is that of the inside over that of the outside; check which side the ray comes from",
        edit: Edit::Material(|material| {
            if let Material::Glass(index) = material {
                *index = 1.0 / *index;
            }
        }),
    },
    Mistake {
        name: "glass-without-refraction",
        advice: "light goes straight through glass: refract by Snell's law and split by Fresnel's equations",
        edit: Edit::Material(|material| {
            if let Material::Glass(index) = material {
                *index = 1.0;
            }
        }),
    },
];

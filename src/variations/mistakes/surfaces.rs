//! Mistakes about surfaces.

use super::{Edit, Mistake};
use crate::optics::Material;
use glam::DVec3;
use std::f64::consts::PI;

pub(super) const MISTAKES: &[Mistake] = mistakes! {
    "diffuse-over-pi" => Material(|material| diffuse(material, |reflectance| reflectance / PI)),
        "diffuse surfaces are too dark by a factor of pi: Lambert's reflection is reflectance / pi, once; sampled by the cosine, the pi of the pdf cancels it";
    "diffuse-black" => Material(|material| diffuse(material, |_| DVec3::ZERO)),
        "diffuse surfaces reflect nothing: rays that hit them must continue, or sample the lights";
    "mirror-black" => Material(|material| {
        if let Material::Mirror(reflectance) = material {
            *reflectance = DVec3::ZERO;
        }
    }),
        "mirrors are black: a specular reflection cannot be found by sampling lights, so the mirrored ray must be followed and see the lights itself";
    "glass-inside-out" => Material(|material| glass(material, |index| 1.0 / index)),
        "glass refracts the wrong way: its index is that of the inside over that of the outside; check which side the ray comes from";
    "glass-without-refraction" => Material(|material| glass(material, |_| 1.0)),
        "light goes straight through glass: refract by Snell's law and split by Fresnel's equations";
};

fn diffuse(material: &mut Material, edit: fn(DVec3) -> DVec3) {
    if let Material::Diffuse(reflectance) = material {
        *reflectance = edit(*reflectance);
    }
}

fn glass(material: &mut Material, edit: fn(f64) -> f64) {
    if let Material::Glass(index) = material {
        *index = edit(*index);
    }
}

//! Numbers of surfaces that reflect or refract.

use super::{Number, Quantity, in_radiative};
use crate::optics::Material;
use crate::scene::{Object, Radiative, Scene};
use crate::sensitivity::number::Dependence::Smooth;
use glam::DVec3;

static REFLECTANCE: Quantity = Quantity::share("reflectance", "reflectance", "diffuse surface");
static MIRROR: Quantity = Quantity::share("mirror", "reflectance of mirrors", "diffuse surface");
static INDEX: Quantity =
    Quantity::absolute("index", "refractive index of glass", "diffuse surface", "");

/// Reflectance of all diffuse surfaces, and of each by itself; of mirrors; the index of glass.
pub(super) fn numbers(scene: &Radiative) -> Vec<Number> {
    let mut numbers = Vec::new();
    let materials = || scene.objects.iter().map(|object| object.material);
    let is_lit = |colour: DVec3| colour != DVec3::ZERO;
    let diffuse: Vec<usize> = (0..scene.objects.len())
        .filter(
            |&at| matches!(scene.objects[at].material, Material::Diffuse(colour) if is_lit(colour)),
        )
        .collect();
    let brighter = |object: &mut Object, change: f64| {
        if let Material::Diffuse(reflectance) = &mut object.material {
            *reflectance = reflectance_of(*reflectance, change)?;
        }
        Some(())
    };
    if !diffuse.is_empty() {
        numbers.push(Number::new(&REFLECTANCE, 0.05, Smooth, all(brighter)));
    }
    if diffuse.len() > 1 {
        for (number, at) in diffuse.into_iter().enumerate() {
            let edit = move |scene: &mut Scene, change: f64| {
                objects(scene, |index, object| {
                    if index == at {
                        brighter(object, change)
                    } else {
                        Some(())
                    }
                })
            };
            let number = Number::new(&REFLECTANCE, 0.1, Smooth, edit).numbered(Some(number + 1));
            numbers.push(number);
        }
    }
    if materials().any(|material| matches!(material, Material::Mirror(colour) if is_lit(colour))) {
        let edit = |object: &mut Object, change: f64| {
            if let Material::Mirror(reflectance) = &mut object.material {
                *reflectance = reflectance_of(*reflectance, change)?;
            }
            Some(())
        };
        numbers.push(Number::new(&MIRROR, 0.05, Smooth, all(edit)));
    }
    if materials().any(|material| matches!(material, Material::Glass(_))) {
        let edit = |object: &mut Object, change: f64| {
            if let Material::Glass(index) = &mut object.material {
                *index += change;
                // One and below is no glass in air; its rays are not continued smoothly.
                return (*index > 1.0).then_some(());
            }
            Some(())
        };
        numbers.push(Number::new(&INDEX, 0.1, Smooth, all(edit)).fine());
    }
    numbers
}

/// A share larger, where no surface then reflects more than it receives.
fn reflectance_of(reflectance: DVec3, change: f64) -> Option<DVec3> {
    let changed = reflectance * (1.0 + change);
    (changed.min_element() >= 0.0 && changed.max_element() <= 1.0).then_some(changed)
}

fn objects(
    scene: &mut Scene,
    mut edit: impl FnMut(usize, &mut Object) -> Option<()>,
) -> Option<()> {
    in_radiative(scene, |radiative| {
        let objects = radiative.objects.iter_mut().enumerate();
        objects.map(|(at, object)| edit(at, object)).collect()
    })
}

fn all(
    edit: fn(&mut Object, f64) -> Option<()>,
) -> impl Fn(&mut Scene, f64) -> Option<()> + Send + Sync {
    move |scene, change| objects(scene, |_, object| edit(object, change))
}

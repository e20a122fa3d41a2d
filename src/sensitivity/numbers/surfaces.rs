//! Parameters of surfaces that reflect or refract.

use super::Number;
use crate::optics::Material;
use crate::scene::Radiative;
use glam::DVec3;

const SURFACE: &str = "diffuse surface";
const REFLECTANCE: [&str; 3] = ["reflectance", "reflectance", SURFACE];

/// Changes a material, where that has the parameter; nothing where the changed parameter has no meaning.
type Edit = fn(&mut Material, f64) -> Option<()>;

/// Reflectance of all diffuse surfaces, and of each by itself; of mirrors; the index of glass.
pub(super) fn numbers(scene: &Radiative) -> Vec<Number> {
    let materials = || scene.objects.iter().map(|object| object.material);
    let of_all = |names, step, edit: Edit| {
        Number::radiative(names, step, move |scene, change| {
            let materials = scene.objects.iter_mut().map(|object| &mut object.material);
            materials.map(|material| edit(material, change)).collect()
        })
    };
    let mut numbers = Vec::new();
    let is_diffuse =
        |it: &Material| matches!(it, Material::Diffuse(colour) if *colour != DVec3::ZERO);
    let diffuse = || materials().enumerate().filter(|(_, it)| is_diffuse(it));
    let count = diffuse().count();
    if count > 0 {
        numbers.push(of_all(REFLECTANCE, 0.05, brighter));
    }
    for ((at, _), index) in diffuse().zip(1..).filter(|_| count > 1) {
        let number = Number::radiative(REFLECTANCE, 0.1, move |scene, change| {
            match scene.objects.get_mut(at) {
                Some(object) => brighter(&mut object.material, change),
                None => Some(()),
            }
        });
        numbers.push(number.numbered(Some(index)));
    }
    if materials().any(|it| matches!(it, Material::Mirror(colour) if colour != DVec3::ZERO)) {
        let names = ["mirror", "reflectance of mirrors", SURFACE];
        numbers.push(of_all(names, 0.05, |material, change| {
            if let Material::Mirror(reflectance) = material {
                *reflectance = reflectance_of(*reflectance, change)?;
            }
            Some(())
        }));
    }
    if materials().any(|it| matches!(it, Material::Glass(_))) {
        let names = ["index", "refractive index of glass", SURFACE];
        let index = of_all(names, 0.1, |material, change| {
            if let Material::Glass(index) = material {
                *index += change;
                // One and below is no glass in air; its rays are not continued smoothly.
                return (*index > 1.0).then_some(());
            }
            Some(())
        });
        numbers.push(index.per(""));
    }
    numbers
}

fn brighter(material: &mut Material, change: f64) -> Option<()> {
    if let Material::Diffuse(reflectance) = material {
        *reflectance = reflectance_of(*reflectance, change)?;
    }
    Some(())
}

/// A share larger, where no surface then reflects more than it receives.
fn reflectance_of(reflectance: DVec3, change: f64) -> Option<DVec3> {
    let changed = reflectance * (1.0 + change);
    (changed.min_element() >= 0.0 && changed.max_element() <= 1.0).then_some(changed)
}

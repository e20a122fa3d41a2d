//! The mirrors and glass of a scene, and the directions towards them.

use crate::geometry::{Direction, Surface, length_of};
use crate::math::sampling::Cone;
use crate::optics::Material;
use crate::scene::{Object, Radiative};
use glam::DVec3;

/// A mirror or glass, and the sphere around it.
#[derive(Clone, Copy, Debug)]
pub struct SpecularObject {
    /// Index among the objects of the scene.
    pub object: usize,
    /// Light goes on from it in two directions.
    pub is_glass: bool,
    centre: DVec3,
    radius: f64,
}

impl SpecularObject {
    /// The mirrors and glass of `scene`, in its order.
    pub fn of(scene: &Radiative) -> Vec<SpecularObject> {
        let objects = scene.objects.iter().enumerate();
        objects
            .filter_map(|(object, Object { shape, material })| {
                let is_glass = match material {
                    Material::Diffuse(_) => return None,
                    Material::Mirror(_) => false,
                    Material::Glass(_) => true,
                };
                let (centre, radius) = shape.bounding_sphere();
                Some(SpecularObject {
                    object,
                    is_glass,
                    centre,
                    radius,
                })
            })
            .collect()
    }

    /// The cone of directions from `point` to the sphere, and its axis; `None` from inside.
    pub fn seen_from(&self, point: DVec3) -> Option<(Cone, Direction)> {
        let towards = self.centre - point;
        let cone = Cone::around_sphere(self.radius, length_of(towards))?;
        Some((cone, Direction::of(towards)?))
    }
}

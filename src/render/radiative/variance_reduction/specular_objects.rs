//! The mirrors and glass of a scene, and the directions towards them.

use crate::geometry::{Direction, Surface, length_of};
use crate::math::Frame;
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

/// The cone of directions from a point to the sphere around an object.
#[derive(Clone, Copy, Debug)]
pub struct ConeToObject {
    axis: Direction,
    cone: Cone,
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

    /// The directions from `point` to the sphere; `None` from inside.
    pub fn seen_from(&self, point: DVec3) -> Option<ConeToObject> {
        let towards = self.centre - point;
        let cone = Cone::around_sphere(self.radius, length_of(towards))?;
        let axis = Direction::of(towards)?;
        Some(ConeToObject { axis, cone })
    }
}

impl ConeToObject {
    /// The direction for two numbers in [0, 1). Uniform numbers give uniform directions.
    pub fn direction(&self, numbers: [f64; 2]) -> Direction {
        Frame::around(self.axis).to_world(self.cone.direction(numbers))
    }

    /// Density of [`direction`](ConeToObject::direction), per steradian, the same everywhere.
    pub fn pdf(&self) -> f64 {
        self.cone.pdf()
    }
}

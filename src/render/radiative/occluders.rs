//! The surfaces that may stand between a vertex and a light.
//!
//! A wall stands between no two points of its room: where all vertices and lights of a scene lie on
//! one side of the plane of a rectangle, all segments between them do.

use crate::geometry::{Luminous, Ray, Rectangle, Shape, Surface};
use crate::scene::Radiative;
use glam::DVec3;

/// Surfaces that are tested one by one.
#[derive(Debug)]
pub(crate) struct Occluders<'s> {
    /// Surfaces that reflect or refract.
    objects: Vec<&'s Shape>,
    /// Surfaces that emit.
    area_lights: Vec<&'s Luminous>,
}

impl<'s> Occluders<'s> {
    /// All surfaces of `scene`.
    pub fn all(scene: &'s Radiative) -> Occluders<'s> {
        let objects = scene.objects.iter().map(|object| &object.shape);
        let area_lights = scene.area_lights.iter().map(|light| &light.shape);
        Occluders {
            objects: objects.collect(),
            area_lights: area_lights.collect(),
        }
    }

    /// The surfaces of `scene` but the walls; all, if a medium fills all space.
    pub fn within_walls(scene: &'s Radiative) -> Occluders<'s> {
        let mut occluders = Occluders::all(scene);
        let Some(hull) = hull_of_vertices(scene) else {
            return occluders;
        };
        let lights = scene.lights.iter().filter_map(|light| light.position());
        let lights: Vec<DVec3> = lights.collect();
        let is_wall = |rectangle: &Rectangle| rectangle.has_on_one_side(&hull, &lights);
        let objects = &mut occluders.objects;
        objects.retain(|shape| !matches!(shape, Shape::Rectangle(it) if is_wall(it)));
        let area_lights = &mut occluders.area_lights;
        area_lights.retain(|shape| !matches!(shape, Luminous::Rectangle(it) if is_wall(it)));
        occluders
    }

    /// Number of surfaces.
    pub fn count(&self) -> u64 {
        (self.objects.len() + self.area_lights.len()) as u64
    }

    /// Whether one of them stands between the origin of `ray` and the distance `limit`.
    pub fn block(&self, ray: &Ray, limit: f64) -> bool {
        self.objects.iter().any(|it| it.blocks(ray, limit))
            || self.area_lights.iter().any(|it| it.blocks(ray, limit))
    }
}

/// Points whose convex hull holds all vertices and area lights, up to rounding; `None` if a medium fills all
/// space.
fn hull_of_vertices(scene: &Radiative) -> Option<Vec<DVec3>> {
    let objects = scene.objects.iter().map(|object| object.shape.hull());
    let lights = scene.area_lights.iter().map(|light| light.shape.hull());
    let mut hull: Vec<DVec3> = objects.chain(lights).flatten().collect();
    for body in &scene.media {
        hull.extend(body.boundary.as_ref()?.hull());
    }
    Some(hull)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Model, Scene};
    use std::path::Path;

    /// Number of occluders in a room of floor and ceiling, with a lamp below the ceiling, and `more`.
    fn count(more: &str) -> u64 {
        let text = format!(
            "[film]\nwidth = 1\nheight = 1\n[camera]\neye = [0, 1, -9]\ntarget = [0, 1, 0]\n\
             vertical_fov = 40\n[sampling]\nsamples = 1\n[radiative]\nscattering = 'multiple'\n\
             [[radiative.surface]]\ndiffuse = {{ reflectance = 0.5 }}\n\
             rectangle = {{ corner = [-1, 0, -1], edge_u = [2, 0, 0], edge_v = [0, 0, 2] }}\n\
             [[radiative.surface]]\ndiffuse = {{ reflectance = 0.5 }}\n\
             rectangle = {{ corner = [-1, 2, -1], edge_u = [2, 0, 0], edge_v = [0, 0, 2] }}\n\
             [[radiative.surface]]\nemitter = {{ radiance = 1 }}\n\
             rectangle = {{ corner = [-0.5, 1.9, -0.5], edge_u = [1, 0, 0], edge_v = [0, 0, 1] }}\n\
             {more}"
        );
        let scene = Scene::parse(&text, Path::new("room.toml")).unwrap();
        let Model::Radiative(radiative) = &scene.panels[0].model else {
            panic!("a radiative scene");
        };
        Occluders::within_walls(radiative).count()
    }

    #[test]
    fn floor_and_ceiling_occlude_nothing() {
        assert_eq!(count(""), 1);
        let fog = "[[radiative.medium]]\nsigma_s = 0.1\nsigma_a = 0.1\n";
        let within = "box = { min = [-1, 0, -1], max = [1, 2, 1] }\n";
        assert_eq!(count(&format!("{fog}{within}")), 1);
    }

    #[test]
    fn what_has_something_behind_it_may_occlude() {
        let fog = "[[radiative.medium]]\nsigma_s = 0.1\nsigma_a = 0.1\n";
        let above = "box = { min = [-1, 0, -1], max = [1, 2.5, 1] }\n";
        assert_eq!(count(fog), 3);
        assert_eq!(count(&format!("{fog}{above}")), 2);
        let light = "[[radiative.light]]\npoint = { position = [0, -0.1, 0], intensity = 1 }\n";
        assert_eq!(count(light), 2);
        let sphere =
            "diffuse = { reflectance = 0.5 }\nsphere = { centre = [0, 0.5, 0], radius = 1 }\n";
        assert_eq!(count(&format!("[[radiative.surface]]\n{sphere}")), 3);
    }
}

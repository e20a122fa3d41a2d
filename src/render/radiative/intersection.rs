//! Surfaces along a ray.

use super::effects::Effects;
use super::scene_context::SceneContext;
use crate::geometry::{Hit, Ray, Surface};
use crate::render::counters::{Event, Work};

/// The nearest surface along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Intersection {
    /// The surface.
    pub surface: SurfaceIndex,
    /// Point, distance and side.
    pub hit: Hit,
}

/// A surface, by its index in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceIndex {
    /// One that reflects or refracts.
    Object(usize),
    /// One that emits.
    AreaLight(usize),
}

impl<E: Effects> SceneContext<'_, E> {
    /// The nearest surface on `ray`, of several at the same distance the first of the scene.
    pub fn intersect<W: Work>(&self, ray: &Ray, work: &mut W) -> Option<Intersection> {
        if !E::SURFACES {
            return None;
        }
        work.count_times(Event::SurfaceTest, self.surfaces());
        let mut nearest: Option<Intersection> = None;
        let limit = |nearest: &Option<Intersection>| nearest.map_or(f64::INFINITY, |n| n.hit.t);
        for (index, object) in self.radiative.objects.iter().enumerate() {
            if let Some(hit) = object.shape.hit(ray, limit(&nearest)) {
                let surface = SurfaceIndex::Object(index);
                nearest = Some(Intersection { surface, hit });
            }
        }
        for (index, light) in self.radiative.area_lights.iter().enumerate() {
            if let Some(hit) = light.shape.hit(ray, limit(&nearest)) {
                let surface = SurfaceIndex::AreaLight(index);
                nearest = Some(Intersection { surface, hit });
            }
        }
        nearest
    }

    /// No surface stands between the origin of `ray` and the distance `limit`.
    pub fn is_unoccluded<W: Work>(&self, ray: &Ray, limit: f64, work: &mut W) -> bool {
        work.count_times(Event::SurfaceTest, self.surfaces());
        let (objects, lights) = (&self.radiative.objects, &self.radiative.area_lights);
        !objects.iter().any(|object| object.shape.blocks(ray, limit))
            && !lights.iter().any(|light| light.shape.blocks(ray, limit))
    }

    fn surfaces(&self) -> u64 {
        (self.radiative.objects.len() + self.radiative.area_lights.len()) as u64
    }
}

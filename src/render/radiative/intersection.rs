//! Surfaces along a ray.

use super::effects::Effects;
use super::scene_context::SceneContext;
use super::surfaces::Intersection;
use crate::geometry::Ray;
use crate::render::counters::{Event, Work};

impl<E: Effects> SceneContext<'_, E> {
    /// The nearest surface on `ray`, of several at the same distance the first of the scene.
    pub fn intersect<W: Work>(&self, ray: &Ray, work: &mut W) -> Option<Intersection> {
        if !E::SURFACES {
            return None;
        }
        work.count_times(Event::SurfaceTest, self.surfaces.count());
        self.surfaces.nearest(ray)
    }

    /// No surface stands between the origin of `ray`, a vertex or a light, and another of them at the
    /// distance `limit`; if that is infinite, anywhere on `ray`.
    pub fn is_unoccluded<W: Work>(&self, ray: &Ray, limit: f64, work: &mut W) -> bool {
        let occluders = self.surfaces.occluders(limit);
        work.count_times(Event::SurfaceTest, occluders.count());
        !self.surfaces.block(ray, limit)
    }
}

//! Light that arrives along a shadow ray.

use super::effects::Effects;
use super::scene_context::SceneContext;
use super::tracker::Tracker;
use crate::geometry::Ray;
use crate::render::counters::{Event, Work};
use glam::DVec3;

impl<E: Effects> SceneContext<'_, E> {
    /// Transmittance, by channel, from the origin of `ray` to `distance`: 0 behind a surface, an
    /// estimate through heterogeneous media that scatter.
    pub fn visibility<W: Work>(
        &self,
        ray: &Ray,
        distance: f64,
        tracker: &mut Tracker<'_, W>,
    ) -> DVec3 {
        tracker.work.count(Event::ShadowRay);
        if E::SURFACES && !self.is_unoccluded(ray, distance, tracker.work) {
            return DVec3::ZERO;
        }
        if !E::MEDIA {
            return DVec3::ONE;
        }
        self.transmittance(ray, distance, tracker)
    }
}

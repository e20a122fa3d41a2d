//! Light that arrives along a shadow ray.

use super::scene_context::SceneContext;
use super::tracker::Tracker;
use super::transmittance::Transmittance;
use crate::geometry::Ray;
use crate::render::counters::Event;
use glam::DVec3;

/// Visibility along the shadow rays of a scene.
#[derive(Clone, Copy)]
pub struct Visibility<'s>(pub &'s SceneContext<'s>);

impl Visibility<'_> {
    /// Transmittance, by channel, from the origin of `ray` to `distance`: 0 behind a surface, an
    /// estimate through heterogeneous media that scatter.
    pub fn along(self, ray: &Ray, distance: f64, tracker: &mut Tracker<'_>) -> DVec3 {
        tracker.work.count(Event::ShadowRay);
        if self.0.features.surfaces && self.0.surfaces.block(ray, distance, tracker.work) {
            return DVec3::ZERO;
        }
        if !self.0.features.media {
            return DVec3::ONE;
        }
        Transmittance(self.0).along(ray, distance, tracker)
    }
}

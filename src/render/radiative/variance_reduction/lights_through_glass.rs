//! Area lights seen from the eye by way of mirrors and glass.
//!
//! Glass reflects a few per cent, and refracts the rest. A path takes one of both ways, at random: where
//! a light is seen reflected, few paths bring back all of it, and the pixels are noisier than all others.
//! So lights are also looked for along both ways, from the eye on, and what is found is complete: paths
//! count lights only behind more bounces.

use super::specular_chain::{Follower, SpecularChain};
use crate::geometry::Ray;
use crate::render::radiative::direct_light::emitted_radiance;
use crate::render::radiative::scene_context::SceneContext;
use crate::render::radiative::specular::specular_bounces;
use crate::render::radiative::surfaces::{Intersection, SurfaceIndex};
use crate::render::radiative::tracker::Tracker;
use crate::render::radiative::transmittance::Transmittance;
use glam::DVec3;

/// Area lights of a scene, seen by way of its mirrors and glass.
#[derive(Clone, Copy)]
pub struct LightsThroughGlass<'s>(pub &'s SceneContext<'s>);

impl LightsThroughGlass<'_> {
    /// Radiance of area lights along `ray` from the eye, which ends at `end`, a mirror or glass: behind up
    /// to [`Follower::FROM_EYE`] specular bounces, and no more than `limit`.
    pub fn radiance(
        self,
        ray: &Ray,
        end: &Intersection,
        limit: u32,
        tracker: &mut Tracker<'_>,
    ) -> DVec3 {
        if !self.is_followed_from_eye() {
            return DVec3::ZERO;
        }
        self.radiance_behind(ray, end, Follower::FROM_EYE.min(limit as usize), tracker)
    }

    /// Radiance of area lights along `ray`, which ends at `end`, behind at most `most` bounces.
    fn radiance_behind(
        self,
        ray: &Ray,
        end: &Intersection,
        most: usize,
        tracker: &mut Tracker<'_>,
    ) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        match end.surface {
            SurfaceIndex::AreaLight(index) => {
                radiance = emitted_radiance(&self.0.radiative.area_lights[index], &end.hit);
            }
            SurfaceIndex::Object(index) if most > 0 => {
                let material = &self.0.radiative.objects[index].material;
                let ways = specular_bounces(material, ray, &end.hit);
                for way in ways.into_iter().flatten() {
                    if let Some(next) = self.0.intersect(&way.ray, tracker.work) {
                        let beyond = self.radiance_behind(&way.ray, &next, most - 1, tracker);
                        radiance += way.share * way.weight * beyond;
                    }
                }
            }
            SurfaceIndex::Object(_) => {}
        }
        if self.0.features.media && radiance != DVec3::ZERO {
            radiance *= Transmittance(self.0).along(ray, end.hit.t, tracker);
        }
        radiance
    }

    /// The chain that the first bounce of a path from the eye begins.
    pub fn chain_from_eye(self) -> SpecularChain {
        if self.is_followed_from_eye() {
            SpecularChain::begun(Follower::Eye, 0.0)
        } else {
            SpecularChain::ALONE
        }
    }

    /// Behind mirrors alone a path finds as much.
    fn is_followed_from_eye(self) -> bool {
        self.0.specular_objects.iter().any(|it| it.is_glass)
    }
}

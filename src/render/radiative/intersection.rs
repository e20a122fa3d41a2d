//! What light meets on a straight line: surfaces that stop it, media that take some of it away.

use super::effects::Effects;
use super::media::Media;
use super::tracker::Tracker;
use crate::geometry::{Hit, Ray, Surface};
use crate::render::counters::{Event, Work};
use crate::scene::Radiative;
use glam::DVec3;
use std::marker::PhantomData;

/// A scene, ready to be asked along rays, for the effects `E`.
#[derive(Debug)]
pub struct Surroundings<'s, E> {
    /// The scene.
    pub scene: &'s Radiative,
    /// Its media.
    pub media: Media<'s>,
    effects: PhantomData<E>,
}

/// A surface that was met, by its number in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Met {
    /// One that reflects or refracts.
    Object(usize),
    /// One that sends out light.
    AreaLight(usize),
}

impl<'s, E: Effects> Surroundings<'s, E> {
    /// The surroundings in `scene`, for random paths. With `null_media`, media of no matter are
    /// asked where they are like others.
    pub fn new(scene: &'s Radiative, null_media: bool) -> Self {
        Surroundings::with(scene, Media::new(&scene.media, null_media))
    }

    /// The same for integrals along the line of sight.
    pub fn for_integrals(scene: &'s Radiative, null_media: bool) -> Self {
        Surroundings::with(scene, Media::for_integrals(&scene.media, null_media))
    }

    fn with(scene: &'s Radiative, media: Media<'s>) -> Self {
        Surroundings {
            scene,
            media,
            effects: PhantomData,
        }
    }

    /// The nearest surface on `ray`, of several at the same distance the first of the scene.
    pub fn nearest<W: Work>(&self, ray: &Ray, work: &mut W) -> Option<(Met, Hit)> {
        if !E::SURFACES {
            return None;
        }
        work.count_times(Event::SurfaceTest, self.surfaces());
        let mut best: Option<(Met, Hit)> = None;
        let limit = |best: &Option<(Met, Hit)>| best.map_or(f64::INFINITY, |(_, hit)| hit.t);
        for (index, object) in self.scene.objects.iter().enumerate() {
            let hit = object.shape.hit(ray, limit(&best));
            best = hit.map(|hit| (Met::Object(index), hit)).or(best);
        }
        for (index, light) in self.scene.area_lights.iter().enumerate() {
            let hit = light.shape.hit(ray, limit(&best));
            best = hit.map(|hit| (Met::AreaLight(index), hit)).or(best);
        }
        best
    }

    /// By channel, the share of light that gets through from the origin of `ray` to `distance`:
    /// an estimate, where a medium of varying density scatters on the way.
    pub fn visibility<W: Work>(
        &self,
        ray: &Ray,
        distance: f64,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        work.count(Event::ShadowRay);
        if E::SURFACES && !self.is_clear(ray, distance, work) {
            return DVec3::ZERO;
        }
        if !E::MEDIA {
            return DVec3::ONE;
        }
        self.media
            .transmittance::<E, W>(ray, distance, tracker, work)
    }

    /// Whether no surface stands between the origin of `ray` and the distance `limit`.
    fn is_clear<W: Work>(&self, ray: &Ray, limit: f64, work: &mut W) -> bool {
        work.count_times(Event::SurfaceTest, self.surfaces());
        let (objects, lights) = (&self.scene.objects, &self.scene.area_lights);
        !objects.iter().any(|object| object.shape.blocks(ray, limit))
            && !lights.iter().any(|light| light.shape.blocks(ray, limit))
    }

    fn surfaces(&self) -> u64 {
        (self.scene.objects.len() + self.scene.area_lights.len()) as u64
    }
}

//! What a ray meets: the nearest surface, and whether anything stands in its way.

use super::work::{Event, Work};
use crate::geometry::{Hit, Ray, Surface};
use crate::scene::Radiative;

/// A surface that was met, by its number in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Met {
    /// One that reflects or refracts.
    Object(usize),
    /// One that sends out light.
    AreaLight(usize),
}

/// The nearest surface on `ray`, of several at the same distance the first of the scene.
pub fn nearest<W: Work>(scene: &Radiative, ray: &Ray, work: &mut W) -> Option<(Met, Hit)> {
    work.count_times(Event::SurfaceTest, surfaces(scene));
    let mut best: Option<(Met, Hit)> = None;
    let limit = |best: &Option<(Met, Hit)>| best.map_or(f64::INFINITY, |(_, hit)| hit.t);
    for (index, object) in scene.objects.iter().enumerate() {
        let hit = object.shape.hit(ray, limit(&best));
        best = hit.map(|hit| (Met::Object(index), hit)).or(best);
    }
    for (index, light) in scene.area_lights.iter().enumerate() {
        let hit = light.shape.hit(ray, limit(&best));
        best = hit.map(|hit| (Met::AreaLight(index), hit)).or(best);
    }
    best
}

/// Whether no surface stands between the origin of `ray` and the distance `limit`.
pub fn is_clear<W: Work>(scene: &Radiative, ray: &Ray, limit: f64, work: &mut W) -> bool {
    work.count_times(Event::SurfaceTest, surfaces(scene));
    !scene
        .objects
        .iter()
        .any(|object| object.shape.blocks(ray, limit))
        && !scene
            .area_lights
            .iter()
            .any(|light| light.shape.blocks(ray, limit))
}

fn surfaces(scene: &Radiative) -> u64 {
    (scene.objects.len() + scene.area_lights.len()) as u64
}

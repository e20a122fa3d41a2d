//! The surfaces of a scene.

use super::occluders::Occluders;
use crate::geometry::{Bvh, Crossing, Hit, Ray, Surface};
use crate::render::counters::{Counters, Event};
use crate::scene::{AreaLight, Object, Radiative};

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

/// Surfaces that a ray is tested against one by one: the way through a hierarchy of so few takes
/// longer, in a room of nine by an eighth of all time.
const FEW: usize = 16;

/// The surfaces of a scene, sorted for rays where they are many.
#[derive(Debug)]
pub struct Surfaces<'s> {
    objects: &'s [Object],
    area_lights: &'s [AreaLight],
    hierarchy: Option<Bvh>,
    all: Occluders<'s>,
    /// Without walls, unless there is a hierarchy, which has them.
    between_vertices: Occluders<'s>,
}

impl<'s> Surfaces<'s> {
    /// The surfaces of `scene`.
    pub fn new(scene: &'s Radiative) -> Surfaces<'s> {
        let (objects, area_lights) = (&scene.objects[..], &scene.area_lights[..]);
        let are_many = objects.len() + area_lights.len() > FEW;
        let hierarchy = are_many.then(|| {
            let objects = objects.iter().map(|object| object.shape.bounds_of_hits());
            let lights = area_lights.iter().map(|light| light.shape.bounds_of_hits());
            Bvh::new(&objects.chain(lights).collect::<Vec<_>>())
        });
        Surfaces {
            objects,
            area_lights,
            hierarchy,
            all: Occluders::all(scene),
            between_vertices: if are_many {
                Occluders::all(scene)
            } else {
                Occluders::within_walls(scene)
            },
        }
    }

    /// A surface by its number: objects first, then area lights.
    fn index(&self, number: usize) -> SurfaceIndex {
        match number.checked_sub(self.objects.len()) {
            None => SurfaceIndex::Object(number),
            Some(light) => SurfaceIndex::AreaLight(light),
        }
    }

    fn shape(&self, surface: SurfaceIndex) -> &dyn Surface {
        match surface {
            SurfaceIndex::Object(index) => &self.objects[index].shape,
            SurfaceIndex::AreaLight(index) => &self.area_lights[index].shape,
        }
    }

    /// The nearest surface on `ray`; among several at the same distance, the first of the scene.
    pub fn nearest(&self, ray: &Ray, work: &mut Counters) -> Option<Intersection> {
        work.count_times(Event::SurfaceTest, self.all.count());
        match &self.hierarchy {
            Some(hierarchy) => self.nearest_in(hierarchy, ray),
            None => self.nearest_of_all(ray),
        }
    }

    fn nearest_of_all(&self, ray: &Ray) -> Option<Intersection> {
        let mut nearest: Option<(SurfaceIndex, Crossing)> = None;
        let mut limit = f64::INFINITY;
        for (index, object) in self.objects.iter().enumerate() {
            if let Some(crossing) = object.shape.crossing(ray, limit) {
                limit = crossing.t;
                nearest = Some((SurfaceIndex::Object(index), crossing));
            }
        }
        for (index, light) in self.area_lights.iter().enumerate() {
            if let Some(crossing) = light.shape.crossing(ray, limit) {
                limit = crossing.t;
                nearest = Some((SurfaceIndex::AreaLight(index), crossing));
            }
        }
        nearest.map(|(surface, crossing)| self.intersection(ray, surface, &crossing))
    }

    /// The nearest area light on `ray` before the distance `limit`, whatever stands in front of it, by
    /// its index.
    // The loop stands in `nearest_of_all` too: one function for both takes 6 % more time in a room.
    pub(crate) fn nearest_light(&self, ray: &Ray, mut limit: f64) -> Option<(usize, Hit)> {
        let mut nearest = None;
        for (index, light) in self.area_lights.iter().enumerate() {
            if let Some(crossing) = light.shape.crossing(ray, limit) {
                limit = crossing.t;
                nearest = Some((index, crossing));
            }
        }
        let (index, crossing) = nearest?;
        Some((index, self.area_lights[index].shape.hit_at(ray, &crossing)))
    }

    fn intersection(&self, ray: &Ray, surface: SurfaceIndex, crossing: &Crossing) -> Intersection {
        let hit = self.shape(surface).hit_at(ray, crossing);
        Intersection { surface, hit }
    }

    fn nearest_in(&self, hierarchy: &Bvh, ray: &Ray) -> Option<Intersection> {
        let mut nearest: Option<(usize, Crossing)> = None;
        hierarchy.walk(ray, 0.0, f64::INFINITY, |number, _| {
            let limit = match &nearest {
                None => f64::INFINITY,
                Some((other, crossing)) if *other < number => crossing.t,
                // An earlier one at the same distance is preferred.
                Some((_, crossing)) => crossing.t.next_up(),
            };
            let crossing = self.shape(self.index(number)).crossing(ray, limit);
            nearest = crossing.map(|crossing| (number, crossing)).or(nearest);
            nearest.map_or(f64::INFINITY, |(_, crossing)| crossing.t)
        });
        nearest.map(|(number, crossing)| self.intersection(ray, self.index(number), &crossing))
    }

    /// Whether a surface stands between the origin of `ray`, a vertex or a light, and another of them at the
    /// distance `limit`; if that is infinite, anywhere on `ray`.
    pub fn block(&self, ray: &Ray, limit: f64, work: &mut Counters) -> bool {
        let occluders = match limit.is_finite() {
            true => &self.between_vertices,
            false => &self.all,
        };
        work.count_times(Event::SurfaceTest, occluders.count());
        let Some(hierarchy) = &self.hierarchy else {
            return occluders.block(ray, limit);
        };
        let mut blocked = false;
        hierarchy.walk(ray, 0.0, limit, |number, limit| {
            blocked = self.shape(self.index(number)).blocks(ray, limit);
            if blocked { f64::NEG_INFINITY } else { limit }
        });
        blocked
    }
}

//! The surfaces of a scene.

use super::occluders::Occluders;
use crate::geometry::{Bvh, Crossing, Hit, Ray, Surface};
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

    /// Their number.
    pub fn count(&self) -> u64 {
        (self.objects.len() + self.area_lights.len()) as u64
    }

    /// The surfaces that [`Surfaces::block`] may test.
    pub(crate) fn occluders(&self, limit: f64) -> &Occluders<'s> {
        if limit.is_finite() {
            &self.between_vertices
        } else {
            &self.all
        }
    }

    /// A surface by its number: objects first, then area lights.
    fn index(&self, number: usize) -> SurfaceIndex {
        match number.checked_sub(self.objects.len()) {
            None => SurfaceIndex::Object(number),
            Some(light) => SurfaceIndex::AreaLight(light),
        }
    }

    /// The nearest surface on `ray`, of several at the same distance the first of the scene.
    pub fn nearest(&self, ray: &Ray) -> Option<Intersection> {
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
        let hit = match surface {
            SurfaceIndex::Object(index) => self.objects[index].shape.hit_at(ray, crossing),
            SurfaceIndex::AreaLight(index) => self.area_lights[index].shape.hit_at(ray, crossing),
        };
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
            let crossing = match self.index(number) {
                SurfaceIndex::Object(index) => self.objects[index].shape.crossing(ray, limit),
                SurfaceIndex::AreaLight(index) => {
                    self.area_lights[index].shape.crossing(ray, limit)
                }
            };
            nearest = crossing.map(|crossing| (number, crossing)).or(nearest);
            nearest.map_or(f64::INFINITY, |(_, crossing)| crossing.t)
        });
        nearest.map(|(number, crossing)| self.intersection(ray, self.index(number), &crossing))
    }

    /// A surface stands between the origin of `ray`, a vertex or a light, and another of them at the
    /// distance `limit`; if that is infinite, anywhere on `ray`.
    pub fn block(&self, ray: &Ray, limit: f64) -> bool {
        let Some(hierarchy) = &self.hierarchy else {
            return self.occluders(limit).block(ray, limit);
        };
        let mut blocked = false;
        hierarchy.walk(ray, 0.0, limit, |number, limit| {
            blocked = match self.index(number) {
                SurfaceIndex::Object(index) => self.objects[index].shape.blocks(ray, limit),
                SurfaceIndex::AreaLight(index) => self.area_lights[index].shape.blocks(ray, limit),
            };
            if blocked { f64::NEG_INFINITY } else { limit }
        });
        blocked
    }
}

//! What a vertex receives from places that a light without extent shines on: the glow of its
//! shaft in a medium, and of the surface where the shaft ends.
//!
//! A path that goes on from the vertex finds this light too: by its direction, then by a place
//! on its next ray or the surface at its end. But the smaller the shaft, the fewer paths meet it,
//! and those that pass the light itself at a distance `D` bring back something like `1/D`, whose
//! square has no bounded mean over all directions. So such places are also chosen from the
//! light's end: a direction out of the light, then the surface there, and a distance on the way
//! to it, by equal angles seen from the vertex. Both ways are weighted by multiple importance
//! sampling, and near each end the other one is the better.
//!
//! Sources: Lafortune & Willems 1996, "Rendering participating media with bidirectional path
//! tracing", EGWR '96; Georgiev et al. 2013, "Joint importance sampling of low-order volumetric
//! scattering", ACM TOG 32(6), on the square that has no mean.

use super::effects::Effects;
use super::intersection::{Met, Surroundings};
use super::sampler::Draws;
use super::scattering::Vertex;
use super::segments::MediaPath;
use super::single_scattering::{Place, Places};
use super::specular::facing;
use super::tracker::Tracker;
use crate::geometry::{Ray, SurfacePoint, direction_of, length_of};
use crate::math::Frame;
use crate::math::rng::Purpose;
use crate::math::sampling::{Cone, Equiangular, power_heuristic, sphere, sphere_pdf};
use crate::optics::{Light, Material};
use crate::render::counters::Work;
use glam::DVec3;
use std::f64::consts::PI;

/// Directions out of a light, all equally likely, and their density per steradian.
fn directions(light: &Light) -> Option<(Option<(Cone, Frame)>, f64)> {
    match light {
        Light::Point(_) => Some((None, sphere_pdf())),
        Light::Spot(spot) => {
            let cone = Cone::of_half_angle(spot.outer())?;
            Some((Some((cone, Frame::around(spot.axis()))), cone.pdf()))
        }
        Light::Directional(_) => None,
    }
}

/// Places along a ray that comes out of a light, as seen from `vertex`.
fn distances<E: Effects>(
    around: &Surroundings<'_, E>,
    out: &Ray,
    vertex: DVec3,
) -> Option<(f64, Equiangular)> {
    let within = around.media.scattering_span(out)?;
    let foot = (vertex - out.origin).dot(out.direction);
    let distance = (out.at(foot) - vertex).length();
    let angle = Equiangular::new(distance, within.near - foot, within.far - foot).ok()?;
    Some((foot, angle))
}

/// Density, per volume, with which the place `at` is chosen from the end of a light that stands
/// at `position`, for a vertex at `vertex`.
fn density_from_light<E: Effects>(
    around: &Surroundings<'_, E>,
    (light, position): (&Light, DVec3),
    vertex: DVec3,
    at: DVec3,
) -> f64 {
    let density = || {
        let (_, per_steradian) = directions(light)?;
        let out = Ray::new(position, at - position)?;
        let distance = (at - position).dot(out.direction);
        let (foot, angle) = distances(around, &out, vertex)?;
        Some(per_steradian * angle.pdf(distance - foot) / (distance * distance))
    };
    density().unwrap_or(0.0)
}

/// The weight of light found at `place` on a `ray` that was turned into its direction with
/// density `turned`, against finding it from the light's end.
pub fn weight_of_finding<E: Effects>(
    around: &Surroundings<'_, E>,
    light: (&Light, DVec3),
    ray: &Ray,
    place: &Place<'_>,
    turned: f64,
) -> f64 {
    let mine = turned * place.pdf / (place.t * place.t);
    power_heuristic(
        mine,
        density_from_light(around, light, ray.origin, ray.at(place.t)),
    )
}

/// Density, per steradian at `from`, with which the surface point `at` is chosen from the end of
/// a light.
fn surface_density_from_light(
    (light, position): (&Light, DVec3),
    from: DVec3,
    at: &SurfacePoint,
) -> f64 {
    let density = || {
        let (_, per_steradian) = directions(light)?;
        let (to_light, to_vertex) = (position - at.position, from - at.position);
        // Cosine over squared distance, of each end.
        let falling = |way: DVec3| {
            let length = length_of(way);
            way.dot(at.normal).abs() / (length * length * length)
        };
        Some(per_steradian * falling(to_light) / falling(to_vertex))
    };
    density().unwrap_or(0.0)
}

/// The weight of light found by meeting the surface point `at` on a `ray` that was turned into
/// its direction with density `turned`, against finding it from the light's end.
pub fn weight_of_reaching(
    light: (&Light, DVec3),
    ray: &Ray,
    at: &SurfacePoint,
    turned: f64,
) -> f64 {
    power_heuristic(turned, surface_density_from_light(light, ray.origin, at))
}

impl<E: Effects> Surroundings<'_, E> {
    /// Radiance sent back from `vertex` for what media and surfaces turn towards it, once, of
    /// the light with number `index`, which stands at `position`: places chosen from the light's
    /// end, weighted against the path finding them by itself.
    #[allow(
        clippy::too_many_arguments,
        reason = "a step of an estimator, and memory to work in"
    )]
    pub fn by_lit_places<W: Work>(
        &self,
        vertex: &Vertex,
        (light, position, index): (&Light, DVec3, usize),
        draws: &Draws<'_>,
        path: &mut MediaPath,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        let Some((cone, per_steradian)) = directions(light) else {
            return DVec3::ZERO;
        };
        let uv = draws.pair(Purpose::LitPlace, 2 * index, work);
        let direction = match cone {
            None => sphere(uv),
            Some((cone, frame)) => frame.to_world(cone.direction(uv)),
        };
        let Some(direction) = direction_of(direction) else {
            return DVec3::ZERO;
        };
        let out = Ray {
            origin: position,
            direction,
        };
        let mut radiance = DVec3::ZERO;
        if E::MEDIA {
            let [u, _] = draws.pair(Purpose::LitPlace, 2 * index + 1, work);
            let chosen = (per_steradian, u);
            radiance += self
                .by_lit_medium(vertex, (light, position), &out, chosen, path, tracker, work)
                .unwrap_or(DVec3::ZERO);
        }
        if E::SURFACES {
            radiance += self
                .by_lit_surface(vertex, light, &out, per_steradian, tracker, work)
                .unwrap_or(DVec3::ZERO);
        }
        radiance
    }

    /// From the medium on the ray `out` of the light, whose direction has the density
    /// `per_steradian`; `u` chooses the distance.
    #[allow(
        clippy::too_many_arguments,
        reason = "a step of an estimator, and memory to work in"
    )]
    fn by_lit_medium<W: Work>(
        &self,
        vertex: &Vertex,
        (light, position): (&Light, DVec3),
        out: &Ray,
        (per_steradian, u): (f64, f64),
        path: &mut MediaPath,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> Option<DVec3> {
        let (foot, angle) = distances(self, out, vertex.point())?;
        let s = angle.place(u);
        let from_light = foot + s;
        let (ray, distance) = vertex.towards_point(out.at(from_light))?;
        let response = vertex.response::<E, W>(&self.media, ray.direction, work);
        if response.value == DVec3::ZERO || from_light == 0.0 {
            return None;
        }
        let end = self
            .nearest(&ray, work)
            .map_or(f64::INFINITY, |(_, hit)| hit.t);
        if distance >= end {
            return None;
        }
        path.lay(&self.media, &ray, end);
        let place = Places::<E>::new(path, &ray, light, position)
            .ok()??
            .at(distance)?;
        let mine = per_steradian * angle.pdf(s) / (from_light * from_light);
        let squared = distance * distance;
        let weight = power_heuristic(mine, response.pdf * place.pdf / squared);
        let radiance = self.scattered_at(&ray, &place, light, tracker, work);
        Some(response.value * radiance * (weight / (mine * squared)))
    }

    /// From the diffuse surface that the ray `out` of the light meets, whose direction has the
    /// density `per_steradian`.
    fn by_lit_surface<W: Work>(
        &self,
        vertex: &Vertex,
        light: &Light,
        out: &Ray,
        per_steradian: f64,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> Option<DVec3> {
        let (Met::Object(index), hit) = self.nearest(out, work)? else {
            return None;
        };
        let Material::Diffuse(reflectance) = self.scene.objects[index].material else {
            return None;
        };
        let (ray, distance) = vertex.towards(&hit.point)?;
        // Light leaves on the side that it arrived on.
        let cosine = -ray.direction.dot(facing(&hit));
        let response = vertex.response::<E, W>(&self.media, ray.direction, work);
        if cosine <= 0.0 || response.value == DVec3::ZERO {
            return None;
        }
        let mut arriving = light.strength_towards(hit.point.position);
        if E::MEDIA {
            arriving *= self.media.transmittance::<E, W>(out, hit.t, tracker, work);
        }
        let density = surface_density_from_light((light, out.origin), ray.origin, &hit.point);
        let weight = power_heuristic(density, response.pdf);
        let visible = self.visibility(&ray, distance, tracker, work);
        // Of irradiance I·cos/r² and density p·cos/r² per area, I/p is left.
        let sent = reflectance / PI * arriving * (cosine / (distance * distance));
        Some(response.value * visible * sent * (weight / per_steradian))
    }
}

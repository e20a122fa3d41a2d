//! The path tracer for surfaces, media and lights, as plainly as it can be written.
//!
//! Radiance `L(x, ω)`, seen from `x` along `ω`, obeys the radiative transfer equation (Chandrasekhar
//! 1950, §I.7), here with a phase function `p` whose integral is 1. With a surface at distance `d`:
//!
//! ```text
//! L(x, ω) = ∫₀ᵈ T(t) [ j + σ_s ∫ p(ω, ω') L(x + tω, ω') dω' ] dt + T(d) L_surface
//! T(t)    = exp(−∫₀ᵗ σ_t ds),  σ_t = σ_a + σ_s
//! ```
//!
//! `j` is the emission per length and `L_surface` what the surface emits and reflects (Kajiya 1986);
//! without a surface `d` is infinite, and `L_surface` the radiance of the environment. Emission and
//! coefficients of media that overlap add up, for each colour channel. The radiance that a random
//! walk from the eye collects has the mean `L`:
//!
//! - Delta tracking finds collisions `tₖ`. Their rate is the majorant `σ̄`, at least `σ_t`
//!   everywhere, so that `Σ f(tₖ)/σ̄` has the mean `∫ f(t) T(t) dt`, with the weights that null
//!   collisions and absorption give a path. A collision either scatters in a medium or is null.
//!   (Kutz et al. 2017, "Spectral and decomposition tracking for rendering heterogeneous volumes".)
//! - Next-event estimation adds the light that arrives straight from the lights, at surfaces and at
//!   every collision, null ones too; ratio tracking estimates its transmittance (Novák et al. 2014,
//!   "Residual ratio tracking for estimating attenuation in participating media").
//! - An area light is hit by chance as well: multiple importance sampling weights both ways (Veach &
//!   Guibas 1995, "Optimally combining sampling techniques for Monte Carlo rendering"). A point
//!   light in a medium is sampled by equal angles along the ray, since `1/r²` at collisions has
//!   infinite variance (Kulla & Fajardo 2012, "Importance sampling techniques for path tracing in
//!   participating media").
//! - Russian roulette ends paths that carry little.
//!
//! A scene limits the bounces of a path, those by mirrors and glass included. Point, spot and
//! directional lights reach a point on straight lines only, never by a mirror or through glass.

use super::media::{Segments, majorant};
use super::random::Random;
use super::vertex::{Scattered, Scatterer, Vertex};
use crate::film::Film;
use crate::geometry::{Emitter, Hit, Ray, Side, Surface};
use crate::math::Moments;
use crate::math::sampling::{Equiangular, free_flight, power_heuristic};
use crate::optics::{Light, Material, Sides, reflected, split};
use crate::render::Sampling;
use crate::scene::{AreaLight, Object, Radiative};
use glam::DVec3;
use rayon::prelude::*;

/// The image of `scene`: mean radiance of paths through each pixel, and the variance of that mean.
/// Paths begin at random points of the pixel, or all in its centre. Fails with the index of a pixel
/// one of whose paths has no end.
pub fn render(
    scene: &Radiative,
    size: [usize; 2],
    sampling: Sampling,
    through_centres: bool,
) -> Result<Film, usize> {
    let (samples, seed) = (sampling.samples_of(scene), sampling.seed_of(scene));
    let majorant = majorant(&scene.media);
    let tracer = PathTracer { scene, majorant };
    let trace = |pixel: usize| {
        let [column, row] = [pixel % size[0], pixel / size[0]];
        let mut moments = [Moments::default(); 3];
        for sample in 0..samples {
            let mut random = Random::new(seed, pixel as u32, sample);
            let [x, y] = if through_centres {
                [0.5; 2]
            } else {
                random.pair()
            };
            let point = [column as f64 + x, row as f64 + y];
            let ray = scene.camera.ray_through(point, size);
            let radiance = tracer.radiance(ray, &mut random).to_array();
            if random.is_exhausted() {
                return Err(pixel);
            }
            for (moments, channel) in moments.iter_mut().zip(radiance) {
                moments.add(channel);
            }
        }
        Ok(moments)
    };
    let pixels = (0..size[0] * size[1]).into_par_iter().map(trace);
    let pixels: Result<Vec<_>, _> = pixels.collect();
    Ok(Film::of_moments(size, &pixels?, samples))
}

struct PathTracer<'s> {
    scene: &'s Radiative,
    /// Rate of collisions `σ̄`, per length, the same everywhere.
    majorant: f64,
}

/// A path under way, from the eye.
struct Path {
    ray: Ray,
    /// Density, per steradian, of the choice of the ray's direction; `None` where there was no
    /// choice: from the eye, a mirror or glass.
    pdf: Option<f64>,
    throughput: DVec3,
    radiance: DVec3,
    may_scatter: bool,
}

/// The object or the light that a ray hits.
enum Target<'s> {
    Object(&'s Object),
    Light(&'s AreaLight),
}

impl<'s> PathTracer<'s> {
    /// Radiance that one path brings back along `ray`.
    fn radiance(&self, ray: Ray, random: &mut Random) -> DVec3 {
        let max_bounces = self.scene.scattering.max_bounces();
        let mut path = Path {
            ray,
            pdf: None,
            throughput: DVec3::ONE,
            radiance: DVec3::ZERO,
            may_scatter: true,
        };
        for bounce in 0..=max_bounces {
            path.may_scatter = bounce < max_bounces;
            let hit = self.hit(&path.ray);
            let end = hit.as_ref().map_or(f64::INFINITY, |(_, hit)| hit.t);
            let segments = Segments::along(&path.ray, end, &self.scene.media);
            if path.may_scatter {
                let light = self.point_lights_along(&path.ray, &segments, random);
                path.radiance += path.throughput * light;
            }
            let next = match (self.collide(&mut path, &segments, random), hit) {
                (Some(collision), _) => collision.sample(random),
                (None, Some((Target::Object(object), hit))) if path.may_scatter => {
                    self.reflect(&mut path, object.material, &hit, random)
                }
                (None, Some((Target::Object(_), _))) => None,
                (None, Some((Target::Light(light), hit))) => {
                    path.radiance += path.throughput * emitted(light, &hit, &path);
                    None
                }
                (None, None) => {
                    path.radiance += path.throughput * self.scene.environment;
                    None
                }
            };
            let Some(Scattered { ray, weight, pdf }) = next else {
                break;
            };
            (path.ray, path.pdf) = (ray, pdf);
            path.throughput *= weight;
            // Russian roulette. A number is drawn in any case, so that no path is endless.
            let survival = path.throughput.max_element().min(1.0);
            if random.is_exhausted() || random.next() >= survival {
                break;
            }
            path.throughput /= survival;
        }
        path.radiance
    }

    /// The nearest surface on `ray`.
    fn hit(&self, ray: &Ray) -> Option<(Target<'s>, Hit)> {
        let objects = self.scene.objects.iter().filter_map(|object| {
            let hit = object.shape.hit(ray, f64::INFINITY)?;
            Some((Target::Object(object), hit))
        });
        let lights = self.scene.area_lights.iter().filter_map(|light| {
            let hit = light.shape.hit(ray, f64::INFINITY)?;
            Some((Target::Light(light), hit))
        });
        objects
            .chain(lights)
            .min_by(|(_, a), (_, b)| a.t.total_cmp(&b.t))
    }

    /// Delta tracking along `segments` of the ray of `path`: the collision that scatters, if one
    /// does. Adds emission and direct light at every collision to the path.
    fn collide(&self, path: &mut Path, segments: &Segments, random: &mut Random) -> Option<Vertex> {
        let span = segments.span();
        let mut t = span.near;
        loop {
            t += free_flight(self.majorant, random.next())?;
            if t.is_nan() || t >= span.far {
                return None;
            }
            // The events that the collision may be, by their rates: scattering in a medium, or null.
            let mut events = Vec::new();
            for medium in segments.at(t) {
                path.radiance += path.throughput * medium.emission / self.majorant;
                let vertex = Vertex::in_medium(&path.ray, t, medium.phase);
                if path.may_scatter && medium.sigma_s != DVec3::ZERO {
                    let light = self.direct_light(&vertex, random);
                    path.radiance += path.throughput * medium.sigma_s * light / self.majorant;
                }
                events.push((medium.sigma_s, Some(vertex)));
            }
            let null = self.majorant - segments.extinction(t);
            events.push((null.max(DVec3::ZERO), None));

            // One of them, with a probability in proportion to throughput times rate, summed over the
            // channels. Absorption is no event: it is in the weight.
            let carried = |rate: DVec3| (path.throughput * rate).element_sum();
            let all: f64 = events.iter().map(|(rate, _)| carried(*rate)).sum();
            let mut left = random.next() * all;
            events.retain(|(rate, _)| carried(*rate) > 0.0);
            let chosen = events.iter().position(|(rate, _)| {
                left -= carried(*rate);
                left < 0.0
            });
            let chosen = chosen.unwrap_or(0); // none by rounding
            let Some((rate, vertex)) = events.into_iter().nth(chosen) else {
                path.throughput = DVec3::ZERO; // no channel goes on
                return None;
            };
            path.throughput *= rate / self.majorant * (all / carried(rate));
            if vertex.is_some() {
                return vertex;
            }
        }
    }

    /// Ratio tracking: an estimate of the transmittance along `ray` up to distance `end`.
    fn transmittance(&self, ray: &Ray, end: f64, random: &mut Random) -> DVec3 {
        let segments = Segments::along(ray, end, &self.scene.media);
        let mut transmittance = DVec3::ONE;
        let span = segments.span();
        let mut t = span.near;
        while let Some(flight) = free_flight(self.majorant, random.next()) {
            t += flight;
            if t.is_nan() || t >= span.far || transmittance == DVec3::ZERO {
                break;
            }
            transmittance *= (1.0 - segments.extinction(t) / self.majorant).max(DVec3::ZERO);
        }
        transmittance
    }

    /// Share of light that passes surfaces and media along `ray` up to distance `end`.
    fn visibility(&self, ray: &Ray, end: f64, random: &mut Random) -> DVec3 {
        let scene = self.scene;
        if scene
            .objects
            .iter()
            .any(|object| object.shape.blocks(ray, end))
            || scene
                .area_lights
                .iter()
                .any(|light| light.shape.blocks(ray, end))
        {
            return DVec3::ZERO;
        }
        self.transmittance(ray, end, random)
    }

    /// Direct light scattered at `vertex`. In a medium, point and spot lights are left to
    /// [`PathTracer::point_lights_along`].
    fn direct_light(&self, vertex: &Vertex, random: &mut Random) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        for light in &self.scene.lights {
            let in_medium = matches!(vertex.scattering, Scatterer::Phase(_));
            if !in_medium || light.position().is_none() {
                radiance += self.light_of(vertex, light, random);
            }
        }
        for light in &self.scene.area_lights {
            let point = light.shape.sample(random.pair());
            let Some((ray, distance)) = vertex.point.towards(&point) else {
                continue;
            };
            let cosine = ray.direction.dot(point.normal);
            if cosine < 0.0 || (cosine > 0.0 && light.sides == Sides::Both) {
                let light_pdf = pdf_of_point(light, distance, cosine);
                let (value, pdf) = vertex.response(ray.direction);
                let weight = power_heuristic(light_pdf, pdf) / light_pdf;
                let visibility = self.visibility(&ray, distance, random);
                radiance += value * light.radiance * visibility * weight;
            }
        }
        radiance
    }

    /// Light of a point, spot or directional light scattered at `vertex`.
    fn light_of(&self, vertex: &Vertex, light: &Light, random: &mut Random) -> DVec3 {
        let connection = match light {
            Light::Point(point) => vertex.point.towards_point(point.position),
            Light::Spot(spot) => vertex.point.towards_point(spot.position),
            Light::Directional(sun) => {
                let ray = vertex.point.leave(-sun.direction);
                ray.map(|ray| (ray, f64::INFINITY))
            }
        };
        let Some((ray, distance)) = connection else {
            return DVec3::ZERO;
        };
        let falloff = light.position().map_or(1.0, |_| distance * distance);
        let irradiance = light.strength_towards(vertex.point.position) / falloff;
        vertex.response(ray.direction).0 * irradiance * self.visibility(&ray, distance, random)
    }

    /// Radiance of point and spot lights scattered once into `ray`, estimated at one point for each
    /// light by equiangular sampling.
    fn point_lights_along(&self, ray: &Ray, segments: &Segments, random: &mut Random) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        let span = segments.span();
        for light in &self.scene.lights {
            let Some(position) = light.position() else {
                continue;
            };
            let foot = (position - ray.origin).dot(ray.direction);
            let distance = (ray.at(foot) - position).length();
            let Ok(angles) = Equiangular::new(distance, span.near - foot, span.far - foot) else {
                return DVec3::INFINITY; // the light lies on the ray, in media
            };
            let from_foot = angles.place(random.next());
            let t = foot + from_foot;
            for medium in segments.at(t) {
                let vertex = Vertex::in_medium(ray, t, medium.phase);
                let scattered = medium.sigma_s * self.light_of(&vertex, light, random);
                let transmittance = self.transmittance(ray, t, random);
                radiance += scattered * transmittance / angles.pdf(from_foot);
            }
        }
        radiance
    }

    /// Reflection of `path` at a surface. Adds direct light to the path.
    fn reflect(
        &self,
        path: &mut Path,
        material: Material,
        hit: &Hit,
        random: &mut Random,
    ) -> Option<Scattered> {
        let outside = hit.side == Side::Front;
        let normal = hit.point.normal * if outside { 1.0 } else { -1.0 };
        let mirrored = reflected(path.ray.direction, normal);
        let (direction, weight) = match material {
            Material::Diffuse(reflectance) => {
                let vertex = Vertex::on_surface(hit, normal, reflectance);
                path.radiance += path.throughput * self.direct_light(&vertex, random);
                return vertex.sample(random);
            }
            Material::Mirror(reflectance) => (mirrored, reflectance),
            Material::Glass(index) => {
                let ratio = if outside { 1.0 / index } else { index };
                let fresnel = split(path.ray.direction, normal, ratio);
                match fresnel.refracted {
                    // L/n² is constant across refraction.
                    Some(refracted) if random.next() >= fresnel.reflectance => {
                        (refracted, DVec3::splat(ratio * ratio))
                    }
                    _ => (mirrored, DVec3::ONE),
                }
            }
        };
        let ray = hit.point.leave(direction)?;
        Some(Scattered {
            ray,
            weight,
            pdf: None,
        })
    }
}

/// Radiance of an area light that the ray of `path` hits, weighted against next-event estimation.
fn emitted(light: &AreaLight, hit: &Hit, path: &Path) -> DVec3 {
    if hit.side == Side::Back && light.sides == Sides::Front {
        return DVec3::ZERO;
    }
    let cosine = path.ray.direction.dot(hit.point.normal);
    let weight = |pdf| power_heuristic(pdf, pdf_of_point(light, hit.t, cosine));
    light.radiance * path.pdf.map_or(1.0, weight)
}

/// Density of the choice of a point on `light`, per steradian, as seen from `distance`.
fn pdf_of_point(light: &AreaLight, distance: f64, cosine: f64) -> f64 {
    light.shape.pdf() * distance * distance / cosine.abs()
}

//! The path tracer for surfaces, media and lights, as plainly as it can be written.
//!
//! Radiance `L(x, ω)`, seen from `x` along `ω`, obeys the radiative transfer equation, here in its
//! integral form (Chandrasekhar 1950, §I.7) and with a phase function `p` whose integral is 1. With a
//! surface at distance `d`:
//!
//! ```text
//! L(x, ω) = ∫₀ᵈ T(t) [ j + σ_s ∫ p(ω, ω') L(x + tω, ω') dω' ] dt + T(d) L_surface
//! T(t)    = exp(−∫₀ᵗ σ_t ds),  σ_t = σ_a + σ_s
//! ```
//!
//! `j` is the emission per length and `L_surface` what the surface emits and reflects (Kajiya 1986);
//! without a surface `d` is infinite, and `L_surface` the radiance of the environment. Emission and
//! coefficients of media that overlap add up, for each colour channel.
//!
//! A path from the eye has a throughput `β` and estimates `L` by a sum over its collisions in media
//! and the surfaces that it meets:
//!
//! ```text
//! L ≈ Σ β (j + σ_s L_direct) / σ̄  +  Σ β L_direct  +  Σ β σ_s T L_point / pdf  +  β L_hit
//!     collisions                     surfaces         media, by point lights      end
//! ```
//!
//! `L_direct` and `L_point` are light from the lights, weighted by the phase function or by BRDF times
//! cosine; `L_hit` is the radiance of an area light or of the environment.
//!
//! - Delta tracking finds collisions at the rate of the majorant `σ̄ > 0`, at least `σ_t` everywhere.
//!   A collision is either a real scattering event or a null collision; absorption
//!   reduces the throughput. (Kutz et al. 2017, "Spectral and decomposition tracking for rendering
//!   heterogeneous volumes".)
//! - Next-event estimation samples the lights for `L_direct`, at surfaces and at every collision, null
//!   ones too; ratio tracking estimates the transmittance (Novák et al. 2014, "Residual ratio
//!   tracking for estimating attenuation in participating media").
//! - A path may also hit an area light: multiple importance sampling combines both estimates (Veach &
//!   Guibas 1995, "Optimally combining sampling techniques for Monte Carlo rendering"). Point and
//!   spot lights in media are sampled at one point of each segment of the ray, by equiangular
//!   sampling: at collisions the factor `1/r²` would give infinite variance (Kulla & Fajardo 2012,
//!   "Importance sampling techniques for path tracing in participating media").
//! - Russian roulette ends paths of low throughput.
//!
//! A scene limits the bounces of a path, including those at mirrors and glass. Point, spot and
//! directional lights reach a point along straight lines only, never via a mirror or through glass.
//! The random numbers of a path are limited, too: one that uses them up is an error.

use super::media::{Segment, extinction, global_majorant, hull};
use super::random::Random;
use super::vertex::{Scattered, Scatterer, Vertex};
use crate::film::Film;
use crate::geometry::{Emitter, Hit, Ray, Side, Surface};
use crate::math::Moments;
use crate::math::sampling::{Equiangular, LightOnRay, free_flight, power_heuristic};
use crate::optics::{Light, Material, Sides, reflected, split};
use crate::scene::{AreaLight, Object, Radiative, Sampling};
use glam::DVec3;
use rayon::prelude::*;

/// The image of `scene`: mean radiance of paths through each pixel, and the variance of that mean.
/// Paths begin at random points of the pixel, or all in its centre. Fails with the index of the first
/// pixel of which a path uses up its random numbers.
pub fn render(
    scene: &Radiative,
    size: [usize; 2],
    sampling: Sampling,
    through_centres: bool,
) -> Result<Film, usize> {
    // The numbers that the caller gives, or else those of the scene.
    let (samples, seed) = (sampling.samples_of(scene), sampling.seed_of(scene));
    let majorant = global_majorant(&scene.media);
    let tracer = PathTracer { scene, majorant };
    let trace = |pixel: usize| {
        let [column, row] = [pixel % size[0], pixel / size[0]];
        let mut moments = [Moments::default(); 3];
        for sample in 0..samples {
            let mut random = Random::new(seed, pixel as u32, sample);
            let drawn = random.pair();
            let [x, y] = if through_centres { [0.5; 2] } else { drawn };
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
    let moments = pixels.collect::<Result<Vec<_>, _>>()?;
    Ok(Film::of_moments(size, &moments, samples))
}

pub(crate) struct PathTracer<'s> {
    pub scene: &'s Radiative,
    /// Rate of collisions `σ̄`, per length, the same everywhere.
    pub majorant: f64,
}

/// A path under way, from the eye.
pub(crate) struct Path {
    pub ray: Ray,
    /// Probability density of the ray's direction, per steradian; `None` from the eye, a mirror or
    /// glass.
    pub pdf: Option<f64>,
    pub throughput: DVec3,
    pub radiance: DVec3,
    /// The limit on bounces allows another.
    pub may_bounce: bool,
}

/// The object or the light that a ray hits.
pub(crate) enum Target<'s> {
    Object(&'s Object),
    Light(&'s AreaLight),
}

impl<'s> PathTracer<'s> {
    /// Radiance that one path brings back along `ray`.
    fn radiance(&self, ray: Ray, random: &mut Random) -> DVec3 {
        let max_bounces = self.scene.scattering.max_bounces().unwrap_or(u32::MAX);
        let mut path = Path {
            ray,
            pdf: None,
            throughput: DVec3::ONE,
            radiance: DVec3::ZERO,
            may_bounce: true,
        };
        for bounce in 0..=max_bounces {
            path.may_bounce = bounce < max_bounces;
            let hit = self.hit(&path.ray);
            let end = hit.as_ref().map_or(f64::INFINITY, |(_, hit)| hit.t);
            let segments = Segment::along(&path.ray, end, &self.scene.media);
            if path.may_bounce {
                let light = self.point_lights_along(&path.ray, &segments, random);
                path.radiance += path.throughput * light;
            }
            let collision = self.track(&mut path, &segments, random);
            if path.throughput == DVec3::ZERO {
                break;
            }
            let next = match (collision, hit) {
                (Some(collision), _) => collision.sample(random),
                (None, Some((Target::Object(object), hit))) if path.may_bounce => {
                    self.scatter_at_surface(&mut path, object.material, &hit, random)
                }
                (None, Some((Target::Object(_), _))) => None,
                (None, Some((Target::Light(light), hit))) => {
                    path.radiance += path.throughput * weighted_emission(light, &hit, &path);
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
            // Russian roulette. It draws a number even if survival is certain, so that an endless path
            // uses up its numbers.
            let survival = path.throughput.max_element().min(1.0);
            if random.next() >= survival {
                break;
            }
            path.throughput /= survival;
        }
        path.radiance
    }

    /// The nearest surface on `ray`.
    pub fn hit(&self, ray: &Ray) -> Option<(Target<'s>, Hit)> {
        let far = f64::INFINITY;
        let objects = self.scene.objects.iter();
        let objects = objects.filter_map(|it| Some((Target::Object(it), it.shape.hit(ray, far)?)));
        let lights = self.scene.area_lights.iter();
        let lights = lights.filter_map(|it| Some((Target::Light(it), it.shape.hit(ray, far)?)));
        let targets = objects.chain(lights);
        targets.min_by(|(_, a), (_, b)| a.t.total_cmp(&b.t))
    }

    /// Delta tracking along `segments` of the ray of `path`: the vertex where it scatters; `None` if it
    /// leaves the media, or is absorbed (throughput 0). Updates the throughput; adds emission and
    /// direct light at every collision.
    fn track(&self, path: &mut Path, segments: &[Segment], random: &mut Random) -> Option<Vertex> {
        let span = hull(segments)?;
        let mut t = span.near;
        loop {
            t += free_flight(self.majorant, random.next());
            if t >= span.far {
                return None;
            }
            // The events that the collision may be, by their rates: null, or scattering in a medium.
            let null = self.majorant - extinction(segments, t);
            let mut events = vec![(null.max(DVec3::ZERO), None)]; // below 0 by rounding only
            for medium in segments.iter().filter_map(|segment| segment.at(t)) {
                path.radiance += path.throughput * medium.emission / self.majorant;
                let vertex = Vertex::in_medium(&path.ray, t, medium.phase);
                if path.may_bounce && medium.sigma_s != DVec3::ZERO {
                    let light = self.direct_light(&vertex, random);
                    path.radiance += path.throughput * medium.sigma_s * light / self.majorant;
                }
                events.push((medium.sigma_s, Some(vertex)));
            }

            // One of them, with a probability in proportion to throughput times rate, summed over the
            // channels.
            let weight = |(rate, _): &(DVec3, _)| (path.throughput * *rate).element_sum();
            let weights: Vec<f64> = events.iter().map(weight).collect();
            let total: f64 = weights.iter().sum();
            let Some(index) = pick(&weights, random.next() * total) else {
                path.throughput = DVec3::ZERO; // every channel is absorbed
                return None;
            };
            let (rate, vertex) = events.swap_remove(index);
            path.throughput = path.throughput * rate / self.majorant * (total / weights[index]);
            if vertex.is_some() {
                return vertex;
            }
        }
    }

    /// Ratio tracking: an estimate of the transmittance along `ray` up to distance `end`.
    pub fn transmittance(&self, ray: &Ray, end: f64, random: &mut Random) -> DVec3 {
        let segments = Segment::along(ray, end, &self.scene.media);
        let mut transmittance = DVec3::ONE;
        let Some(span) = hull(&segments) else {
            return transmittance;
        };
        let mut t = span.near;
        loop {
            t += free_flight(self.majorant, random.next());
            if t >= span.far || transmittance == DVec3::ZERO {
                return transmittance;
            }
            // Below 0 by rounding only.
            transmittance *= (1.0 - extinction(&segments, t) / self.majorant).max(DVec3::ZERO);
        }
    }

    /// Transmittance along `ray` up to distance `end`; 0 if a surface blocks it.
    fn visibility(&self, ray: &Ray, end: f64, random: &mut Random) -> DVec3 {
        let (objects, lights) = (&self.scene.objects, &self.scene.area_lights);
        let behind_object = objects.iter().any(|it| it.shape.blocks(ray, end));
        let behind_light = lights.iter().any(|it| it.shape.blocks(ray, end));
        if behind_object || behind_light {
            return DVec3::ZERO;
        }
        self.transmittance(ray, end, random)
    }

    /// Direct light scattered at `vertex`. In a medium, point and spot lights are left to
    /// [`PathTracer::point_lights_along`].
    fn direct_light(&self, vertex: &Vertex, random: &mut Random) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        for light in &self.scene.lights {
            if light.position().is_none() || matches!(vertex.scattering, Scatterer::Diffuse(_)) {
                radiance += self.delta_light(vertex, light, random);
            }
        }
        for light in &self.scene.area_lights {
            let on_light = light.shape.sample(random.pair());
            let Some((ray, distance)) = vertex.point.towards_surface(&on_light) else {
                continue;
            };
            let cosine = ray.direction.cosine_to(on_light.normal);
            if cosine < 0.0 || (cosine > 0.0 && light.sides == Sides::Both) {
                let light_pdf = pdf_of_point(light, distance, cosine);
                let (value, pdf) = vertex.evaluate(ray.direction);
                let weight = power_heuristic(light_pdf, pdf) / light_pdf;
                let visibility = self.visibility(&ray, distance, random);
                radiance += value * light.radiance * visibility * weight;
            }
        }
        radiance
    }

    /// Light of a point, spot or directional light scattered at `vertex`.
    fn delta_light(&self, vertex: &Vertex, light: &Light, random: &mut Random) -> DVec3 {
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
        // Point and spot lights have an intensity, directional ones an irradiance.
        let squared = light.position().map_or(1.0, |_| distance * distance);
        let irradiance = light.strength_towards(vertex.point.position) / squared;
        let visibility = self.visibility(&ray, distance, random);
        vertex.evaluate(ray.direction).0 * irradiance * visibility
    }

    /// Radiance of point and spot lights scattered once into `ray`, estimated at one point of each
    /// segment by equiangular sampling.
    fn point_lights_along(&self, ray: &Ray, segments: &[Segment], random: &mut Random) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        for light in &self.scene.lights {
            let Some(position) = light.position() else {
                continue;
            };
            let foot = (position - ray.origin).dot(*ray.direction);
            let distance = (ray.at(foot) - position).length();
            for segment in segments.iter().filter(|segment| segment.scatters()) {
                let [near, far] = [segment.span.near, segment.span.far];
                let shines = |t: f64| light.strength_towards(ray.at(t)) != DVec3::ZERO;
                let angles = match Equiangular::new(distance, near - foot, far - foot) {
                    Ok(angles) => angles,
                    // On the segment the integral of 1/r² diverges.
                    Err(LightOnRay) if shines(near) || shines(far) => return DVec3::INFINITY,
                    Err(LightOnRay) => continue,
                };
                let from_foot = angles.sample(random.next());
                let t = foot + from_foot;
                if let Some(medium) = segment.at(t) {
                    let vertex = Vertex::in_medium(ray, t, medium.phase);
                    let direct = self.delta_light(&vertex, light, random);
                    let transmittance = self.transmittance(ray, t, random);
                    radiance += medium.sigma_s * direct * transmittance / angles.pdf(from_foot);
                }
            }
        }
        radiance
    }

    /// Scattering of `path` at a surface. Adds direct light to the path.
    pub fn scatter_at_surface(
        &self,
        path: &mut Path,
        material: Material,
        hit: &Hit,
        random: &mut Random,
    ) -> Option<Scattered> {
        let outside = hit.side == Side::Front;
        let outward = hit.point.normal;
        let normal = if outside { outward } else { -outward };
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
                let scale = DVec3::splat(ratio * ratio); // L/n² is constant across refraction
                match fresnel.refracted {
                    Some(refracted) if random.next() >= fresnel.reflectance => (refracted, scale),
                    _ => (mirrored, DVec3::ONE),
                }
            }
        };
        let ray = hit.point.leave(direction)?; // `None` only if rounding leaves no direction
        Some(Scattered {
            ray,
            weight,
            pdf: None,
        })
    }
}

/// Index of the weight that `left`, from 0 up to the sum of all, falls on; `None` if all are 0.
pub(crate) fn pick(weights: &[f64], mut left: f64) -> Option<usize> {
    let mut picked = None;
    for (index, &weight) in weights.iter().enumerate() {
        if weight > 0.0 && left >= 0.0 {
            picked = Some(index); // the last, if roundings leave a rest
            left -= weight;
        }
    }
    picked
}

/// Radiance of an area light that the ray of `path` hits, weighted against next-event estimation.
fn weighted_emission(light: &AreaLight, hit: &Hit, path: &Path) -> DVec3 {
    if hit.side == Side::Back && light.sides == Sides::Front {
        return DVec3::ZERO;
    }
    let cosine = path.ray.direction.cosine_to(hit.point.normal);
    let weight = |pdf| power_heuristic(pdf, pdf_of_point(light, hit.t, cosine));
    light.radiance * path.pdf.map_or(1.0, weight)
}

/// Probability density of a point sampled on `light`, per steradian, as seen from `distance`.
pub(crate) fn pdf_of_point(light: &AreaLight, distance: f64, cosine: f64) -> f64 {
    light.shape.pdf() * distance * distance / cosine.abs()
}

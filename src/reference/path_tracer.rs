//! The path tracer for surfaces, media and lights, as plainly as it can be written.
//!
//! Radiance along a ray obeys the radiative transfer equation (Chandrasekhar 1950, §I.7). Over a
//! ray from `x` into direction `ω`, up to a surface at distance `d`:
//!
//! ```text
//! L(x, ω) = ∫₀ᵈ T(t) [ j + σ_s ∫ p(ω, ω') L(x + tω, ω') dω' ] dt + T(d) L_surface
//! T(t)    = exp(−∫₀ᵗ σ_t ds),  σ_t = σ_a + σ_s
//! ```
//!
//! with emission `j`, phase function `p`, and at the surface the rendering equation (Kajiya 1986).
//! A path is a random walk backwards from the eye, whose mean is `L`:
//!
//! - Delta tracking finds collisions. Their rate is the majorant `σ̄`, at least `σ_t` everywhere; a
//!   collision scatters in a medium, or is null and changes nothing. Weights carry absorption and
//!   the differences between colour channels (Kutz et al. 2017, "Spectral and decomposition
//!   tracking for rendering heterogeneous volumes").
//! - Next-event estimation adds the light that arrives straight from a light, at surfaces and at
//!   every collision; ratio tracking estimates its transmittance (Novák et al. 2014, "Residual
//!   ratio tracking for estimating attenuation in participating media").
//! - An area light is found by chance as well: multiple importance sampling weights both ways
//!   (Veach & Guibas 1995). A point light in a medium is sampled by equal angles along the ray,
//!   since `1/r²` at collisions has no variance (Kulla & Fajardo 2012).
//! - Russian roulette ends paths that carry little.

use super::random::Random;
use crate::film::Film;
use crate::geometry::{Emitter, Hit, Ray, Side, Solid, Span, Surface, SurfacePoint};
use crate::math::sampling::{
    Equiangular, cosine_hemisphere, cosine_hemisphere_pdf, free_flight, power_heuristic,
};
use crate::math::{Frame, Moments, cos, sin};
use crate::media::{Deflection, HenyeyGreenstein};
use crate::optics::{Directional, Light, Material, Point, Sides, Spot, reflected, split};
use crate::scene::{AreaLight, Body, Object, Radiative, Scattering};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The image of `scene`: mean radiance of `samples` paths through each pixel, at least two, and the
/// variance of that mean.
pub fn render(scene: &Radiative, size: [usize; 2], samples: u32, seed: u64) -> Film {
    let tracer = PathTracer::new(scene);
    let [width, height] = size;
    let pixels: Vec<[Moments; 3]> = (0..width * height)
        .into_par_iter()
        .map(|index| {
            let [column, row] = [(index % width) as f64, (index / width) as f64];
            let mut moments = [Moments::default(); 3];
            for sample in 0..samples {
                let mut random = Random::new(seed, index as u32, sample);
                let point = [column + random.next(), row + random.next()];
                let ray = scene.camera.ray_through(point, size);
                let radiance = tracer.radiance(ray, &mut random);
                for channel in 0..3 {
                    moments[channel].add(radiance[channel]);
                }
            }
            moments
        })
        .collect();
    let variance = |moments: Moments| moments.variance_of_mean().unwrap_or(0.0) as f32;
    let means = pixels
        .iter()
        .map(|pixel| pixel.map(|channel| channel.mean() as f32));
    let variances = pixels.iter().map(|pixel| pixel.map(variance));
    Film::with_noise(width, height, means.collect(), variances.collect(), samples)
}

struct PathTracer<'s> {
    scene: &'s Radiative,
    /// Scattering events of a path, at most.
    limit: u32,
    /// Rate of collisions, per length: at least the extinction, everywhere and in every channel.
    majorant: f64,
}

/// A path under way, from the eye.
struct Path {
    ray: Ray,
    /// Density, per steradian, of the choice of the ray's direction. None from the eye, a mirror or
    /// glass, which leave no choice.
    direction_pdf: Option<f64>,
    throughput: DVec3,
    radiance: DVec3,
}

/// The part of a ray inside a medium.
struct Segment<'s> {
    medium: &'s Body,
    span: Span,
}

/// What a ray hits.
enum Target<'s> {
    Object(&'s Object),
    Light(&'s AreaLight),
}

/// Where a path scatters into a range of directions.
#[derive(Clone, Copy)]
struct Vertex {
    /// Point of a surface; in a medium a point without normal and clearance.
    point: SurfacePoint,
    /// Unit axis of the directions: the normal on the side of the ray that arrives, in a medium the
    /// direction of that ray.
    axis: DVec3,
    scattering: Scatterer,
}

#[derive(Clone, Copy)]
enum Scatterer {
    Phase(HenyeyGreenstein),
    /// Reflectance by channel.
    Diffuse(DVec3),
}

impl<'s> PathTracer<'s> {
    fn new(scene: &'s Radiative) -> PathTracer<'s> {
        let limit = match scene.scattering {
            Scattering::None => 0,
            Scattering::Single => 1,
            Scattering::Multiple(limit) => limit.unwrap_or(u32::MAX),
        };
        let mut majorant = 0.0;
        for body in &scene.media {
            let density = body.density.as_ref().map_or(1.0, |d| d.range().high);
            let extinction = body.medium.coefficients.sigma_t().max_element() * density;
            // About one collision per crossing in thin media, too: light is collected there.
            let size = body
                .boundary
                .as_ref()
                .map(|shape| shape.bounds().size().max_element());
            majorant += extinction.max(size.map_or(0.0, |size| 1.0 / size));
        }
        PathTracer {
            scene,
            limit,
            majorant,
        }
    }

    /// Radiance that one path brings back along `ray`.
    fn radiance(&self, ray: Ray, random: &mut Random) -> DVec3 {
        let mut path = Path {
            ray,
            direction_pdf: None,
            throughput: DVec3::ONE,
            radiance: DVec3::ZERO,
        };
        for bounce in 0..=self.limit {
            let may_scatter = bounce < self.limit;
            let hit = self.intersect(&path.ray);
            let end = hit.as_ref().map_or(f64::INFINITY, |(_, hit)| hit.t);
            let segments = self.segments(&path.ray, end);
            if may_scatter {
                let light = self.point_lights_along(&path.ray, &segments, random);
                path.radiance += path.throughput * light;
            }

            let scattered = match (self.collide(&mut path, &segments, may_scatter, random), hit) {
                (Some(collision), _) => self.scatter(&mut path, &collision, random),
                (None, None) => {
                    path.radiance += path.throughput * self.scene.environment;
                    false
                }
                (None, Some((Target::Light(light), hit))) => {
                    path.radiance += path.throughput * self.emitted(&path, light, &hit);
                    false
                }
                (None, Some((Target::Object(object), hit))) => {
                    may_scatter && self.reflect(&mut path, object.material, &hit, random)
                }
            };
            if !scattered || !may_scatter {
                break;
            }
            // Russian roulette.
            let survival = path.throughput.max_element().min(1.0);
            if random.next() >= survival {
                break;
            }
            path.throughput /= survival;
        }
        path.radiance
    }

    /// The nearest surface on `ray`.
    fn intersect(&self, ray: &Ray) -> Option<(Target<'s>, Hit)> {
        let mut nearest = f64::INFINITY;
        let mut found = None;
        for object in &self.scene.objects {
            if let Some(hit) = object.shape.hit(ray, nearest) {
                nearest = hit.t;
                found = Some((Target::Object(object), hit));
            }
        }
        for light in &self.scene.area_lights {
            if let Some(hit) = light.shape.hit(ray, nearest) {
                nearest = hit.t;
                found = Some((Target::Light(light), hit));
            }
        }
        found
    }

    /// The parts of `ray` inside media, up to distance `end`.
    fn segments(&self, ray: &Ray, end: f64) -> Vec<Segment<'s>> {
        let everywhere = Span {
            near: 0.0,
            far: end,
        };
        let mut segments = Vec::new();
        for medium in &self.scene.media {
            let boundary = medium.boundary.as_ref();
            for mut span in boundary.map_or(vec![everywhere], |boundary| boundary.spans(ray)) {
                span.far = span.far.min(end);
                if span.near < span.far {
                    segments.push(Segment { medium, span });
                }
            }
        }
        segments
    }

    /// Delta tracking along the ray of `path`: the collision that scatters, if there is one before
    /// the end. Collects emission and the light of lights at every collision.
    fn collide(
        &self,
        path: &mut Path,
        segments: &[Segment<'_>],
        may_scatter: bool,
        random: &mut Random,
    ) -> Option<Vertex> {
        let hull = hull(segments)?;
        let mut t = hull.near;
        loop {
            t += free_flight(self.majorant, random.next())?;
            if t >= hull.far {
                return None;
            }
            let point = path.ray.at(t);
            // Every event that the collision may be, with its rate; first the null collision.
            let mut events = vec![(DVec3::splat(self.majorant), None)];
            for Segment { medium, .. } in segments.iter().filter(|s| s.contains(t)) {
                let density = density(medium, point);
                let coefficients = medium.medium.coefficients;
                events[0].0 -= coefficients.sigma_t() * density;
                let emission = medium.medium.emission * density;
                path.radiance += path.throughput * emission / self.majorant;
                let sigma_s = coefficients.sigma_s() * density;
                if sigma_s != DVec3::ZERO {
                    let vertex = Vertex::in_medium(&path.ray, t, medium);
                    if may_scatter {
                        let light = self.direct_light(&vertex, random);
                        path.radiance += path.throughput * sigma_s * light / self.majorant;
                    }
                    events.push((sigma_s, Some(vertex)));
                }
            }
            events[0].0 = events[0].0.max(DVec3::ZERO); // rounding
            let carried = |rate: DVec3| (path.throughput * rate).element_sum();
            let total: f64 = events.iter().map(|(rate, _)| carried(*rate)).sum();
            if total == 0.0 {
                path.throughput = DVec3::ZERO; // absorbed
                return None;
            }
            let mut left = random.next() * total;
            let (rate, vertex) = events.into_iter().find(|(rate, _)| {
                left -= carried(*rate);
                left < 0.0
            })?;
            let probability = carried(rate) / total;
            path.throughput *= rate / (self.majorant * probability);
            if vertex.is_some() {
                return vertex;
            }
        }
    }

    /// Ratio tracking: an estimate of the transmittance of `ray` up to distance `end`.
    fn transmittance(&self, ray: &Ray, end: f64, random: &mut Random) -> DVec3 {
        let segments = self.segments(ray, end);
        let mut transmittance = DVec3::ONE;
        let Some(hull) = hull(&segments) else {
            return transmittance;
        };
        let mut t = hull.near;
        while let Some(flight) = free_flight(self.majorant, random.next()) {
            t += flight;
            if t >= hull.far || transmittance == DVec3::ZERO {
                break;
            }
            let mut sigma_t = DVec3::ZERO;
            for Segment { medium, .. } in segments.iter().filter(|s| s.contains(t)) {
                sigma_t += medium.medium.coefficients.sigma_t() * density(medium, ray.at(t));
            }
            transmittance *= (1.0 - sigma_t / self.majorant).max(DVec3::ZERO);
        }
        transmittance
    }

    /// Share of light that passes between the origin of `ray` and distance `end`.
    fn visibility(&self, ray: &Ray, end: f64, random: &mut Random) -> DVec3 {
        let blocked = self
            .scene
            .objects
            .iter()
            .any(|object| object.shape.blocks(ray, end))
            || self
                .scene
                .area_lights
                .iter()
                .any(|light| light.shape.blocks(ray, end));
        if blocked {
            return DVec3::ZERO;
        }
        self.transmittance(ray, end, random)
    }

    /// Radiance scattered at `vertex` of the light that arrives straight from all lights, but for
    /// point lights in a medium.
    fn direct_light(&self, vertex: &Vertex, random: &mut Random) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        for light in &self.scene.lights {
            let in_medium = matches!(vertex.scattering, Scatterer::Phase(_));
            if !(in_medium && light.position().is_some()) {
                radiance += self.light(vertex, light, random);
            }
        }
        for light in &self.scene.area_lights {
            let point = light.shape.sample([random.next(), random.next()]);
            let Some((ray, distance)) = vertex.point.towards(&point) else {
                continue;
            };
            if light.sides == Sides::Front && ray.direction.dot(point.normal) >= 0.0 {
                continue;
            }
            let (value, pdf) = vertex.response(ray.direction);
            let light_pdf = light_pdf(light, distance, ray.direction.dot(point.normal));
            if value != DVec3::ZERO && light_pdf.is_finite() {
                let weight = power_heuristic(light_pdf, pdf);
                let visibility = self.visibility(&ray, distance, random);
                radiance += value * light.radiance * visibility * (weight / light_pdf);
            }
        }
        radiance
    }

    /// Radiance scattered at `vertex` of the light of a point, spot or directional light.
    fn light(&self, vertex: &Vertex, light: &Light, random: &mut Random) -> DVec3 {
        let connection = match light {
            Light::Directional(Directional { direction, .. }) => vertex
                .point
                .leave(-direction)
                .map(|ray| (ray, f64::INFINITY)),
            Light::Point(Point { position, .. }) | Light::Spot(Spot { position, .. }) => {
                vertex.point.towards_point(*position)
            }
        };
        let Some((ray, distance)) = connection else {
            return DVec3::ZERO;
        };
        let falloff = if distance.is_finite() {
            distance * distance
        } else {
            1.0
        };
        let irradiance = light.strength_towards(vertex.point.position) / falloff;
        let (value, _) = vertex.response(ray.direction);
        if value * irradiance == DVec3::ZERO {
            return DVec3::ZERO;
        }
        value * irradiance * self.visibility(&ray, distance, random)
    }

    /// Light of point and spot lights scattered once into `ray`: one point for each light, chosen
    /// by equal angles as seen from it.
    fn point_lights_along(
        &self,
        ray: &Ray,
        segments: &[Segment<'_>],
        random: &mut Random,
    ) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        let Some(hull) = hull(segments) else {
            return radiance;
        };
        for light in &self.scene.lights {
            let Some(position) = light.position() else {
                continue;
            };
            let foot = (position - ray.origin).dot(ray.direction);
            let distance = (ray.at(foot) - position).length();
            let Ok(angles) = Equiangular::new(distance, hull.near - foot, hull.far - foot) else {
                return DVec3::INFINITY; // the light lies on the ray
            };
            let from_foot = angles.place(random.next());
            let t = foot + from_foot;
            for Segment { medium, .. } in segments.iter().filter(|s| s.contains(t)) {
                let sigma_s = medium.medium.coefficients.sigma_s() * density(medium, ray.at(t));
                let light = self.light(&Vertex::in_medium(ray, t, medium), light, random);
                if sigma_s * light != DVec3::ZERO {
                    let transmittance = self.transmittance(ray, t, random);
                    radiance += sigma_s * light * transmittance / angles.pdf(from_foot);
                }
            }
        }
        radiance
    }

    /// Radiance of an area light that the ray of `path` hits, weighted against next-event
    /// estimation.
    fn emitted(&self, path: &Path, light: &AreaLight, hit: &Hit) -> DVec3 {
        if light.sides == Sides::Front && hit.side == Side::Back {
            return DVec3::ZERO;
        }
        let cosine = path.ray.direction.dot(hit.point.normal);
        let weight = |pdf| power_heuristic(pdf, light_pdf(light, hit.t, cosine));
        light.radiance * path.direction_pdf.map_or(1.0, weight)
    }

    /// Continues `path` from `vertex` into a random direction; false where there is none.
    fn scatter(&self, path: &mut Path, vertex: &Vertex, random: &mut Random) -> bool {
        let numbers = [random.next(), random.next()];
        let local = match vertex.scattering {
            Scatterer::Phase(phase) => {
                let deflection = phase.deflection(numbers[0]);
                let (azimuth, sine) = (TAU * numbers[1], deflection.sin());
                DVec3::new(sine * cos(azimuth), sine * sin(azimuth), deflection.cos)
            }
            Scatterer::Diffuse(reflectance) => {
                path.throughput *= reflectance;
                cosine_hemisphere(numbers)
            }
        };
        let direction = Frame::around(vertex.axis).to_world(local);
        let Some(ray) = vertex.point.leave(direction) else {
            return false;
        };
        path.direction_pdf = Some(vertex.response(ray.direction).1);
        path.ray = ray;
        true
    }

    /// Continues `path` from a surface that it hit; false where it ends there.
    fn reflect(&self, path: &mut Path, material: Material, hit: &Hit, random: &mut Random) -> bool {
        let outside = hit.side == Side::Front;
        let normal = if outside {
            hit.point.normal
        } else {
            -hit.point.normal
        };
        let mut direction = reflected(path.ray.direction, normal);
        match material {
            Material::Diffuse(reflectance) => {
                let vertex = Vertex {
                    point: hit.point,
                    axis: normal,
                    scattering: Scatterer::Diffuse(reflectance),
                };
                path.radiance += path.throughput * self.direct_light(&vertex, random);
                return self.scatter(path, &vertex, random);
            }
            Material::Mirror(reflectance) => path.throughput *= reflectance,
            Material::Glass(index) => {
                let ratio = if outside { 1.0 / index } else { index };
                let split = split(path.ray.direction, normal, ratio);
                if let Some(refracted) = split.refracted
                    && random.next() >= split.reflectance
                {
                    direction = refracted;
                    // Refraction changes the solid angle of a beam, and radiance with it.
                    path.throughput *= ratio * ratio;
                }
            }
        }
        let Some(ray) = hit.point.leave(direction) else {
            return false;
        };
        path.direction_pdf = None;
        path.ray = ray;
        true
    }
}

impl Segment<'_> {
    fn contains(&self, t: f64) -> bool {
        self.span.near <= t && t < self.span.far
    }
}

impl Vertex {
    /// A collision at distance `t` of `ray`.
    fn in_medium(ray: &Ray, t: f64, medium: &Body) -> Vertex {
        let point = SurfacePoint {
            position: ray.at(t),
            normal: DVec3::ZERO,
            clearance: 0.0,
        };
        let scattering = Scatterer::Phase(medium.medium.phase);
        Vertex {
            point,
            axis: ray.direction,
            scattering,
        }
    }

    /// Radiance scattered back for a unit of radiance from `direction`, per steradian, and the
    /// density with which [`PathTracer::scatter`] chooses that direction.
    fn response(&self, direction: DVec3) -> (DVec3, f64) {
        let cosine = self.axis.dot(direction).clamp(-1.0, 1.0);
        match self.scattering {
            Scatterer::Phase(phase) => {
                let value = phase.per_steradian(&Deflection::from_cos(cosine));
                (DVec3::splat(value), value)
            }
            Scatterer::Diffuse(reflectance) => {
                let pdf = cosine_hemisphere_pdf(cosine);
                (reflectance * pdf, pdf)
            }
        }
    }
}

/// From the beginning of the first segment to the end of the last.
fn hull(segments: &[Segment<'_>]) -> Option<Span> {
    let near = segments.iter().map(|s| s.span.near).reduce(f64::min)?;
    let far = segments.iter().map(|s| s.span.far).reduce(f64::max)?;
    Some(Span { near, far })
}

/// Density of a medium at a world point, a factor on its coefficients and emission.
fn density(medium: &Body, point: DVec3) -> f64 {
    let density = medium.density.as_ref();
    density.map_or(1.0, |field| field.looked_up_at(point, &mut 0))
}

/// Density of a uniform point of `light`, per steradian, as seen from `distance` under `cosine`.
fn light_pdf(light: &AreaLight, distance: f64, cosine: f64) -> f64 {
    light.shape.pdf() * distance * distance / cosine.abs()
}

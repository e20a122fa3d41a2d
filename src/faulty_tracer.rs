//! The plain path tracer's double, which makes mistakes.
//!
//! The loops of [`reference::path_tracer`](crate::reference::path_tracer), to be read first, with a switch
//! at each place where path tracers go wrong: [`TransportFault`]. What no mistake touches is that tracer's own. Images of
//! a mistake show what it looks like, so that it can be named; the reference has no switches. Without a fault both give
//! the same bits
//! (`tests/library/reference.rs`).

use crate::geometry::{Direction, Emitter, Hit, Ray, Side, Solid, Surface};
use crate::math::Moments;
use crate::math::sampling::{Equiangular, LightOnRay, free_flight, power_heuristic};
use crate::optics::{Light, Material, Sides};
use crate::reference::media::{Segment, extinction, global_majorant, hull};
use crate::reference::path_tracer::{Path, PathTracer, Target, pdf_of_point, pick};
use crate::reference::random::Random;
use crate::reference::vertex::{Scattered, Scatterer, Vertex};
use crate::scene::{AreaLight, Body, Radiative, TransportFault};
use glam::DVec3;

/// Distance from the ends of a shadow ray within which bounds of media do not block it, over the size of
/// the medium.
const AT_THE_END: f64 = 1e-6;

/// The plain path tracer with a mistake, or with none.
pub struct FaultyTracer<'s> {
    plain: PathTracer<'s>,
    fault: Option<TransportFault>,
}

/// A path that uses up its random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndlessPath;

impl<'s> FaultyTracer<'s> {
    /// A tracer of paths through `scene` with `fault`.
    pub fn new(scene: &'s Radiative, fault: Option<TransportFault>) -> FaultyTracer<'s> {
        let majorant = global_majorant(&scene.media);
        let plain = PathTracer { scene, majorant };
        FaultyTracer { plain, fault }
    }

    /// The moments, by channel, of that many paths through the pixel at [column, row] of an image of this
    /// size, or through a block of `edge` × `edge` pixels that begins there.
    pub fn pixel(
        &self,
        [column, row]: [usize; 2],
        size: [usize; 2],
        edge: f64,
        (seed, samples): (u64, u32),
    ) -> Result<[Moments; 3], EndlessPath> {
        let mut moments = [Moments::default(); 3];
        for sample in 0..samples {
            let mut random = Random::new(seed, (row * size[0] + column) as u32, sample);
            let [x, y] = random.pair();
            let point = [column as f64 + edge * x, row as f64 + edge * y];
            let ray = self.plain.scene.camera.ray_through(point, size);
            let radiance = self.radiance(ray, &mut random).to_array();
            if random.is_exhausted() {
                return Err(EndlessPath);
            }
            for (moments, channel) in moments.iter_mut().zip(radiance) {
                moments.add(channel);
            }
        }
        Ok(moments)
    }

    /// The mistake is this one.
    fn has(&self, fault: TransportFault) -> bool {
        self.fault == Some(fault)
    }

    /// Radiance that one path brings back along `ray`.
    fn radiance(&self, ray: Ray, random: &mut Random) -> DVec3 {
        let scene = self.plain.scene;
        let max_bounces = scene.scattering.max_bounces().unwrap_or(u32::MAX);
        let mut path = Path {
            ray,
            pdf: None,
            throughput: DVec3::ONE,
            radiance: DVec3::ZERO,
            may_bounce: true,
        };
        for bounce in 0..=max_bounces {
            path.may_bounce = bounce < max_bounces;
            let hit = self.plain.hit(&path.ray);
            let end = hit.as_ref().map_or(f64::INFINITY, |(_, hit)| hit.t);
            let segments = Segment::along(&path.ray, end, &scene.media);
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
                    path.radiance += path.throughput * self.emission(light, &hit, &path);
                    None
                }
                (None, None) => {
                    path.radiance += path.throughput * scene.environment;
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
            if !self.has(TransportFault::RouletteUncompensated) {
                path.throughput /= survival;
            }
        }
        path.radiance
    }

    /// Delta tracking along `segments` of the ray of `path`: the vertex where it scatters; `None` if it
    /// leaves the media, or is absorbed (throughput 0). Updates the throughput; adds emission and
    /// direct light at every collision.
    fn track(&self, path: &mut Path, segments: &[Segment], random: &mut Random) -> Option<Vertex> {
        let span = hull(segments)?;
        let mut t = span.near;
        loop {
            t += free_flight(self.plain.majorant, random.next());
            if t >= span.far {
                return None;
            }
            // The events that the collision may be, by their rates: null, or scattering in a medium.
            let null = self.plain.majorant - extinction(segments, t);
            let mut events = vec![(null.max(DVec3::ZERO), None)]; // below 0 by rounding only
            for medium in segments.iter().filter_map(|segment| segment.at(t)) {
                path.radiance += path.throughput * medium.emission / self.plain.majorant;
                let vertex = Vertex::in_medium(&path.ray, t, medium.phase);
                if path.may_bounce && medium.sigma_s != DVec3::ZERO {
                    let light = self.direct_light(&vertex, random);
                    let rate = self.rate_of_direct_light(medium.sigma_t, medium.sigma_s);
                    path.radiance += path.throughput * rate * light / self.plain.majorant;
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
            if vertex.is_none() && self.has(TransportFault::NullCollisionsUnweighted) {
                continue;
            }
            path.throughput =
                path.throughput * rate / self.plain.majorant * (total / weights[index]);
            if vertex.is_some() {
                return vertex;
            }
        }
    }

    /// Transmittance along `ray` up to distance `end`; 0 if a surface blocks it.
    fn visibility(&self, ray: &Ray, end: f64, random: &mut Random) -> DVec3 {
        let (objects, lights) = (&self.plain.scene.objects, &self.plain.scene.area_lights);
        let behind_object = objects.iter().any(|it| it.shape.blocks(ray, end));
        let behind_light = lights.iter().any(|it| it.shape.blocks(ray, end));
        if behind_object || behind_light {
            return DVec3::ZERO;
        }
        if self.has(TransportFault::BoundsBlockLight)
            && crosses_bounds(ray, end, &self.plain.scene.media)
        {
            return DVec3::ZERO;
        }
        if self.has(TransportFault::ShadowRaysUnattenuated) {
            return DVec3::ONE;
        }
        self.plain.transmittance(ray, end, random)
    }

    /// Direct light scattered at `vertex`. In a medium, point and spot lights are left to
    /// [`FaultyTracer::point_lights_along`].
    fn direct_light(&self, vertex: &Vertex, random: &mut Random) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        for light in &self.plain.scene.lights {
            if light.position().is_none() || matches!(vertex.scattering, Scatterer::Diffuse(_)) {
                radiance += self.delta_light(vertex, light, random);
            }
        }
        for light in &self.plain.scene.area_lights {
            let on_light = light.shape.sample(random.pair());
            let Some((ray, distance)) = vertex.point.towards_surface(&on_light) else {
                continue;
            };
            let cosine = ray.direction.cosine_to(on_light.normal);
            if cosine < 0.0 || (cosine > 0.0 && light.sides == Sides::Both) {
                let light_pdf = pdf_of_point(light, distance, cosine);
                let (value, pdf) = self.evaluated(vertex, ray.direction);
                let weight = if self.has(TransportFault::LightsCountedTwice)
                    || self.has(TransportFault::SamplesUnweighted)
                {
                    1.0 / light_pdf
                } else {
                    power_heuristic(light_pdf, pdf) / light_pdf
                };
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
        self.evaluated(vertex, ray.direction).0 * irradiance * visibility
    }

    /// The phase function, or the BRDF times the cosine, for light from `direction`, and the density there.
    fn evaluated(&self, vertex: &Vertex, direction: Direction) -> (DVec3, f64) {
        let is_medium = matches!(vertex.scattering, Scatterer::Phase(_));
        if is_medium && self.has(TransportFault::PhaseReversedForLights) {
            return vertex.evaluate(-direction);
        }
        vertex.evaluate(direction)
    }

    /// Factor, per length, on direct light in a medium.
    fn rate_of_direct_light(&self, sigma_t: DVec3, sigma_s: DVec3) -> DVec3 {
        match self.fault {
            Some(TransportFault::AlbedoLeftOutOfDirectLight) => sigma_t,
            // Per channel, of those in which there is extinction.
            Some(TransportFault::AlbedoSquaredInDirectLight) => {
                sigma_s * sigma_s / sigma_t.max(DVec3::splat(f64::MIN_POSITIVE))
            }
            _ => sigma_s,
        }
    }

    /// Radiance of point and spot lights scattered once into `ray`, estimated at one point of each
    /// segment by equiangular sampling.
    fn point_lights_along(&self, ray: &Ray, segments: &[Segment], random: &mut Random) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        for light in &self.plain.scene.lights {
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
                    let transmittance = self.plain.transmittance(ray, t, random);
                    let rate = self.rate_of_direct_light(medium.sigma_t, medium.sigma_s);
                    radiance += rate * direct * transmittance / angles.pdf(from_foot);
                }
            }
        }
        radiance
    }

    /// Scattering of `path` at a surface. Adds direct light to the path.
    fn scatter_at_surface(
        &self,
        path: &mut Path,
        material: Material,
        hit: &Hit,
        random: &mut Random,
    ) -> Option<Scattered> {
        let Material::Diffuse(reflectance) = material else {
            return self.plain.scatter_at_surface(path, material, hit, random);
        };
        let normal = match hit.side {
            Side::Front => hit.point.normal,
            Side::Back => -hit.point.normal,
        };
        let vertex = Vertex::on_surface(hit, normal, reflectance);
        let for_lights = match self.fault {
            Some(TransportFault::ReflectanceLeftOutOfDirectLight) => DVec3::ONE,
            Some(TransportFault::ReflectanceSquaredInDirectLight) => reflectance * reflectance,
            _ => reflectance,
        };
        let lit = Vertex::on_surface(hit, normal, for_lights);
        path.radiance += path.throughput * self.direct_light(&lit, random);
        vertex.sample(random)
    }

    /// Radiance of an area light that the ray of `path` hits, weighted against next-event estimation.
    fn emission(&self, light: &AreaLight, hit: &Hit, path: &Path) -> DVec3 {
        if hit.side == Side::Back && light.sides == Sides::Front {
            return DVec3::ZERO;
        }
        let cosine = path.ray.direction.cosine_to(hit.point.normal);
        let weight = |pdf| match self.fault {
            Some(TransportFault::LightsCountedTwice | TransportFault::HitsUnweighted) => 1.0,
            Some(TransportFault::HitsLeftOut) => 0.0,
            _ => power_heuristic(pdf, pdf_of_point(light, hit.t, cosine)),
        };
        light.radiance * path.pdf.map_or(1.0, weight)
    }
}

/// True if `ray` meets a bound of a medium before `end`. A vertex, or a light, on a bound does not count.
fn crosses_bounds(ray: &Ray, end: f64, media: &[Body]) -> bool {
    let mut shapes = media.iter().filter_map(|body| body.boundary.as_ref());
    shapes.any(|shape| {
        let margin = AT_THE_END * shape.bounds().size().max_element();
        let is_between = |t: f64| t > margin && t < end - margin;
        let mut spans = shape.spans(ray).into_iter();
        spans.any(|span| is_between(span.near) || is_between(span.far))
    })
}

//! Single scattering without random numbers: integrals along the line of sight.
//!
//! Emission and absorption of media are a closed form on each segment. Single scattering of a light
//! without extent is an integral along the line of sight, evaluated to a tolerance.

use super::context::Scratch;
use super::direct_light::{DirectLight, emitted_radiance};
use super::emission::Emission;
use super::scene_context::SceneContext;
use super::segments::{MediumSegment, MediumSegments};
use super::shadow_edges::{LightSource, shadow_edges};
use super::single_scattering::{ScatteringPoint, SingleScattering, edges, lit_span};
use super::surfaces::SurfaceIndex;
use super::tracker::Tracker;
use super::transmittance::Transmittance;
use super::vertex::Vertex;
use crate::geometry::{Ray, Span};
use crate::math::quadrature::integrate;
use crate::math::sampling::Equiangular;
use crate::optics::{Light, Material};
use crate::render::counters::{Counters, Event};
use glam::DVec3;

/// Light along the line of sight.
pub struct LineOfSight<'s> {
    /// The scene. Where light is scattered, lights have no extent and surfaces are diffuse;
    /// where media scatter, there are no surfaces, whose shadows could be too narrow to be found.
    pub scene: SceneContext<'s>,
    /// True if single scattering is computed.
    pub scattering: bool,
    /// Error of an integral relative to its value.
    pub tolerance: f64,
}

/// Relative error of an integral in an image: a hundredth of the last bit of 32-bit radiance.
pub const TOLERANCE: f64 = 6e-10;

/// Pieces that an integral begins with where several media may shade one another, between the
/// [edges](shadow_edges) of their shadows. A mesh of which parts are narrower than a four-hundredth
/// of a piece could be missed: a plan has no integrals for those.
const PIECES_WITH_SHADOWS: usize = 16;

/// Optical depths at which a segment is cut. A rule of few points, laid over all of a dense
/// segment, would find it dark: its lit part lies before the first of them.
const CUTS: [f64; 4] = [1.0, 8.0, 64.0, 746.0];

impl LineOfSight<'_> {
    /// Radiance along `ray`.
    pub fn radiance(&self, ray: &Ray, scratch: &mut Scratch, work: &mut Counters) -> DVec3 {
        let segments = &mut scratch.segments;
        let tracker = &mut Tracker::for_integrals(&mut scratch.tracker, work);
        let (scene, radiative) = (&self.scene, self.scene.radiative);
        let intersection = scene.intersect(ray, tracker.work);
        let mut radiance = DVec3::ZERO;
        let mut transmittance = DVec3::ONE;
        if scene.features.media {
            let end = intersection.map_or(f64::INFINITY, |nearest| nearest.hit.t);
            let heterogeneous = scene.is_heterogeneous();
            // The optical depth alone needs no segments.
            if scene.features.emission || self.scattering || !heterogeneous {
                segments.build(&scene.media, ray, end);
            }
            if heterogeneous {
                let spans = &mut tracker.scratch.spans;
                let depth = scene.media.optical_depth(ray, end, spans, tracker.work);
                transmittance = Transmittance(scene).closed(depth, tracker.work);
                if scene.features.emission {
                    radiance +=
                        Emission(scene).integrated(segments, ray, self.tolerance, tracker.work);
                }
            } else {
                transmittance = Transmittance(scene).closed(segments.optical_depth(), tracker.work);
                if scene.features.emission {
                    radiance += Emission(scene).closed(segments, tracker.work);
                }
            }
            if self.scattering {
                let lights = radiative.lights.iter();
                for light in lights.filter(|light| light.strength() != DVec3::ZERO) {
                    radiance += self.single_scattering(light, segments, ray, tracker);
                }
            }
        }
        let Some(nearest) = intersection else {
            return radiance + transmittance * radiative.environment;
        };
        let behind = match nearest.surface {
            SurfaceIndex::AreaLight(index) => {
                emitted_radiance(&radiative.area_lights[index], &nearest.hit)
            }
            SurfaceIndex::Object(index) => match radiative.objects[index].material {
                Material::Diffuse(reflectance) if self.scattering => {
                    self.reflected(&Vertex::on_surface(&nearest.hit, reflectance), tracker)
                }
                _ => DVec3::ZERO,
            },
        };
        radiance + transmittance * behind
    }

    /// Radiance that a surface reflects of direct light.
    fn reflected(&self, vertex: &Vertex, tracker: &mut Tracker<'_>) -> DVec3 {
        tracker.work.count(Event::FirstScattering);
        let lights = self.scene.radiative.lights.iter();
        lights.fold(DVec3::ZERO, |sum, light| {
            sum + DirectLight(&self.scene).of_light(vertex, light, tracker)
        })
    }

    /// Single scattering of `light` in the media along `ray`.
    fn single_scattering(
        &self,
        light: &Light,
        segments: &MediumSegments,
        ray: &Ray,
        tracker: &mut Tracker<'_>,
    ) -> DVec3 {
        let Some(lit) = lit_span(segments, ray, light) else {
            return DVec3::ZERO;
        };
        let mut edges = edges(light, ray);
        edges.extend(self.shadow_edges(light, ray));
        let mut radiance = DVec3::ZERO;
        let scattering = |segment: &&MediumSegment| segment.properties.scatters();
        for segment in segments.all().iter().filter(scattering) {
            let span = segment.span.within(lit);
            let mut at = |t: f64| {
                let (depths, _) = segments.depths_to(t);
                let point = ScatteringPoint::new(t, 1.0, depths, segment);
                tracker.work.count(Event::FirstScattering);
                let scene = &self.scene;
                SingleScattering(scene).at(ray, &point, tracker, |vertex, tracker| {
                    DirectLight(scene).of_light(vertex, light, tracker)
                })
            };
            for [near, far] in pieces(segment, span, &edges) {
                radiance += match light.position() {
                    // By the angle at which the light sees the ray: in it, the integrand is
                    // smooth however near the ray passes, and the end may be infinitely far away.
                    Some(position) => {
                        let foot = (position - ray.origin).dot(*ray.direction);
                        let distance = (ray.at(foot) - position).length();
                        let Ok(angle) = Equiangular::new(distance, near - foot, far - foot) else {
                            return DVec3::INFINITY;
                        };
                        self.integral(
                            |u| {
                                let s = angle.sample(u);
                                at(foot + s) / angle.pdf(s)
                            },
                            [0.0, 1.0],
                        )
                    }
                    // Light from infinitely far away does not get through an endless medium.
                    None if far.is_infinite() => DVec3::ZERO,
                    None => self.integral(&mut at, [near, far]),
                };
            }
        }
        radiance
    }

    /// Edges of the shadows that media throw onto one another along `ray`.
    fn shadow_edges(&self, light: &Light, ray: &Ray) -> Vec<f64> {
        let media = self.scene.media.all();
        let source = match light {
            Light::Directional(light) => LightSource::Towards(-light.direction),
            Light::Point(light) => LightSource::At(light.position),
            Light::Spot(light) => LightSource::At(light.position),
        };
        if media.len() < 2 {
            return vec![];
        }
        let casting = media.iter().filter(|medium| !medium.is_vacuum());
        let boundaries = casting.filter_map(|medium| medium.boundary);
        let edges = boundaries.flat_map(|boundary| shadow_edges(boundary, ray, source));
        edges.collect()
    }

    fn integral(&self, mut f: impl FnMut(f64) -> DVec3, [from, to]: [f64; 2]) -> DVec3 {
        let pieces = match self.scene.media.all().len() {
            0 | 1 => 1,
            _ => PIECES_WITH_SHADOWS,
        };
        let cut = |index: usize| from + (to - from) * (index as f64 / pieces as f64);
        (0..pieces).fold(DVec3::ZERO, |sum, index| {
            sum + integrate(&mut f, cut(index), cut(index + 1), self.tolerance).value
        })
    }
}

/// `span` of a segment, cut at [`CUTS`] and where light has an edge; nothing is seen from behind
/// the last of the cuts.
fn pieces(segment: &MediumSegment, span: Span, edges: &[f64]) -> Vec<[f64; 2]> {
    let extinction = segment.properties.extinction().max_element();
    let cuts = CUTS.map(|depth| segment.span.near + depth / extinction);
    let all = cuts.into_iter().chain(edges.iter().copied());
    let inside = all.filter(|&t| span.near < t && t < span.far);
    let mut ends = vec![span.near];
    ends.extend(inside);
    ends.push(span.far);
    ends.sort_unstable_by(f64::total_cmp);
    let pieces = ends.windows(2).map(|ends| [ends[0], ends[1]]);
    pieces.filter(|[near, far]| near < far).collect()
}

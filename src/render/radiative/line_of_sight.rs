//! Light turned once at most, without random numbers: integrals along the line of sight.
//!
//! What media emit and take away is a closed form on each stretch. What they turn into the line
//! of sight from a light without extent is an integral along it, evaluated to a tolerance.

use super::direct_light::radiance_of;
use super::effects::Effects;
use super::intersection::{Met, Surroundings};
use super::media::transmittance;
use super::scattering::Vertex;
use super::segments::{MediaPath, Stretch};
use super::single_scattering::{Place, edges, lit_span};
use super::specular::facing;
use super::tracker::Tracker;
use crate::geometry::{Ray, Span};
use crate::math::quadrature::integrate;
use crate::math::sampling::Equiangular;
use crate::optics::{Light, Material};
use crate::render::counters::{Event, Work};
use glam::DVec3;

/// Light along the line of sight, for the effects `E`.
pub struct LineOfSight<'s, E> {
    /// What is looked at. Where light is turned, lights have no extent and surfaces are diffuse;
    /// where media turn it, there are none, whose shadows could be too narrow to be found.
    pub around: Surroundings<'s, E>,
    /// Whether light is turned at all.
    pub turned: bool,
    /// Error of an integral relative to its value.
    pub tolerance: f64,
}

/// Relative error of an integral in an image: a hundredth of the last bit of 32-bit radiance.
pub const TOLERANCE: f64 = 6e-10;

/// Pieces that an integral begins with where several media may shade one another: a shadow that
/// is narrower than what lies between the points of a single rule would go unseen. One of a
/// four-hundredth of a stretch still can.
const PIECES_WITH_SHADOWS: usize = 16;

/// Optical depths at which a stretch is cut. A rule of few points, laid over all of a dense
/// stretch, would find it dark: what is lit lies before the first of them.
const CUTS: [f64; 4] = [1.0, 8.0, 64.0, 746.0];

impl<E: Effects> LineOfSight<'_, E> {
    /// Radiance that comes back along `ray`.
    pub fn radiance<W: Work>(
        &self,
        ray: &Ray,
        path: &mut MediaPath,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        let scene = self.around.scene;
        let met = self.around.nearest(ray, work);
        let end = met.as_ref().map_or(f64::INFINITY, |(_, hit)| hit.t);
        let mut radiance = DVec3::ZERO;
        let mut through = DVec3::ONE;
        if E::MEDIA {
            let media = &self.around.media;
            let varies = E::HETEROGENEOUS && media.vary();
            // Their depth alone is known without the stretches that they lie on.
            if E::EMISSION || self.turned || !varies {
                path.lay(media, ray, end);
            }
            if varies {
                let depth = media.depth(ray, end, &mut tracker.spans, work);
                through = transmittance::<E, W>(depth, work);
                if E::EMISSION {
                    radiance +=
                        path.emitted_by_quadrature::<E, W>(media, ray, self.tolerance, work);
                }
            } else {
                through = transmittance::<E, W>(path.depth(), work);
                if E::EMISSION {
                    radiance += path.emitted::<E, W>(work);
                }
            }
            if self.turned {
                let lights = scene.lights.iter();
                for light in lights.filter(|light| light.strength() != DVec3::ZERO) {
                    radiance += self.turned_by_media(light, path, ray, tracker, work);
                }
            }
        }
        let behind = match met {
            None => scene.environment,
            Some((Met::AreaLight(index), hit)) => radiance_of(&scene.area_lights[index], &hit),
            Some((Met::Object(index), hit)) => match scene.objects[index].material {
                Material::Diffuse(reflectance) if self.turned => {
                    let vertex = Vertex::Diffuse {
                        point: hit.point,
                        normal: facing(&hit),
                        reflectance,
                    };
                    self.turned_at(&vertex, tracker, work)
                }
                _ => DVec3::ZERO,
            },
        };
        radiance + through * behind
    }

    /// Radiance that a surface makes of what the lights send there.
    fn turned_at<W: Work>(&self, vertex: &Vertex, tracker: &mut Tracker, work: &mut W) -> DVec3 {
        work.count(Event::FirstScattering);
        let lights = self.around.scene.lights.iter();
        lights.fold(DVec3::ZERO, |sum, light| {
            sum + self.around.by_light(vertex, light, tracker, work)
        })
    }

    /// Radiance that the media make, by one turn, of what `light` sends them.
    fn turned_by_media<W: Work>(
        &self,
        light: &Light,
        path: &MediaPath,
        ray: &Ray,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        let Some(lit) = lit_span(path, ray, light) else {
            return DVec3::ZERO;
        };
        let edges = edges(light, ray);
        let mut radiance = DVec3::ZERO;
        for stretch in path
            .stretches()
            .iter()
            .filter(|stretch| stretch.matter.scatters())
        {
            let span = Span {
                near: stretch.span.near.max(lit.near),
                far: stretch.span.far.min(lit.far),
            };
            let mut at = |t: f64| {
                let (depths, _) = path.depths_to(t);
                let place = Place {
                    t,
                    pdf: 1.0,
                    depths,
                    stretch,
                };
                work.count(Event::FirstScattering);
                self.around.scattered_at(ray, &place, light, tracker, work)
            };
            for [near, far] in pieces(stretch, span, &edges) {
                radiance += match light.position() {
                    // By the angle at which the light sees the ray: in it, the integrand is
                    // smooth however near the ray passes, and the end may be infinitely far away.
                    Some(position) => {
                        let foot = (position - ray.origin).dot(ray.direction);
                        let distance = (ray.at(foot) - position).length();
                        let Ok(angle) = Equiangular::new(distance, near - foot, far - foot) else {
                            return DVec3::INFINITY;
                        };
                        self.integral(
                            |u| {
                                let s = angle.place(u);
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

    fn integral(&self, mut f: impl FnMut(f64) -> DVec3, [from, to]: [f64; 2]) -> DVec3 {
        let pieces = match self.around.media.count() {
            0 | 1 => 1,
            _ => PIECES_WITH_SHADOWS,
        };
        let cut = |index: usize| from + (to - from) * (index as f64 / pieces as f64);
        (0..pieces).fold(DVec3::ZERO, |sum, index| {
            sum + integrate(&mut f, cut(index), cut(index + 1), self.tolerance).value
        })
    }
}

/// `span` of a stretch, cut at [`CUTS`] and where light has an edge; what lies deeper than the last
/// of the cuts shines through no more.
fn pieces(stretch: &Stretch, span: Span, edges: &[f64]) -> Vec<[f64; 2]> {
    let extinction = (stretch.matter.sigma_t + stretch.matter.dimming).max_element();
    let cuts = CUTS.map(|depth| stretch.span.near + depth / extinction);
    let all = cuts.into_iter().chain(edges.iter().copied());
    let inside = all.filter(|&t| span.near < t && t < span.far);
    let mut ends = vec![span.near];
    ends.extend(inside);
    ends.push(span.far);
    ends.sort_unstable_by(f64::total_cmp);
    let pieces = ends.windows(2).map(|ends| [ends[0], ends[1]]);
    pieces.filter(|[near, far]| near < far).collect()
}

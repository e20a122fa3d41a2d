//! Points where a path scatters into a range of directions.

use super::random::Random;
use crate::geometry::{Direction, Hit, Ray, SurfacePoint};
use crate::math::Frame;
use crate::math::sampling::{cosine_hemisphere, cosine_hemisphere_pdf};
use crate::optics::{Deflection, Phase};
use glam::DVec3;

/// A collision in a medium, or a point of a diffuse surface.
pub struct Vertex {
    /// The point; in a medium the ray-origin offset (clearance) is 0, so the normal is unused.
    pub point: SurfacePoint,
    /// Axis of the directions: in a medium the direction of the ray that arrives, at a surface
    /// the normal on the side of that ray.
    axis: Direction,
    pub scattering: Scatterer,
}

/// The distribution by which a vertex scatters.
#[derive(Clone, Copy)]
pub enum Scatterer {
    /// By a phase function.
    Phase(Phase),
    /// By Lambert's law, with a reflectance by channel.
    Diffuse(DVec3),
}

/// The continuation of a path.
pub struct Scattered {
    /// The ray into the new direction.
    pub ray: Ray,
    /// Per channel: phase function, or BRDF times cosine, divided by the pdf.
    pub weight: DVec3,
    /// Probability density, per steradian, of the direction; `None` for a mirror and glass.
    pub pdf: Option<f64>,
}

impl Vertex {
    /// A collision at distance `t` of `ray`.
    pub fn in_medium(ray: &Ray, t: f64, phase: Phase) -> Vertex {
        Vertex {
            point: SurfacePoint {
                position: ray.at(t),
                normal: ray.direction,
                clearance: 0.0,
            },
            axis: ray.direction,
            scattering: Scatterer::Phase(phase),
        }
    }

    /// A point of a surface with the `normal` on the side of the ray that arrives.
    pub fn on_surface(hit: &Hit, normal: Direction, reflectance: DVec3) -> Vertex {
        Vertex {
            point: hit.point,
            axis: normal,
            scattering: Scatterer::Diffuse(reflectance),
        }
    }

    /// The phase function, or the BRDF times the cosine, for light from `direction`, by channel and
    /// per steradian; and the probability density of [`Vertex::sample`] there.
    pub fn evaluate(&self, direction: Direction) -> (DVec3, f64) {
        let cosine = self.axis.cosine_to(direction).clamp(-1.0, 1.0);
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

    /// A direction sampled with pdf proportional to the phase function or the cosine; `None` where
    /// rounding leaves no ray.
    pub fn sample(&self, random: &mut Random) -> Option<Scattered> {
        let numbers = random.pair();
        let (local, weight) = match self.scattering {
            Scatterer::Phase(phase) => {
                let deflection = phase.deflection(numbers[0]);
                (deflection.direction(numbers[1]), DVec3::ONE)
            }
            Scatterer::Diffuse(reflectance) => (cosine_hemisphere(numbers), reflectance),
        };
        let ray = self.point.leave(Frame::around(self.axis).to_world(local));
        ray.map(|ray| Scattered {
            ray,
            weight,
            pdf: Some(self.evaluate(ray.direction).1),
        })
    }
}

//! How much light reaches a sample through the volume.

use super::empty_space::Space;
use super::field::{Field, NodePath};
use super::steps::Steps;
use crate::geometry::{Aabb, Ray, Span, length_of};
use crate::math;
use crate::media::{Appearance, TransferFunction, over_length};
use crate::render::counters::{Event, Work};
use crate::scene::Shadow;
use glam::DVec3;

/// What a sample asks for its light.
pub trait Visibility: Sync {
    /// Share of the light that arrives at a sample, in [0, 1].
    fn at<F: Field, S: Space, W: Work>(
        &self,
        sample: Sample,
        field: &F,
        space: &S,
        work: &mut W,
    ) -> f64;
}

/// A place in the volume.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// World position.
    pub world: DVec3,
    /// Position in node units.
    pub nodes: DVec3,
}

/// No shadow: all light arrives, and nothing is traced.
#[derive(Clone, Copy, Debug)]
pub struct Unshadowed;

impl Visibility for Unshadowed {
    fn at<F: Field, S: Space, W: Work>(&self, _: Sample, _: &F, _: &S, _: &mut W) -> f64 {
        1.0
    }
}

/// The volume shadow.
///
/// With the formula of the ray-casting assignment it is the assignment's, `min(1, exp(−S/100))`,
/// `S` the sum of the densities met on the way to the light: the integral of density in units of
/// `reference_step`, sampled every `step`. Refining the step converges, and at
/// `step = reference_step` it is the source's plain sum.
///
/// A sum means nothing for the values of a scan, which may be negative, or high where the table
/// of points makes them transparent. There the light that arrives is what the opacities let
/// through, each stated over `reference_step`: `Π (1 − a)^(step/reference_step)`.
#[derive(Clone, Copy, Debug)]
pub struct VolumeShadow<'c> {
    /// Steps of the shadow ray.
    pub shadow: Shadow,
    /// World position of the light.
    pub light: DVec3,
    /// Extent of the volume.
    pub bounds: Aabb,
    /// What a value looks like.
    pub transfer_function: &'c TransferFunction,
}

impl Visibility for VolumeShadow<'_> {
    fn at<F: Field, S: Space, W: Work>(
        &self,
        sample: Sample,
        field: &F,
        space: &S,
        work: &mut W,
    ) -> f64 {
        let to_light = self.light - sample.world;
        let Some(ray) = Ray::new(sample.world, to_light) else {
            return 1.0;
        };
        let Some(inside) = self.bounds.span(&ray) else {
            return 1.0;
        };
        work.count(Event::ShadowRay);
        let span = Span {
            near: 0.0,
            far: inside.far.min(length_of(to_light)),
        };
        let steps = Steps::over(span, self.shadow.step);
        let path = NodePath::from(sample.nodes, ray.direction, field.lattice());
        let reach = path.reach(self.shadow.step);
        let reference = self.shadow.reference_step;
        let (mut sum, mut through) = (0.0, 1.0);
        let mut done = 0;
        while done < steps.count() {
            let (t, length) = steps.sample(done);
            let point = path.at(t);
            let transparent = space.transparent_samples(point, reach, work);
            if transparent > 0 {
                done += transparent;
                continue;
            }
            let value = field.density(&field.locate(point), work);
            match &self.transfer_function.appearance {
                Appearance::Formula { .. } => sum += value * length,
                Appearance::Points(points) => {
                    through *= 1.0 - over_length(points.opacity(value), length / reference);
                    if through == 0.0 {
                        return 0.0; // nothing behind it matters
                    }
                }
            }
            done += 1;
        }
        math::exp(-(sum / reference) / 100.0).min(1.0) * through
    }
}

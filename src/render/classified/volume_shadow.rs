//! Visibility of the light from a sample, through the volume.

use super::empty_space::Skipping;
use super::field::ScalarField;
use super::steps::{SamplePoint, Steps};
use crate::geometry::{Ray, Span, length_of};
use crate::math;
use crate::optics::{Appearance, TransferFunction, over_length};
use crate::render::counters::{Event, Work};
use crate::scene::Shadow;
use crate::volume::{NodeLine, PlacedBox};
use glam::DVec3;

/// Visibility of the light from samples.
pub trait Visibility: Sync {
    /// Share of the light that reaches a sample, in [0, 1].
    fn at<F: ScalarField, S: Skipping, W: Work>(
        &self,
        sample: SamplePoint,
        field: &F,
        skipping: &S,
        work: &mut W,
    ) -> f64;
}

/// The ray from a world point towards `light`, and its span inside the volume; `None` where it has no
/// direction or misses the volume.
#[inline]
pub(crate) fn shadow_ray(point: DVec3, light: DVec3, extent: &PlacedBox) -> Option<(Ray, Span)> {
    let to_light = light - point;
    let ray = Ray::new(point, to_light)?;
    let inside = extent.span(&ray)?;
    let span = Span::new(0.0, inside.far.min(length_of(to_light)));
    Some((ray, span))
}

/// No shadow: visibility 1, without a shadow ray.
#[derive(Clone, Copy, Debug)]
pub struct Unshadowed;

impl Visibility for Unshadowed {
    fn at<F: ScalarField, S: Skipping, W: Work>(
        &self,
        _: SamplePoint,
        _: &F,
        _: &S,
        _: &mut W,
    ) -> f64 {
        1.0
    }
}

/// The volume shadow.
///
/// With the formula of the ray-casting assignment it is the assignment's, `min(1, exp(−S/100))`,
/// `S` the sum of the densities towards the light: the integral of density in units of
/// `reference_step`, sampled every `step`. Refining the step converges, and at
/// `step = reference_step` it is the source's plain sum.
///
/// The values of a scan have no such sum: they may be negative, or high where the table of points
/// makes them transparent. With a table the visibility is the transmittance of the opacities, each
/// stated over `reference_step`: `Π (1 − a)^(step/reference_step)`.
#[derive(Clone, Copy, Debug)]
pub struct VolumeShadow<'c> {
    /// Steps of the shadow ray.
    pub shadow: Shadow,
    /// World position of the light.
    pub light: DVec3,
    /// Extent of the volume.
    pub extent: PlacedBox,
    /// Opacity by value.
    pub transfer_function: &'c TransferFunction,
}

impl Visibility for VolumeShadow<'_> {
    fn at<F: ScalarField, S: Skipping, W: Work>(
        &self,
        sample: SamplePoint,
        field: &F,
        skipping: &S,
        work: &mut W,
    ) -> f64 {
        let Some((ray, span)) = shadow_ray(sample.world, self.light, &self.extent) else {
            return 1.0;
        };
        work.count(Event::ShadowRay);
        let steps = Steps::over(span, self.shadow.step);
        let line = NodeLine::from(
            sample.nodes,
            self.extent.vector_to_volume(*ray.direction),
            field.lattice(),
        );
        self.transmittance(&line, steps, field, skipping, work)
    }
}

impl VolumeShadow<'_> {
    /// Transmittance over the `steps` of a shadow ray.
    // Never: what finds the ray takes registers from the loop along it.
    #[inline(never)]
    fn transmittance<F: ScalarField, S: Skipping, W: Work>(
        &self,
        line: &NodeLine,
        steps: Steps,
        field: &F,
        skipping: &S,
        work: &mut W,
    ) -> f64 {
        let reach = line.reach(self.shadow.step);
        let reference = self.shadow.reference_step;
        let (mut sum, mut transmittance) = (0.0, 1.0);
        let mut in_empty_space = true;
        let mut done = 0;
        while done < steps.count() {
            let (t, length) = steps.sample(done);
            let point = line.at(t);
            // Behind a sample that dims the light, the block is most likely not empty.
            if in_empty_space {
                let skipped = skipping.transparent_samples(point, reach, work);
                if skipped > 0 {
                    done += skipped;
                    continue;
                }
            }
            let value = field.density(&field.locate(point), work);
            match &self.transfer_function.appearance {
                Appearance::Formula { .. } => {
                    let density = self.transfer_function.density(value);
                    sum += density * length;
                    in_empty_space = density == 0.0;
                }
                Appearance::Points(points) => {
                    let opacity = points.opacity(value);
                    transmittance *= 1.0 - over_length(opacity, length / reference);
                    if transmittance == 0.0 {
                        return 0.0; // nothing behind it matters
                    }
                    in_empty_space = opacity == 0.0;
                }
            }
            done += 1;
        }
        math::exp(-(sum / reference) / 100.0).min(1.0) * transmittance
    }
}

//! Samples of a ray, composited as a scene and its conventions say.

use super::steps::StepRule;
use super::work::RayWork;
use crate::geometry::Ray;
use crate::math::rng::philox4x32_10;
use crate::optics::Layer;
use crate::scene::{Classified, Compositing, Fault, Precision};
use glam::DVec3;
use half::f16;

impl Layer {
    /// This layer in numbers of `precision`.
    pub(super) fn rounded(self, precision: Precision) -> Layer {
        let round = |value| rounded(value, precision);
        Layer {
            colour: self.colour.map(round),
            opacity: round(self.opacity),
            transparency: round(self.transparency),
        }
    }

    /// This layer with the next `sample` of a ray, in the order in which `scene` composites.
    pub(super) fn with(self, sample: Layer, scene: &Classified) -> Layer {
        let sum = self.colour + sample.colour;
        let mut seen = if scene.compositing == Compositing::BackToFront {
            sample.over(self)
        } else {
            self.over(sample)
        };
        if scene.conventions.fault == Some(Fault::ColoursAdded) {
            seen.colour = sum;
        }
        seen.rounded(scene.conventions.precision)
    }

    /// True if the ray ends with this layer; it may be opaque then.
    pub(super) fn ends(&mut self, scene: &Classified) -> bool {
        let Compositing::EarlyTermination(threshold) = scene.compositing else {
            return false;
        };
        let ends = self.transparency < threshold;
        if ends && scene.conventions.ended_rays_opaque {
            (self.opacity, self.transparency) = (1.0, 0.0);
        }
        ends
    }
}

/// Radiance of a pixel of an image of `size`, background included, and the opacity of the volumes, which `cast`
/// composites along a ray as far as a distance; and the work of its ray.
pub(super) fn pixel_of(
    scene: &Classified,
    [column, row]: [usize; 2],
    size: [usize; 2],
    cast: impl Fn(&Ray, f64, StepRule, &mut RayWork) -> Layer,
) -> ([f32; 4], RayWork) {
    let mut work = RayWork::default();
    let ray = if scene.conventions.pixel_corner {
        scene.camera.ray_through([column as f64, row as f64], size)
    } else {
        scene.camera.ray([column, row], size)
    };
    let mut rule = StepRule::of(&scene.conventions);
    if scene.conventions.is_random() {
        let pixel = (row * size[0] + column) as u32;
        work.random_draws += 1;
        let random = philox4x32_10([pixel, 0, 0, 0], [0; 2])[0];
        let random = f64::from(random) / (1_u64 << 32) as f64;
        if scene.conventions.has_random_place() {
            rule.position = random;
        } else {
            rule.first = random;
        }
    }
    let hit = scene.objects.nearest_surface(&ray);
    let end = hit.as_ref().map_or(f64::INFINITY, |(hit, _)| hit.t);
    let volume = cast(&ray, end, rule, &mut work);
    let (behind, opacity) = match hit {
        None => (scene.background, volume.opacity),
        Some((hit, surface)) => (surface.shaded(&ray, &hit, scene.light), 1.0),
    };
    let DVec3 { x, y, z } = volume.colour + behind * volume.transparency;
    ([x, y, z, opacity].map(|value| value as f32), work)
}

/// `value` as a number of `precision`.
pub(super) fn rounded(value: f64, precision: Precision) -> f64 {
    match precision {
        Precision::F64 => value,
        Precision::F32 => f64::from(value as f32),
        Precision::F16 => f64::from(f16::from_f64(value)),
        // Not above what a product of whole numbers of units is but for the rounding of `f64`.
        Precision::U15 => ((value.clamp(0.0, 1.0) * 32767.0 - 1e-6).ceil()) / 32767.0,
        Precision::U8 => (value.clamp(0.0, 1.0) * 255.0).round() / 255.0,
    }
}

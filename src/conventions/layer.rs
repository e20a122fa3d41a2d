//! Samples of a ray, composited as a scene and its conventions say.

use crate::optics::Layer;
use crate::scene::{Classified, Compositing, Fault, Precision};
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

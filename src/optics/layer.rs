//! Compositing of the samples of a ray, in either order.
//!
//! Colours are *associated*: already multiplied by their opacity. Both orders evaluate the same
//! sum; they differ by rounding.
//!
//! Opacity and transparency are both carried, though either follows from the other: the opacity
//! holds the digits of a thin volume, whose transparency is next to 1, and the transparency those
//! of a thick one. With `1 − A` in its place every sample would round to a unit of 1: a million
//! samples of an optical depth of 10 in all were 1.3e-10 off. Where the transparency is below one
//! half, the opacity is `1 − T`, so that it is never above 1.
//!
//! Measured on a million random layers, of a depth of 0.001, 1 and 30 in all: opacity to at most
//! 310 ulp in either order, colour to 160 ulp, at a depth of 30 to 11 000; the derived bounds are
//! some thousand times as large.
//!
//! Source: Porter & Duff 1984, "Compositing digital images" (the operator *over*); Levoy 1988.

use glam::DVec3;

/// Samples of a ray, composited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Associated colour.
    pub colour: DVec3,
    /// Share of the light from behind that is held back, in [0, 1].
    pub opacity: f64,
    /// Share of the light from behind that passes, in [0, 1].
    pub transparency: f64,
}

impl Layer {
    /// No samples: only the background is seen.
    pub const EMPTY: Layer = Layer {
        colour: DVec3::ZERO,
        opacity: 0.0,
        transparency: 1.0,
    };

    /// One sample of associated `colour`.
    pub fn sample(colour: DVec3, opacity: f64) -> Layer {
        Layer {
            colour,
            opacity,
            transparency: 1.0 - opacity,
        }
    }

    /// This layer in front of `back`.
    pub fn over(self, back: Layer) -> Layer {
        let transparency = self.transparency * back.transparency;
        Layer {
            colour: self.colour + back.colour * self.transparency,
            opacity: if transparency < 0.5 {
                1.0 - transparency
            } else {
                self.opacity + back.opacity * self.transparency
            },
            transparency,
        }
    }

    /// The pixel of this layer in front of `background`: radiance, and the opacity without it.
    pub fn pixel(&self, background: DVec3) -> [f32; 4] {
        let DVec3 { x, y, z } = self.colour + background * self.transparency;
        [x, y, z, self.opacity].map(|value| value as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: DVec3 = DVec3::new(1.0, 0.0, 0.0);
    const GREEN: DVec3 = DVec3::new(0.0, 1.0, 0.0);
    const BLUE: DVec3 = DVec3::new(0.0, 0.0, 1.0);

    #[test]
    fn the_check_of_the_course() {
        let layer = Layer::sample(GREEN, 0.5).over(Layer::sample(RED, 0.7));
        assert_eq!(layer.colour, DVec3::new(0.5, 1.0, 0.0));
        assert_eq!(layer.opacity, 0.85);
        assert_eq!(layer.transparency, 0.5 * (1.0 - 0.7));

        let layer = Layer::sample(RED, 0.5).over(Layer::sample(BLUE, 0.1));
        assert_eq!(layer.colour, DVec3::new(1.0, 0.0, 0.5));
    }

    #[test]
    fn a_transparent_sample_changes_no_bit() {
        let layer = Layer::sample(DVec3::new(0.1, 0.7, 1.3), 0.3);
        assert_eq!(layer.over(Layer::EMPTY), layer);
        assert_eq!(Layer::EMPTY.over(layer), layer);
    }
}

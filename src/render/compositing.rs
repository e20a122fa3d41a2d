//! Putting the samples of a ray together, in either order.
//!
//! Colours are *associated*: already multiplied by their opacity. Both orders evaluate the same
//! sum; they differ by rounding.
//!
//! Source: Porter & Duff 1984, "Compositing digital images" (the operator *over*); Levoy 1988.

use glam::DVec3;

/// Layers put together so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layers {
    /// Associated colour.
    pub colour: DVec3,
    /// Opacity, in [0, 1].
    pub opacity: f64,
}

/// The order in which samples arrive.
pub trait Order {
    /// Which of `count` samples, numbered from the eye, comes after `done` others.
    fn index(done: usize, count: usize) -> usize;

    /// `layers` with one more sample, of associated `colour`.
    fn add(layers: Layers, colour: DVec3, opacity: f64) -> Layers;
}

/// From the eye into the volume: `C += (1 − A)·c`, `A += (1 − A)·a`.
#[derive(Clone, Copy, Debug)]
pub struct FrontToBack;

impl Order for FrontToBack {
    fn index(done: usize, _count: usize) -> usize {
        done
    }

    fn add(layers: Layers, colour: DVec3, opacity: f64) -> Layers {
        let transparency = 1.0 - layers.opacity;
        Layers {
            colour: layers.colour + colour * transparency,
            opacity: layers.opacity + opacity * transparency,
        }
    }
}

/// Towards the eye: `C = c + (1 − a)·C`, `A = a + (1 − a)·A`.
#[derive(Clone, Copy, Debug)]
pub struct BackToFront;

impl Order for BackToFront {
    fn index(done: usize, count: usize) -> usize {
        count - 1 - done
    }

    fn add(layers: Layers, colour: DVec3, opacity: f64) -> Layers {
        let transparency = 1.0 - opacity;
        Layers {
            colour: colour + layers.colour * transparency,
            opacity: opacity + layers.opacity * transparency,
        }
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
        let layers = FrontToBack::add(Layers::default(), GREEN, 0.5);
        let layers = FrontToBack::add(layers, RED, 0.7);
        assert_eq!(
            layers,
            Layers {
                colour: DVec3::new(0.5, 1.0, 0.0),
                opacity: 0.85
            }
        );

        let layers = BackToFront::add(Layers::default(), BLUE, 0.1);
        let layers = BackToFront::add(layers, RED, 0.5);
        assert_eq!(layers.colour, DVec3::new(1.0, 0.0, 0.5));
    }

    #[test]
    fn a_transparent_sample_changes_no_bit() {
        let layers = Layers {
            colour: DVec3::new(0.1, 0.7, 1.3),
            opacity: 0.3,
        };
        assert_eq!(FrontToBack::add(layers, DVec3::ZERO, 0.0), layers);
        assert_eq!(BackToFront::add(layers, DVec3::ZERO, 0.0), layers);
    }
}

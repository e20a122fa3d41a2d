//! The misfit of an image to the right one under other conventions, on few pixels or on all.

use crate::compare::deterministic::in_tolerances;
use crate::film::Film;
use crate::math::Sum;

/// A difference counts by at most this many tolerances: a few pixels at an edge, far off, do not
/// decide for the whole image.
pub const CAP: f64 = 20.0;

/// Largest share of the pixels of the lattice outside of the tolerance at which the whole image is
/// rendered for the verdict. The gate allows 0.02 %; a lattice of few pixels may have met more of
/// them.
pub const MOST_OUTSIDE: f64 = 0.005;

/// Approximate number of pixels of the lattice on which sets are compared.
pub const LATTICE: usize = 576;

/// Difference of two images in tolerances of the deterministic gate, by the worst channel of each
/// pixel.
pub struct Misfit {
    /// Mean over the pixels of its square.
    pub mean_square: f64,
    /// Share of the pixels that are off by more than one tolerance.
    pub outside: f64,
    /// Difference of the worst pixel.
    pub worst: f64,
}

impl Misfit {
    /// Indices of the pixels that are off by more than one tolerance.
    pub fn pixels_outside(right: &Film, test: &Film) -> Vec<usize> {
        let test = &*test.nearest_to(right);
        let pixels = right.radiance().iter().zip(test.radiance()).enumerate();
        let outside = pixels.filter(|(_, (right, test))| in_tolerances(**right, **test) > 1.0);
        outside.map(|(index, _)| index).collect()
    }

    pub fn of(right: &Film, test: &Film) -> Misfit {
        let test = &*test.nearest_to(right);
        let (mut sum, mut outside, mut largest) = (Sum::default(), 0, 0.0_f64);
        for (right, test) in right.radiance().iter().zip(test.radiance()) {
            let worst = in_tolerances(*right, *test);
            sum.add(worst.min(CAP) * worst.min(CAP));
            outside += usize::from(worst > 1.0);
            largest = largest.max(worst);
        }
        let pixels = right.radiance().len() as f64;
        Misfit {
            mean_square: sum.value() / pixels,
            outside: outside as f64 / pixels,
            worst: largest,
        }
    }
}

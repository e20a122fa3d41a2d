//! LDR-FLIP: the perceived difference of two images that alternate.
//!
//! Source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A
//! Difference Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2),
//! High Performance Graphics 2020. Section and equation names below are the paper's.
//!
//! The error of a pixel joins two differences, each in [0, 1]:
//!
//! * **colour** (modules `colour`, `contrast`): both images are blurred as the eye blurs them at
//!   the viewing distance and compared in a perceptual colour space;
//! * **feature** (module `feature`): edges and points that only one image has.
//!
//! ```
//! use volref::compare::flip::{DEFAULT_PIXELS_PER_DEGREE, SrgbImage, flip};
//!
//! let black = SrgbImage::new(4, 4, vec![[0; 3]; 16])?;
//! let white = SrgbImage::new(4, 4, vec![[255; 3]; 16])?;
//! let errors = flip(&black, &white, DEFAULT_PIXELS_PER_DEGREE)?;
//! assert!(errors.mean() > 0.96);
//! # Ok::<(), volref::compare::flip::FlipError>(())
//! ```

mod colour;
mod contrast;
mod error_map;
mod feature;
mod image;
mod kernel;
mod plane;
mod power;

pub use error_map::{ErrorMap, magma};
pub use image::{FlipError, SrgbImage};

use rayon::prelude::*;

use colour::{ColourScale, OpponentPlanes};
use contrast::{BlurredRow, ContrastFilter};
use feature::{FeatureFilter, FeatureRow, feature_difference};
use power::power;

/// Pixels per degree of visual angle, for pixels of `metres_per_pixel` at a distance of
/// `distance` metres: the width a degree covers near the line of sight, in pixels.
pub const fn pixels_per_degree(distance: f64, metres_per_pixel: f64) -> f64 {
    distance / metres_per_pixel * (std::f64::consts::PI / 180.0)
}

/// 67.0206 pixels per degree: a display 0.7 m wide of 3840 pixels, seen from 0.7 m, the viewing
/// condition of the paper. (The 0.7 m cancel: 3840·π/180.)
pub const DEFAULT_PIXELS_PER_DEGREE: f64 = pixels_per_degree(0.7, 0.7 / 3840.0);

/// Smallest and largest pixels per degree that [`flip`] accepts. Below 1 the whole feature
/// filter lies inside a single pixel; 10 000 is a hundred times finer than the eye.
pub const PIXELS_PER_DEGREE_RANGE: std::ops::RangeInclusive<f64> = 1.0..=10_000.0;

/// The FLIP error of every pixel of `test` against `reference`, each in [0, 1].
///
/// The same bits for any number of threads, and for the two images swapped.
///
/// # Errors
///
/// If the images differ in size, or `pixels_per_degree` is outside
/// [`PIXELS_PER_DEGREE_RANGE`].
pub fn flip(
    reference: &SrgbImage,
    test: &SrgbImage,
    pixels_per_degree: f64,
) -> Result<ErrorMap, FlipError> {
    let (width, height) = (reference.width(), reference.height());
    let (reference_size, test_size) = ((width, height), (test.width(), test.height()));
    if reference_size != test_size {
        return Err(FlipError(format!(
            "the reference is {reference_size:?} pixels wide and high, the test image {test_size:?}"
        )));
    }
    if !PIXELS_PER_DEGREE_RANGE.contains(&pixels_per_degree) {
        let fault = format!("{pixels_per_degree} pixels per degree is outside 1 to 10000");
        return Err(FlipError(fault));
    }
    let contrast = ContrastFilter::new(pixels_per_degree);
    let features = FeatureFilter::new(pixels_per_degree);
    let scale = ColourScale::new();
    let reference = OpponentPlanes::of(reference);
    let test = OpponentPlanes::of(test);

    // Rows are independent: every one reads the two inputs and writes only itself, so the
    // number of threads cannot change a bit.
    let mut values = vec![0.0; width * height];
    values.par_chunks_mut(width).enumerate().for_each_init(
        || {
            let side = || {
                (
                    BlurredRow::new(width, &contrast),
                    FeatureRow::new(width, &features),
                )
            };
            (side(), side())
        },
        |(of_reference, of_test), (y, errors)| {
            for (image, (blurred, feature)) in
                [(&reference, &mut *of_reference), (&test, &mut *of_test)]
            {
                blurred.fill(&contrast, image, y);
                feature.fill(&features, &image.0[0], y);
            }
            for (x, error) in errors.iter_mut().enumerate() {
                let colour = scale.difference(of_reference.0.colour(x), of_test.0.colour(x));
                let feature = feature_difference(of_reference.1.strength(x), of_test.1.strength(x));
                // The feature difference raises the colour difference, and leaves equal colours at no error.
                // Source: section 4.3, `ΔE = ΔE_c^(1 − ΔE_f)`.
                *error = power(colour, 1.0 - feature);
            }
        },
    );
    Ok(ErrorMap(values))
}

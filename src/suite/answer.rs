//! Known answers, which take precedence over any golden.

use crate::compare::{Margin, Metric, STANDARD_ERRORS};
use crate::film::{CHANNELS, Film};
use crate::math::Sum;
use glam::DVec3;
use std::fmt;

/// Name of [`OF_TOLERANCE`].
pub(crate) const ERROR_OF_TOLERANCE: &str = "error_of_tolerance";

/// The metric of a case with a known answer beside those of the gate.
pub(crate) const OF_TOLERANCE: Metric = (
    ERROR_OF_TOLERANCE,
    "Error of the known answer as a fraction of its tolerance: 0 is exact, 1 is the limit.",
);

/// The known radiance of every pixel of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// Every pixel of an image without noise.
    EveryPixel {
        /// Radiance of each pixel.
        radiance: DVec3,
        /// Relative tolerance of a pixel.
        within: f64,
    },
    /// For a sampled image: the mean of all pixels, up to noise.
    InTheMean(DVec3),
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Answer::EveryPixel { radiance, within } => {
                write!(f, "{radiance} in every pixel, within {within:e} of it")
            }
            Answer::InTheMean(radiance) => {
                write!(
                    f,
                    "{radiance} in the mean of all pixels, within four standard errors"
                )
            }
        }
    }
}

/// Relative rounding of a stored pixel: half the last of 24 binary digits.
const STORED: f64 = 1.0 / (1 << 24) as f64;

impl Answer {
    /// The image whose every pixel is the answer.
    pub fn image(&self, width: usize, height: usize) -> Film {
        let (Answer::EveryPixel { radiance, .. } | Answer::InTheMean(radiance)) = *self;
        let pixel = radiance.as_vec3().to_array();
        Film::new(width, height, vec![pixel; width * height])
    }

    /// The error of `film` relative to the tolerance.
    pub fn margin(&self, film: &Film) -> Margin {
        let mut margin = Margin::default();
        match *self {
            Answer::EveryPixel { radiance, within } => {
                for (index, pixel) in film.radiance().iter().enumerate() {
                    let (column, row) = (index % film.width(), index / film.width());
                    for ((found, right), channel) in
                        pixel.iter().zip(radiance.to_array()).zip(CHANNELS)
                    {
                        let what = format_args!("{channel} of pixel ({column}, {row})");
                        margin.within(what, f64::from(*found), right, within * right);
                    }
                }
            }
            Answer::InTheMean(radiance) => {
                let count = film.radiance().len() as f64;
                for (channel, right) in radiance.to_array().into_iter().enumerate() {
                    let mean = |pixels: &[[f32; 3]]| {
                        let values = pixels.iter().map(|pixel| pixel[channel].into());
                        Sum::from_iter(values).value() / count
                    };
                    let variance = film.noise().map(|noise| mean(noise.variance()) / count);
                    let error = variance.unwrap_or(f64::NAN).sqrt();
                    let allowed = STANDARD_ERRORS * error + STORED * right;
                    let what = format_args!("mean of {}", CHANNELS[channel]);
                    margin.within(what, mean(film.radiance()), right, allowed);
                }
            }
        }
        margin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_counts() {
        let answer = Answer::EveryPixel {
            radiance: DVec3::new(1.0, 2.0, 0.0),
            within: 0.5,
        };
        let right = [1.0, 2.0, 0.0];
        let film = |odd| Film::new(2, 1, vec![right, odd]);
        assert_eq!(answer.margin(&film(right)).share(), 0.0);
        assert_eq!(answer.margin(&film([1.0, 2.25, 0.0])).share(), 0.25);
        assert_eq!(answer.margin(&film([1.75, 2.0, 0.0])).share(), 1.5);
        // Black pixels have to be black.
        assert_eq!(
            answer.margin(&film([1.0, 2.0, 1e-30])).share(),
            f64::INFINITY
        );
        assert_eq!(
            answer.margin(&film([1.0, f32::NAN, 0.0])).share(),
            f64::INFINITY
        );
    }

    #[test]
    fn the_mean_counts_as_far_as_noise_lets_it() {
        let answer = Answer::InTheMean(DVec3::ONE);
        let film =
            |mean, variance| Film::with_noise(2, 2, vec![[mean; 3]; 4], vec![[variance; 3]; 4], 16);
        // A variance of 1/16 in each of four pixels: a standard error of 1/8.
        assert!((answer.margin(&film(1.25, 0.0625)).share() - 0.5).abs() < 1e-6);
        assert!((answer.margin(&film(0.25, 0.0625)).share() - 1.5).abs() < 1e-6);
        assert_eq!(answer.margin(&film(1.0, 0.0)).share(), 0.0);
        assert!(answer.margin(&film(1.0 + f32::EPSILON, 0.0)).share() > 1.0);
        // Without any statement of noise nothing can be said.
        assert_eq!(
            answer.margin(&Film::new(1, 1, vec![[1.5; 3]])).share(),
            f64::INFINITY
        );
    }
}

//! The image that settings are compared with.

use super::norms::root_mean_square;
use super::{CostError, Parameter};
use crate::film::Film;
use crate::render::{Sampling, Seed, plans, render};
use crate::scene::{Conventions, Mode, Model, Panel, Scene};
use crate::volume::Interpolation;
use serde::Serialize;

/// The reference of errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// Method of the reference.
    pub method: String,
    /// Its own error at most, relative as in [`Norms`](super::norms::Norms): an error not far above it is not called an
    /// error of a setting.
    pub bound: f64,
}

/// The reference step is this share of the finest one. If errors fall in proportion to the step, the error of the reference
/// is a 32nd of that of the finest step: all but the two finest settings are more than 100 times as far off. If errors fall
/// faster, it is smaller.
const FINER: f64 = 1.0 / 32.0;

/// Samples of the reference: its standard error is an eighth of that of 64 samples, which moves the
/// order by less than 0.003.
const SAMPLES: u32 = 4096;

/// Rounding of two images to 32 bits, relative to each pixel.
const ROUNDING: f64 = f32::EPSILON as f64;

/// The true image, as far as it is known.
pub(super) struct Truth {
    method: String,
    pub values: Vec<f64>,
    /// Root mean square of the values: the unit of errors.
    pub scale: f64,
    /// The setting of the image.
    setting: f64,
    /// Largest error in units of the scale, if it is known before other settings are.
    bound: Option<f64>,
}

impl Truth {
    /// The true image of `panel`, whose finest setting is `finest`; random numbers follow from `seed`.
    pub fn of(
        panel: &Panel,
        parameter: Parameter,
        finest: f64,
        seed: u64,
    ) -> Result<Truth, CostError> {
        let setting = match parameter {
            Parameter::Step | Parameter::ShadowStep => FINER * finest,
            Parameter::Samples => f64::from(SAMPLES),
        };
        let mut panel = parameter.set(panel, setting)?;
        let is_integral = parameter == Parameter::Step && integrate(&mut panel);
        let sampling = Sampling {
            // No setting of a sweep has these random numbers.
            seed: Seed::Given(seed.wrapping_add(1 << 32)),
            ..Sampling::default()
        };
        let scene = Scene::of(panel);
        let made = render(&plans(&scene), sampling, &|| ())?;
        let values = values(&made.film);
        let scale = root_mean_square(values.iter().copied());
        let words = parameter.words(setting);
        let (method, bound) = if is_integral {
            let error = made.error_bound.unwrap_or(0.0) * made.film.brightest();
            let method = "the integral along each ray, without samples".to_owned();
            (method, Some(error / scale))
        } else if let Some(noise) = made.film.noise() {
            let squares = noise.variance().as_flattened().iter();
            let squares: f64 = squares.map(|variance| f64::from(*variance)).sum();
            let error = (squares / values.len() as f64).sqrt();
            let method = format!("{words} per pixel with other random numbers");
            (method, Some(error / scale))
        } else {
            (format!("the same image with steps of {words}"), None)
        };
        Ok(Truth {
            method,
            values,
            scale,
            setting,
            bound,
        })
    }

    /// As the finest setting that was tried, `finest`, is off by `error`.
    pub fn reference(self, finest: f64, error: f64) -> Reference {
        // e(h) falls at least as h: the difference |e(h) − e(h/n)| is at least (n − 1) e(h/n).
        let finer = || error / (finest / self.setting - 1.0);
        Reference {
            bound: self.bound.unwrap_or_else(finer) + ROUNDING,
            method: self.method,
        }
    }
}

/// The scene without samples, where that is the limit of finer and finer steps: see `compositing = "continuous"`. True
/// if it is.
fn integrate(panel: &mut Panel) -> bool {
    let Model::Classified(scene) = &mut panel.model else {
        return false;
    };
    let is_lit = scene.phong.is_some() || scene.shadow.is_some();
    scene.continuous = scene.interpolation == Interpolation::Trilinear
        && scene.conventions == Conventions::default()
        && !scene.has_objects()
        && !(is_lit && scene.mode == Mode::Composited);
    scene.continuous
}

/// The radiance of all pixels and channels, pixel by pixel.
pub(super) fn values(film: &Film) -> Vec<f64> {
    let values = film.radiance().as_flattened().iter();
    values.map(|value| f64::from(*value)).collect()
}

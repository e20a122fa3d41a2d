//! Images of a formula.

use super::formula::{Formula, exact};
use crate::film::Film;
use crate::geometry::{Camera, Ray};
use crate::math::quadrature::{Integral, gauss_legendre};
use crate::scene::{Model, Scene};
use glam::DVec3;

/// The part of a pixel that its radiance is of, as renderings of the scene have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Footprint {
    /// Its centre: images without random numbers.
    Centre,
    /// The mean over its square: means of samples.
    Square,
}

/// The image of a formula.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownImage {
    /// Rounded to 32 bits, without noise.
    pub film: Film,
    /// Bound on the relative error of any pixel, that of rounding included.
    pub error: f64,
}

/// Points on a side of a pixel by which its mean is taken. Formulas are smooth within a pixel: in the
/// suite the next smaller rule differs by less than 1e-7.
const POINTS: usize = 4;

impl Formula {
    /// The image of `scene` by this formula.
    ///
    /// # Errors
    ///
    /// A message, if the formula does not describe the scene, or not every ray of the image.
    pub fn image(&self, scene: &Scene, footprint: Footprint) -> Result<KnownImage, String> {
        self.image_of(scene, footprint)
            .map_err(|reason| format!("the truth {:?} does not fit the scene: {reason}", self.name))
    }

    fn image_of(&self, scene: &Scene, footprint: Footprint) -> Result<KnownImage, String> {
        let [panel] = &scene.panels[..] else {
            return Err("it has more than one panel".to_owned());
        };
        let Model::Radiative(radiative) = &panel.model else {
            return Err("it has no `[radiative]`".to_owned());
        };
        let along = (self.of)(radiative)?;
        let size = [panel.width, panel.height];
        let rules = [POINTS, POINTS - 1].map(|points| {
            let rule = gauss_legendre(points).into_iter();
            rule.map(|(x, w)| (0.5 + 0.5 * x, 0.5 * w)).collect()
        });
        // The largest error of a pixel.
        let mut error = 0.0_f64;
        let mut pixels = Vec::with_capacity(size[0] * size[1]);
        for pixel in (0..size[0] * size[1]).map(|index| [index % size[0], index / size[0]]) {
            let camera = &radiative.camera;
            let known = match footprint {
                Footprint::Centre => along(&camera.ray(pixel, size)),
                Footprint::Square => mean_over_square(&rules, camera, pixel, size, &along),
            };
            let known = known.map_err(|reason| format!("pixel {pixel:?}: {reason}"))?;
            let largest = known.value.max_element();
            if !(known.value.min_element() >= 0.0 && largest.is_finite()) {
                return Err(format!("pixel {pixel:?}: its radiance is {}", known.value));
            }
            if largest > 0.0 {
                error = error.max(known.error / largest);
            }
            pixels.push(known.value.to_array().map(|channel| channel as f32));
        }
        Ok(KnownImage {
            film: Film::new(size[0], size[1], pixels),
            error: error + f64::from(f32::EPSILON) / 2.0,
        })
    }
}

/// The mean over the square of a pixel by the finer of two rules, of coordinates on [0, 1] and weights that sum to 1; the
/// error is their difference besides those of the rays.
fn mean_over_square(
    rules: &[Vec<(f64, f64)>; 2],
    camera: &Camera,
    [column, row]: [usize; 2],
    size: [usize; 2],
    along: impl Fn(&Ray) -> Result<Integral, String>,
) -> Result<Integral, String> {
    let mut means = [exact(DVec3::ZERO); 2];
    for (mean, rule) in means.iter_mut().zip(rules) {
        for &(y, weight_y) in rule {
            for &(x, weight_x) in rule {
                let at = [column as f64 + x, row as f64 + y];
                let known = along(&camera.ray_through(at, size))?;
                mean.value += known.value * (weight_x * weight_y);
                mean.error += known.error * (weight_x * weight_y);
            }
        }
    }
    let [fine, coarse] = means;
    let difference = (fine.value - coarse.value).abs().max_element();
    Ok(Integral {
        value: fine.value,
        error: fine.error + difference,
    })
}

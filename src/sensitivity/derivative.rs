//! The derivative of an image by a parameter.

use super::number::Number;
use crate::film::Film;
use crate::math::Moments;
use crate::render::{Detail, Plan, RenderError, Sampling, Seed, plans, render_part};
use crate::scene::Scene;

/// Parameters of the differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differences {
    /// Pixels, or blocks, that are rendered.
    pub detail: Detail,
    /// Random samples in a pixel, or in a block, on each side and in all pairs together.
    pub samples: u32,
    /// Independent pairs of renderings from whose spread the error is estimated, at least 2.
    pub pairs: u32,
    /// Seed of the first pair; the others have the next ones.
    pub seed: u64,
    /// Change on either side, in the [unit](super::Number::unit) of the parameter; that of the parameter
    /// if `None`.
    pub step: Option<f64>,
}

/// The derivative of an image by a parameter, per [unit](super::Number::unit) of its changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivative {
    /// Means with the variance of those means: that of the spread of pairs, or the square of the
    /// error that differences of half the step show.
    pub film: Film,
    /// The step that was taken.
    pub step: f64,
    /// Renderings on both sides: else the parameter can only grow, or only shrink.
    pub is_central: bool,
    /// Number of pixels without a derivative in an image without noise: an edge crosses them, so
    /// that their difference does not converge with the step.
    pub unsettled: usize,
}

/// The derivative of the image of `scene` by `number`.
///
/// `stopped` is called before every row, from any thread; once it returns true, so does this.
///
/// # Errors
///
/// Errors of the rendering. `None` where the parameter cannot be changed on either side.
pub fn derivative(
    scene: &Scene,
    number: &Number,
    differences: &Differences,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Derivative>, RenderError> {
    let step = differences.step.unwrap_or(number.step);
    let Some(sides) = Sides::of(scene, number, step) else {
        return Ok(None);
    };
    if plans(scene).iter().any(Plan::is_sampled) {
        return sampled(&sides, differences, stopped).map(Some);
    }
    let difference = |sides: &Sides| {
        let [below, above] = sides.rendered(differences.detail, Sampling::default(), stopped)?;
        Ok((sides.quotients(&below, &above), below))
    };
    let (whole, film) = difference(&sides)?;
    let half = Sides::of(scene, number, 0.5 * step);
    let Some(half) = half.filter(|_| !number.is_linear) else {
        return Ok(Some(sides.without_noise(&film, &whole, &whole)));
    };
    let (half, _) = difference(&half)?;
    Ok(Some(sides.without_noise(&film, &whole, &half)))
}

/// The scene below and above, and how far apart.
struct Sides {
    scenes: [Scene; 2],
    width: f64,
    step: f64,
    is_central: bool,
}

impl Sides {
    fn of(scene: &Scene, number: &Number, step: f64) -> Option<Sides> {
        let changed = |change: f64| number.changed(scene, change);
        let (below, above) = (changed(-step), changed(step));
        let is_central = below.is_some() && above.is_some();
        let width = if is_central { 2.0 * step } else { step };
        let scenes = match (below, above) {
            (Some(below), Some(above)) => [below, above],
            (Some(below), None) => [below, scene.clone()],
            (None, Some(above)) => [scene.clone(), above],
            (None, None) => return None,
        };
        Some(Sides {
            scenes,
            width,
            step,
            is_central,
        })
    }

    fn rendered(
        &self,
        detail: Detail,
        sampling: Sampling,
        stopped: &(dyn Fn() -> bool + Sync),
    ) -> Result<[Film; 2], RenderError> {
        let render = |scene: &Scene| render_part(&plans(scene), sampling, detail, stopped, &|| ());
        let [below, above] = &self.scenes;
        Ok([render(below)?.film, render(above)?.film])
    }

    fn quotients(&self, below: &Film, above: &Film) -> Vec<[f64; 3]> {
        let pairs = below.radiance().iter().zip(above.radiance());
        let quotient =
            |c: usize, a: &[f32; 3], b: &[f32; 3]| (f64::from(b[c]) - f64::from(a[c])) / self.width;
        pairs
            .map(|(a, b)| [0, 1, 2].map(|c| quotient(c, a, b)))
            .collect()
    }

    /// Derivative of an image without noise: Richardson's extrapolation of the differences with the
    /// whole and with half the step, whose distance is the error, and the rounding of both sides to
    /// 32 bits.
    fn without_noise(&self, film: &Film, whole: &[[f64; 3]], half: &[[f64; 3]]) -> Derivative {
        // Errors of central differences fall as the square of the step, of others as the step.
        let order = if self.is_central { 4.0 } else { 2.0 };
        let (mut means, mut variances) = (Vec::new(), Vec::new());
        let mut unsettled = 0;
        for ((whole, half), pixel) in whole.iter().zip(half).zip(film.radiance()) {
            let mut is_settled = true;
            let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
            for c in 0..3 {
                let way = half[c] - whole[c];
                let rounding = f64::from(f32::EPSILON) * f64::from(pixel[c].abs()) / self.width;
                // An edge that crosses a pixel changes it by the same jump whatever the step, so that
                // half the step has twice the quotient.
                is_settled &= way.abs() <= 0.5 * half[c].abs().max(whole[c].abs()) + 8.0 * rounding;
                mean[c] = (half[c] + way / (order - 1.0)) as f32;
                let error = way.abs() / (order - 1.0) + 4.0 * rounding;
                variance[c] = (error * error) as f32;
            }
            unsettled += usize::from(!is_settled);
            means.push(mean);
            variances.push(variance);
        }
        Derivative {
            film: Film::with_noise(film.width(), film.height(), means, variances, 2),
            step: self.step,
            is_central: self.is_central,
            unsettled,
        }
    }
}

fn sampled(
    sides: &Sides,
    differences: &Differences,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Result<Derivative, RenderError> {
    let pairs = differences.pairs.max(2);
    let mut moments: Vec<[Moments; 3]> = Vec::new();
    let mut size = [0; 2];
    for pair in 0..pairs {
        let sampling = Sampling {
            samples: Some((differences.samples / pairs).max(1)),
            seed: Seed::Given(differences.seed.wrapping_add(pair.into())),
        };
        let [below, above] = sides.rendered(differences.detail, sampling, stopped)?;
        size = [below.width(), below.height()];
        let quotients = sides.quotients(&below, &above);
        moments.resize(quotients.len(), Default::default());
        for (moments, quotient) in moments.iter_mut().zip(quotients) {
            for c in 0..3 {
                moments[c].add(quotient[c]);
            }
        }
    }
    Ok(Derivative {
        film: Film::of_moments(size, &moments, pairs),
        step: sides.step,
        is_central: sides.is_central,
        unsettled: 0,
    })
}

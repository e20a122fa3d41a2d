//! The cost of samples per pixel in sampled images.

use super::norms::root_mean_square;
use super::order::ExpectedOrder;
use super::results::{Parameter, Study};
use super::study::{PlannedSweep, Setting, SettingOutcome, SettingRun, Truth};
use super::thumbnail;
use super::timing::Clock;
use crate::film::Film;
use crate::render::{RenderError, Sampling, Seed, plans, render, render_counted};
use crate::scene::Panel;

/// Pixels of the larger side of the image.
const SIDE: usize = 16;

/// Samples per pixel.
const SAMPLES: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];

/// Samples of the reference: its standard error is an eighth of that of the finest setting, which
/// moves the order by less than 0.003.
const REFERENCE: u32 = 4096;

/// The image of `panel`, by samples per pixel; random numbers from `seed`.
pub fn study(panel: &Panel, seed: u64, clock: &Clock) -> Result<Study, RenderError> {
    let scene = thumbnail::scene(panel, panel.model.clone(), SIDE);
    let plans = plans(&scene);
    let plans = plans.as_slice();
    let sampling = |samples: u32, seed: u64| Sampling {
        samples: Some(samples),
        seed: Seed::Given(seed),
    };
    // Seeds of their own, so that no setting shares random numbers with another.
    let film = render(
        plans,
        sampling(REFERENCE, seed.wrapping_add(1 << 32)),
        &|| (),
    )?
    .film;
    let (width, height) = (film.width(), film.height());
    let right: Vec<f64> = values(&film);
    let scale = root_mean_square(right.iter().copied());
    let noise = film.noise().expect("several samples have a variance");
    let squares = noise.variance().as_flattened().iter();
    let squares: f64 = squares.map(|variance| f64::from(*variance)).sum();
    // Without any noise there is still the rounding to 32 bits.
    let bound = ((squares / right.len() as f64).sqrt() / scale).max(f64::from(f32::EPSILON));
    let right = &right;
    let settings = SAMPLES.iter().enumerate().map(|(index, &samples)| {
        let run: SettingRun<'_> = Box::new(move || {
            // What cannot be rendered has no errors, which is no error of 0.
            let sampling = sampling(samples, seed.wrapping_add(index as u64));
            let Ok(made) = render_counted(plans, sampling, &|| ()) else {
                return SettingOutcome::default();
            };
            let errors = values(&made.film).into_iter().zip(right);
            SettingOutcome {
                errors: errors.map(|(value, right)| value - right).collect(),
                work: made.work[0],
                rays: width * height,
                channels: 3,
            }
        });
        let noun = if samples == 1 { "sample" } else { "samples" };
        Setting::new(format!("{samples} {noun}"), f64::from(samples), run)
    });
    let planned = [PlannedSweep {
        estimator: "path tracing".to_owned(),
        is_ours: true,
        parameter: Parameter::Samples,
        expected: ExpectedOrder::OF_SAMPLES,
        settings: settings.collect(),
    }];
    let quantity = format!("radiance of {width} × {height} pixels, by samples per pixel");
    let truth = Truth {
        method: format!(
            "{REFERENCE} samples per pixel with other random numbers; the bound is its standard \
             error"
        ),
        scale,
        bound,
        judged: None,
    };
    Ok(Study::of("samples", quantity, truth, &planned, clock))
}

fn values(film: &Film) -> Vec<f64> {
    let values = film.radiance().as_flattened().iter();
    values.map(|value| f64::from(*value)).collect()
}

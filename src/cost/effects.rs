//! The cost of each effect by itself.

use super::results::{EffectPrice, MeanWork};
use super::thumbnail;
use super::timing::{Clock, Task};
use crate::optics::{Coefficients, Density, Phase};
use crate::render::{RenderError, Sampling, plans, render, render_counted};
use crate::scene::{Body, Classified, Model, Panel, Radiative, Scattering, Scene};
use glam::DVec3;

/// Pixels of the larger side of the image.
const SIDE: usize = 32;
/// Samples per pixel, where an image is sampled.
const SAMPLES: u32 = 4;

/// A scene with some of its effects.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Names of the effects.
    pub name: String,
    /// A small image of it, of one panel.
    pub scene: Scene,
}

/// The effects of `panel`, each added alone to the scene without any; the last one has all of them.
pub fn variants(panel: &Panel) -> Vec<Variant> {
    let variants = match &panel.model {
        Model::Classified(scene) if scene.has_objects() => vec![],
        Model::Classified(scene) => of_classified(scene),
        Model::Radiative(scene) => of_radiative(scene),
        Model::Curve(_) => vec![],
    };
    let small = |(name, model)| Variant {
        name,
        scene: thumbnail::scene(panel, model, SIDE),
    };
    variants.into_iter().map(small).collect()
}

/// The cost of the [`variants`] of `panel`.
pub fn prices(panel: &Panel, clock: &Clock) -> Result<Vec<EffectPrice>, RenderError> {
    let [width, height] = thumbnail::thumbnail([panel.width, panel.height], SIDE);
    let pixels = width * height;
    let variants = variants(panel);
    let sampling = Sampling::of_samples(SAMPLES);
    let each = variants.iter();
    let all_plans: Vec<_> = each.map(|variant| plans(&variant.scene)).collect();
    let mut works = Vec::new();
    for plans in &all_plans {
        let made = render_counted(plans, sampling, &|| ())?;
        works.push(MeanWork::per_ray(&made.work[0], pixels));
    }
    let tasks = all_plans.iter().map(|plans| -> Task<'_> {
        Box::new(move || {
            // It was rendered above, and refuses nothing that it did not then.
            let _ = std::hint::black_box(render(plans, sampling, &|| ()));
        })
    });
    let times = clock.by_turns(&tasks.collect::<Vec<_>>(), pixels as f64);
    let first = works.first().map_or(0.0, MeanWork::price);
    let prices = variants.into_iter().zip(works).zip(times);
    let prices = prices.map(|((variant, work), time)| EffectPrice {
        effect: variant.name,
        times_lookups: (first > 0.0).then(|| work.price() / first),
        work,
        time,
    });
    Ok(prices.collect())
}

fn of_classified(scene: &Classified) -> Vec<(String, Model)> {
    let with = |name: &str, shading: bool, shadow: bool| {
        let scene = Classified {
            phong: scene.phong.filter(|_| shading),
            shadow: scene.shadow.filter(|_| shadow),
            ..scene.clone()
        };
        (name.to_owned(), Model::from(scene))
    };
    let mut variants = vec![with("absorption and emission", false, false)];
    let (shading, shadow) = (scene.phong.is_some(), scene.shadow.is_some());
    if shading {
        variants.push(with("with gradient shading", true, false));
    }
    if shadow {
        variants.push(with("with volume shadow", false, true));
    }
    if shading && shadow {
        variants.push(with("with both", true, true));
    }
    variants
}

/// Coefficients that are the same in all channels, `factor` times as large.
fn grey(coefficients: &Coefficients, factor: f64) -> Coefficients {
    let mean = |channels: DVec3| DVec3::splat(factor * channels.element_sum() / 3.0);
    let grey = Coefficients::new(mean(coefficients.sigma_a()), mean(coefficients.sigma_s()));
    grey.unwrap_or(*coefficients)
}

fn of_radiative(scene: &Radiative) -> Vec<(String, Model)> {
    // What is left without effects: light that is not scattered, in grey, homogeneous, isotropic media that
    // emit nothing.
    let mut plain = scene.clone();
    plain.scattering = Scattering::None;
    for body in &mut plain.media {
        // In place of a density that varies, one that is like it.
        let typical = body.density.as_ref().map_or(1.0, Density::typical);
        body.medium.coefficients = grey(&body.medium.coefficients, typical);
        body.medium.emission = DVec3::ZERO;
        body.medium.phase = Phase::ISOTROPIC;
        body.density = None;
    }
    let named = |name: &str, scene: Radiative| (name.to_owned(), Model::from(scene));
    let mut variants = vec![named("absorption, no scattering", plain.clone())];
    let mut add = |name: &str, edit: &dyn Fn(&mut Radiative)| {
        let mut edited = plain.clone();
        edit(&mut edited);
        variants.push(named(name, edited));
    };
    let any = |f: fn(&Body) -> bool| scene.media.iter().any(f);
    let each = |edited: &mut Radiative, f: fn(&mut Body, &Body)| {
        let bodies = edited.media.iter_mut().zip(&scene.media);
        bodies.for_each(|(body, given)| f(body, given));
    };
    if any(|body| body.medium.emission != DVec3::ZERO) {
        add("with emission", &|edited| {
            each(edited, |body, given| {
                body.medium.emission = given.medium.emission
            });
        });
    }
    if any(|body| body.density.is_some()) {
        add("with heterogeneous density", &|edited| {
            each(edited, |body, given| {
                body.density = given.density.clone();
                body.medium.coefficients = grey(&given.medium.coefficients, 1.0);
            });
        });
    }
    if scene.scattering != Scattering::None {
        add("with single scattering", &|edited| {
            edited.scattering = Scattering::Single
        });
    }
    if matches!(scene.scattering, Scattering::Multiple(_)) {
        add("with multiple scattering", &|edited| {
            edited.scattering = scene.scattering
        });
        if any(|body| body.medium.phase != Phase::ISOTROPIC) {
            add("with multiple scattering, anisotropic", &|edited| {
                edited.scattering = scene.scattering;
                each(edited, |body, given| body.medium.phase = given.medium.phase);
            });
        }
    }
    variants.push(named("all of the scene", scene.clone()));
    variants
}

//! The cost of each effect by itself.

use super::MeanWork;
use super::thumbnail::thumbnail;
use super::timing::{Clock, Times};
use super::work::measured;
use crate::optics::{Coefficients, Density, Phase};
use crate::render::RenderError;
use crate::scene::{Body, Classified, Model, Panel, Radiative, Scattering, Scene};
use glam::DVec3;
use serde::Serialize;

/// Pixels of the larger side of the image.
const SIDE: usize = 32;
/// Samples per pixel, where an image is sampled.
const SAMPLES: u32 = 4;

/// Cost of one effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectPrice {
    /// The effects simulated.
    pub effect: String,
    /// Work for each pixel.
    pub work: MeanWork,
    /// Time for each pixel.
    pub time: Option<Times>,
    /// Lookups relative to the first of the list.
    pub times_lookups: Option<f64>,
}

/// The effects of `panel` in small images, each effect added alone to the scene without any; the last one has all of
/// them.
fn variants(panel: &Panel) -> Vec<(String, Model)> {
    match &panel.model {
        Model::Classified(scene) => of_classified(scene),
        Model::Radiative(scene) => of_radiative(scene),
        Model::Curve(_) => vec![],
    }
}

/// The cost of the effects of `panel`, as many as there is time for; random numbers by `seed`.
pub(super) fn prices(
    panel: &Panel,
    seed: u64,
    clock: &Clock,
) -> Result<Vec<EffectPrice>, RenderError> {
    let variants = variants(panel).into_iter();
    let small = |(name, model)| (name, Scene::of(thumbnail(panel, model, SIDE)));
    let (names, scenes): (Vec<_>, Vec<_>) = variants.map(small).unzip();
    let measured = measured(&scenes, Some(SAMPLES), seed, clock)?;
    let first = measured.first().map_or(0.0, |image| image.work.price());
    let prices = names
        .into_iter()
        .zip(measured)
        .map(|(effect, image)| EffectPrice {
            effect,
            times_lookups: (first > 0.0).then(|| image.work.price() / first),
            work: image.work,
            time: image.time,
        });
    Ok(prices.collect())
}

fn of_classified(scene: &Classified) -> Vec<(String, Model)> {
    let with = |name: &str, shading: bool, shadow: bool| {
        let scene = lit_by(scene, shading, shadow);
        (name.to_owned(), Model::from(scene))
    };
    let mut variants = vec![with("absorption and emission", false, false)];
    let (shading, shadow) = light(scene);
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

/// Whether some volume or surface is shaded, and whether a volume casts a shadow.
fn light(scene: &Classified) -> (bool, bool) {
    let mut surfaces = scene.objects.surfaces.iter();
    let shading = scene.each_alone().any(|alone| alone.phong.is_some());
    (
        shading || surfaces.any(|surface| surface.phong.is_some()),
        scene.shadow.is_some(),
    )
}

/// `scene` with its shading and its shadow only if they are asked for.
fn lit_by(scene: &Classified, shading: bool, shadow: bool) -> Classified {
    let mut scene = scene.clone();
    scene.edit_volumes(|alone| {
        alone.phong = alone.phong.filter(|_| shading);
        alone.shadow = alone.shadow.filter(|_| shadow);
        true
    });
    scene
}

/// `scene` without shading and shadow; none if it has neither.
pub(super) fn unlit(scene: &Classified) -> Option<Classified> {
    (light(scene) != (false, false)).then(|| lit_by(scene, false, false))
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

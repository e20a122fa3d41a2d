//! Images of another renderer at smaller and smaller steps, judged by the image without steps.

use super::finding::CheckedGolden;
use crate::compare::{Judgement, judge_one_step, judge_refinement};
use crate::film::Film;
use crate::render::{plans, render};
use crate::scene::{Classified, LastStep, Sampling, Scene};
use crate::volume::Grid;
use std::sync::Arc;

/// The name of an image in a reason.
const IMAGE: &str = "test image";

/// Judges images with the step of the scene, half of it, a quarter and so on.
pub fn judge(checked: &CheckedGolden, images: &[Film]) -> Judgement {
    let (first, rest) = images.split_first().expect("three images or more");
    // A renderer that does not take its step from the call makes one image several times.
    let mut others = rest.iter();
    if others.all(|image| image.radiance() == first.radiance()) {
        let mut judgement = judge_one(checked, first);
        judgement.reason = format!(
            "all images are the same, whatever the step: does the renderer take it from {{step}} or \
             {{rate}}? {}",
            judgement.reason
        );
        return judgement;
    }
    let looked_up = looked_up(&checked.scene);
    let by_rules = || first_order(&checked.scene.with_halved_steps(rest.len()));
    judge_refinement(&checked.golden.film, &looked_up, &by_rules, images)
        .with_changes_of(IMAGE, first)
}

/// Judges an image with the step of the scene.
pub fn judge_one(checked: &CheckedGolden, image: &Film) -> Judgement {
    let looked_up = looked_up(&checked.scene);
    let mut by_rules = first_order(&checked.scene);
    by_rules.extend(between_the_ends(&checked.scene));
    judge_one_step(&checked.golden.film, &looked_up, &by_rules, image)
        .with_precision_of(&checked.golden.film, image)
        .with_changes_of(IMAGE, image)
}

/// Entries of the smallest table in which renderers look up colours and opacities. It is exact if the nodes of the scene's
/// table lie at multiples of 1/255. Tables of other sizes round kinks, tables of corrected opacities round curves, and
/// values taken for texture coordinates are off by up to half an entry.
const TABLE: f64 = 256.0;

/// Images of `scene` from values that are off by half an entry of a table, up and down.
fn looked_up(scene: &Scene) -> [Film; 2] {
    [-0.5, 0.5].map(|entries| {
        rendered(scene, |volume| {
            let (least, most) = volume.grid.range();
            let off = (entries * (most - least) / (TABLE - 1.0)) as f32;
            // A formula has no meaning below the least value.
            let values = volume.grid.values().iter();
            let values = values.map(|value| (value + off).clamp(least as f32, most as f32));
            let grid = Grid::new(*volume.grid.lattice(), values.collect());
            volume.grid = Arc::new(grid.expect("as many values as before"));
        })
    })
}

/// Images of `scene` by rules of first order: with samples at the beginning and at the end of each
/// step, and the last step as it is, counted as a whole one, or dropped.
fn first_order(scene: &Scene) -> Vec<Film> {
    let last_steps = [LastStep::Exact, LastStep::Whole, LastStep::Dropped];
    let images = |first| last_steps.map(|last| sampled(scene, first, last));
    [0.0, 1.0].into_iter().flat_map(images).collect()
}

/// Images of `scene` with samples a quarter, half and three quarters of the way along each step. Samples at the beginning
/// and at the end of steps are at the same places but for the first and the last. A detail thinner than a step lies
/// between these places, or on them, and a single image is right with samples at either.
fn between_the_ends(scene: &Scene) -> [Film; 3] {
    [0.25, 0.5, 0.75].map(|first_sample| sampled(scene, first_sample, LastStep::Exact))
}

/// The image of `scene` with samples at this place of each step.
fn sampled(scene: &Scene, first_sample: f64, last_step: LastStep) -> Film {
    rendered(scene, |volume| {
        volume.sample();
        volume.conventions.first_sample = first_sample;
        volume.conventions.last_step = last_step;
    })
}

/// The image of `scene` with its volumes changed by `edit`.
fn rendered(scene: &Scene, edit: impl Fn(&mut Classified)) -> Film {
    let scene = scene.with_volumes(edit);
    let rendering = render(&plans(&scene), Sampling::default(), &|| ());
    // The golden was rendered likewise: of a classified volume nothing can fail.
    rendering.expect("a volume is rendered").film
}

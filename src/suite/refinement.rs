//! Images of another renderer against a picture without a step.

use super::finding::CheckedGolden;
use crate::compare::{Judgement, Picture, judge_one_step, judge_refinement};
use crate::film::Film;
use crate::reference::ray_caster;
use crate::scene::{Compositing, Panel, Scene};

/// Judges images with the step of the scene, half of it, a quarter and so on, and gives their limit.
pub fn judge(checked: &CheckedGolden, images: &[Film]) -> (Judgement, Picture) {
    let golden = &checked.golden.film;
    let (first, rest) = images.split_first().expect("three images or more");
    // A renderer that does not take its step from the call makes one image several times.
    if rest
        .iter()
        .all(|image| image.radiance() == first.radiance())
    {
        let mut judgement = judge_one_step(golden, &first_order(&checked.scene), first);
        judgement.reason = format!(
            "all images are the same, whatever the step: does the renderer take it from {{step}} or \
             {{rate}}? {}",
            judgement.reason
        );
        return (judgement, Picture::Radiance(first.clone()));
    }
    let (judgement, limit) = judge_refinement(golden, images);
    (judgement, Picture::Radiance(limit))
}

/// Judges an image with the step of the scene.
pub fn judge_one(checked: &CheckedGolden, picture: &Picture) -> Judgement {
    let image = picture.radiance().expect("the gate is one of radiance");
    judge_one_step(&checked.golden.film, &first_order(&checked.scene), image)
}

/// Images of `scene` with samples at the beginning and at the end of each step.
fn first_order(scene: &Scene) -> [Film; 2] {
    [0.0, 1.0].map(|first_sample| {
        let panels = scene.panels.iter();
        let films: Vec<Film> = panels.map(|panel| sampled(panel, first_sample)).collect();
        Film::side_by_side(&films)
    })
}

/// The image of a classified volume with a sample at `first_sample` of each step.
fn sampled(panel: &Panel, first_sample: f64) -> Film {
    let classified = panel.classified();
    let mut scene = classified
        .expect("a limit is one of a classified volume")
        .clone();
    scene.compositing = Compositing::FrontToBack;
    scene.conventions.first_sample = first_sample;
    ray_caster::render(&scene, [panel.width, panel.height])
}

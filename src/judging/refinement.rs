//! Images of another renderer at smaller and smaller steps, judged by the image without steps.

use super::finding::CheckedGolden;
use crate::compare::{Judgement, Limit, Picture, judge_one_step, judge_refinement};
use crate::film::Film;
use crate::render::{plans, render};
use crate::scene::{Classified, Sampling, Scene};
use crate::volume::Grid;
use std::sync::Arc;

/// The name of an image in a reason.
const IMAGE: &str = "test image";

/// Judges images with the step of the scene, half of it, a quarter and so on, and gives their limit.
pub fn judge(checked: &CheckedGolden, images: &[Film]) -> (Judgement, Picture) {
    let looked_up = looked_up(&checked.scene);
    let truth = Limit {
        golden: &checked.golden.film,
        looked_up: &looked_up,
    };
    let (first, rest) = images.split_first().expect("three images or more");
    // A renderer that does not take its step from the call makes one image several times.
    if rest
        .iter()
        .all(|image| image.radiance() == first.radiance())
    {
        let mut judgement = judge_one_step(truth, &first_order(&checked.scene), first);
        judgement.reason = format!(
            "all images are the same, whatever the step: does the renderer take it from {{step}} or \
             {{rate}}? {}",
            judgement.reason
        );
        let judgement = judgement.with_precision_of(truth.golden, first);
        return (
            judgement.with_changes_of(IMAGE, first),
            Picture::Radiance(first.clone()),
        );
    }
    let (judgement, limit) = judge_refinement(truth, images);
    let judgement = judgement.with_precision_of(truth.golden, &limit);
    (
        judgement.with_changes_of(IMAGE, first),
        Picture::Radiance(limit),
    )
}

/// Judges an image with the step of the scene.
pub fn judge_one(checked: &CheckedGolden, picture: &Picture) -> Judgement {
    let image = picture.radiance().expect("the gate is one of radiance");
    let truth = Limit {
        golden: &checked.golden.film,
        looked_up: &looked_up(&checked.scene),
    };
    judge_one_step(truth, &first_order(&checked.scene), image)
        .with_precision_of(truth.golden, image)
        .with_changes_of(IMAGE, image)
}

/// Entries of the smallest table in which renderers look up colours and opacities. With the nodes of
/// the scene's table at multiples of 1/255 it is exact; but one of another size rounds each kink, one of
/// corrected opacities each curve, and where values are taken for texture coordinates they are off by
/// up to half an entry.
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

/// Images of `scene` with samples at the beginning and at the end of each step.
fn first_order(scene: &Scene) -> [Film; 2] {
    [0.0, 1.0].map(|first_sample| {
        rendered(scene, |volume| {
            volume.sample();
            volume.conventions.first_sample = first_sample;
        })
    })
}

/// The image of `scene` with its volumes changed by `edit`.
fn rendered(scene: &Scene, edit: impl Fn(&mut Classified)) -> Film {
    let scene = scene.with_volumes(edit);
    let rendering = render(&plans(&scene), Sampling::default(), &|| ());
    // The golden was rendered likewise: of a classified volume nothing can fail.
    rendering.expect("a volume is rendered").film
}

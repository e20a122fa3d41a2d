//! What an image would look like, were a mistake made.

use super::cells::Cells;
use crate::compare::stochastic::BLOCK;
use crate::film::Film;
use crate::render::{Plan, render};
use crate::scene::{Model, Scene};

/// Seed of predictions: one that neither goldens nor renderings of users are likely to have.
const SEED: u64 = 0x7072_6564_6963_7400;

/// Samples in a cell of a first look, by which most mistakes are ruled out: a quarter of a sample
/// per pixel.
pub(super) const FIRST_LOOK: u32 = 16;

/// Samples in a cell of a second look, at what is left: four per pixel.
pub(super) const SECOND_LOOK: u32 = 256;

/// The image of `scene`, with a mistake in it, in coarse pixels if it is sampled and `coarse`;
/// then with that many samples in each. Nothing where it cannot be rendered.
pub(super) fn predicted(mut scene: Scene, coarse: bool, samples: u32) -> Option<Film> {
    let plans: Vec<Plan> = scene.panels.iter().map(Plan::new).collect();
    if coarse && plans.iter().all(Plan::is_sampled) && shrink(&mut scene) {
        scene.set_samples(samples);
    } else {
        scene.set_samples((samples / (BLOCK * BLOCK) as u32).max(2));
    }
    scene.set_seed(SEED);
    render(&scene, &plans, &|| ()).ok().map(|made| made.film)
}

/// Makes a pixel of every block; whether that could be.
fn shrink(scene: &mut Scene) -> bool {
    let divides = |size: usize| size.is_multiple_of(BLOCK);
    let can = |panel: &crate::scene::Panel| {
        divides(panel.width) && divides(panel.height) && matches!(panel.model, Model::Radiative(_))
    };
    if !scene.panels.iter().all(can) {
        return false;
    }
    for panel in &mut scene.panels {
        panel.width /= BLOCK;
        panel.height /= BLOCK;
    }
    true
}

/// `film`, predicted in coarse pixels or not, in the cells of an image of the size of `like`.
pub(super) fn in_cells(film: &Film, like: &Cells) -> Option<Cells> {
    let size = (like.columns, like.rows);
    [Cells::of_pixels, Cells::of_blocks]
        .into_iter()
        .map(|cells| cells(film))
        .find(|cells| (cells.columns, cells.rows) == size)
}

//! Renderings of a scene with a mistake, of as few pixels or samples as tell.

use super::clock::SearchClock;
use super::hypothesis::Hypothesis;
use super::prediction::{
    FIRST_LOOK, SECOND_LOOK, THIRD_LOOK, blocks, first_lattice, predicted, rays, work_of_a_ray,
};
use crate::compare::stochastic::BLOCK;
use crate::film::Film;
use crate::render::Detail;
use crate::scene::Scene;

/// Label of the scene as it is.
pub(super) const UNCHANGED: &str = "unchanged";

/// Pixels of a look, and samples in each.
pub(super) type Look = (Detail, u32);

/// Predictor of the images that mistakes in a scene make.
pub(super) struct Predictor {
    pub scene: Scene,
    /// Widths of its panels.
    pub widths: Vec<usize>,
    pub first: Look,
    pub second: Look,
    /// Work of a ray from the eye, in events.
    work_of_a_ray: f64,
}

impl Predictor {
    /// Predictor for a `scene` of so many `pixels`, with random samples or not.
    pub fn new(scene: Scene, pixels: usize, is_sampled: bool) -> Predictor {
        let (first, second) = match (is_sampled, blocks(&scene)) {
            (true, Some(blocks)) => ((blocks, FIRST_LOOK), (blocks, SECOND_LOOK)),
            (true, None) => (whole(FIRST_LOOK), whole(SECOND_LOOK)),
            (false, _) => {
                let (_, samples) = whole(SECOND_LOOK);
                ((first_lattice(pixels), samples), (Detail::Whole, samples))
            }
        };
        Predictor {
            widths: scene.panels.iter().map(|panel| panel.width).collect(),
            work_of_a_ray: work_of_a_ray(&scene, first),
            scene,
            first,
            second,
        }
    }

    /// Pixels of a third look, and samples in each.
    pub fn third(&self) -> Look {
        match self.second.0 {
            Detail::Whole => whole(THIRD_LOOK),
            blocks => (blocks, THIRD_LOOK),
        }
    }

    /// The [predicted] image of `edited`, if the search is to go on. Work is counted as if nothing were kept from
    /// other runs, so that the same search always gets as far.
    pub fn rendered(
        &self,
        edited: &Scene,
        label: (&str, u64),
        look: Look,
        clock: &SearchClock<'_>,
    ) -> Option<Film> {
        let work = self.work_of_a_ray * rays(&self.scene, look) as f64;
        clock.spend(work as u64).then_some(())?;
        predicted(&self.scene, edited, label, look, clock)
    }

    /// The image that `hypothesis` would make, of the scene or of its `golden`; nothing where it has no occasion, or where the
    /// search is to end.
    pub fn predict(
        &self,
        golden: &Film,
        hypothesis: &Hypothesis,
        mut look: Look,
        clock: &SearchClock<'_>,
    ) -> Option<Film> {
        let mistakes = hypothesis.mistakes();
        let mut scene = None;
        for mistake in mistakes.iter().filter(|m| !m.is_of_the_image()) {
            scene = Some(mistake.in_scene(scene.as_ref().unwrap_or(&self.scene))?);
        }
        let of_the_image: Vec<_> = mistakes.iter().filter(|m| m.is_of_the_image()).collect();
        if !of_the_image.is_empty() && matches!(look.0, Detail::Blocks(_)) {
            // Blocks are as they are only where no mistake moves pixels about.
            look = whole(look.1);
        }
        let mut film = match scene {
            Some(scene) => {
                let of_the_scene = mistakes.iter().filter(|m| !m.is_of_the_image());
                let names: Vec<&str> = of_the_scene.map(|mistake| mistake.name).collect();
                self.rendered(&scene, (&names.join(" + "), 0), look, clock)?
            }
            None => golden.clone(),
        };
        for mistake in of_the_image {
            film = mistake.in_image(&film)?;
        }
        Some(film)
    }
}

/// The whole image, with the samples of its blocks.
fn whole(samples: u32) -> Look {
    (Detail::Whole, (samples / (BLOCK * BLOCK) as u32).max(2))
}

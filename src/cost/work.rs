//! Images with their work and their times.

use super::timing::{Clock, Task, Times};
use crate::film::Film;
use crate::render::counters::PerEvent;
use crate::render::{Event, RenderError, Sampling, Seed, plans, render};
use crate::scene::Scene;

/// Work of a pixel, mean over all pixels, by event.
pub type MeanWork = PerEvent<f64>;

impl MeanWork {
    /// The number by which settings are compared: lookups of densities and gradients, or random
    /// numbers where nothing is looked up.
    pub fn price(&self) -> f64 {
        match self.lookups() {
            0.0 => self[Event::RandomDraw],
            lookups => lookups,
        }
    }

    /// Number of lookups of densities and gradients for each pixel.
    pub fn lookups(&self) -> f64 {
        self[Event::DensityLookup] + self[Event::GradientLookup]
    }
}

/// An image with its work and its time for each pixel.
pub(super) struct Measured {
    pub film: Film,
    pub work: MeanWork,
    pub time: Option<Times>,
}

/// Images of `scenes`, each of one panel and all of one size, as many as there is time for; then the times of these, by turns. The samples
/// per pixel are those of the scene if none are given. Each image has random numbers of its own, all by `seed`.
pub(super) fn measured(
    scenes: &[Scene],
    samples: Option<u32>,
    seed: u64,
    clock: &Clock,
) -> Result<Vec<Measured>, RenderError> {
    let sampling = |index: usize| Sampling {
        samples,
        seed: Seed::Given(seed.wrapping_add(index as u64)),
    };
    let mut images = Vec::new();
    for (index, scene) in scenes.iter().enumerate() {
        if clock.is_over() {
            break;
        }
        let made = render(&plans(scene), sampling(index), &|| ())?;
        let pixels = made.film.radiance().len() as f64;
        images.push(Measured {
            work: made.work[0].map(|count| count as f64 / pixels),
            film: made.film,
            time: None,
        });
    }
    let tasks = scenes.iter().enumerate().take(images.len());
    let tasks = tasks.map(|(index, scene)| -> Task<'_> {
        Box::new(move || {
            // It was rendered above, and refuses nothing that it did not then.
            let _ = std::hint::black_box(render(&plans(scene), sampling(index), &|| ()));
        })
    });
    let pixels = images
        .first()
        .map_or(1, |image| image.film.radiance().len());
    let times = clock.by_turns(&tasks.collect::<Vec<_>>(), pixels as f64);
    for (image, time) in images.iter_mut().zip(times) {
        image.time = time;
    }
    Ok(images)
}

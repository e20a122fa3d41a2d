//! Images of one scene under sets of conventions.

use crate::conventions::{NodeGradients, as_stored, ray_caster::RayCaster, under};
use crate::film::Film;
use crate::naming::likeness::{SearchStep, Stage, WORK_PER_SECOND, latest_end};
use crate::render::Detail;
use crate::scene::{Panel, Scene};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Images of a scene under sets of conventions, and the work that they take.
pub struct Images<'a> {
    scene: &'a Scene,
    /// Gradients at the nodes of the volume of each panel.
    gradients: Vec<NodeGradients>,
    work: AtomicU64,
    limit: Option<Limit>,
    watch: Watch<'a>,
}

/// Whoever waits for the search in the images of a case.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Name of the case.
    pub case: &'a str,
    /// True to stop at once.
    pub interrupted: &'a (dyn Fn() -> bool + Sync),
    /// Called before each thing that is tried.
    pub progress: &'a (dyn Fn(&SearchStep) + Sync),
}

/// Limit of a search.
struct Limit {
    /// Work, counted as that of a ray is: the same on any machine.
    work: u64,
    /// Latest end, on a machine that is far slower.
    end: Option<Instant>,
}

impl<'a> Images<'a> {
    /// Images of `scene`, with as much work as two cores do in these `seconds`.
    pub fn of(scene: &'a Scene, seconds: Option<f64>, watch: Watch<'a>) -> Images<'a> {
        let limit = |seconds: f64| Limit {
            work: (seconds * WORK_PER_SECOND) as u64,
            end: Duration::try_from_secs_f64(seconds)
                .ok()
                .and_then(latest_end),
        };
        Images {
            scene,
            gradients: scene
                .panels
                .iter()
                .map(|_| NodeGradients::default())
                .collect(),
            work: AtomicU64::new(0),
            limit: seconds.map(limit),
            watch,
        }
    }

    /// Work done.
    pub fn work(&self) -> u64 {
        self.work.load(Ordering::Relaxed)
    }

    /// Counts `work` that is about to be done elsewhere; false, and none of it is to be done, if it is beyond the limit.
    pub fn spend(&self, work: u64) -> bool {
        self.work.fetch_add(work, Ordering::Relaxed);
        !self.is_work_done()
    }

    /// Reports that `done` of so many things are tried.
    pub fn report(&self, stage: Stage, done: usize, of: usize) {
        let left = |limit: &Limit| limit.work.saturating_sub(self.work()) as f64 / WORK_PER_SECOND;
        (self.watch.progress)(&SearchStep {
            case: self.watch.case.to_owned(),
            stage,
            done,
            of,
            left: self.limit.as_ref().map(left).map(Duration::from_secs_f64),
        });
    }

    /// True after the work of the limit; to be asked where all images that were begun are done, as their order is
    /// not the same on all machines.
    pub fn is_work_done(&self) -> bool {
        let done = self.work();
        self.limit.as_ref().is_some_and(|limit| done >= limit.work) || self.is_late()
    }

    fn is_late(&self) -> bool {
        let end = self.limit.as_ref().and_then(|limit| limit.end);
        end.is_some_and(|end| Instant::now() >= end) || (self.watch.interrupted)()
    }

    /// The image under the conventions of `set`, with the step of the scene halved `halvings` times. `None` after the
    /// latest end.
    pub fn under(&self, set: &[usize], halvings: usize, detail: Detail) -> Option<Film> {
        let scene = under(self.scene, set).with_halved_steps(halvings);
        self.of_scene(&scene, detail)
    }

    /// The image of `scene`, the scene of this search under any conventions. `None` after the latest end.
    pub fn of_scene(&self, scene: &Scene, detail: Detail) -> Option<Film> {
        let panels = scene.panels.iter().zip(&self.gradients);
        let films = panels.map(|(panel, known)| {
            let [columns, rows]: [Vec<usize>; 2] = [
                detail.columns(panel.width).collect(),
                detail.rows(panel.height).collect(),
            ];
            let places = rows
                .iter()
                .flat_map(|&row| columns.iter().map(move |&column| [column, row]));
            let pixels = self.pixels(panel, known, &places.collect::<Vec<_>>())?;
            Some(Film::with_opacity(columns.len(), rows.len(), pixels))
        });
        Some(Film::side_by_side(&films.collect::<Option<Vec<Film>>>()?))
    }

    /// The pixels at `indices` of the image rendered under `set`, as one row.
    pub fn at(&self, set: &[usize], indices: &[usize]) -> Option<Film> {
        let scene = under(self.scene, set);
        let mut pixels = vec![[0.0; 4]; indices.len()];
        let mut left = 0;
        for (panel, known) in scene.panels.iter().zip(&self.gradients) {
            let place = |index: usize| [index % scene.width(), index / scene.width()];
            let own = (0..indices.len())
                .filter(|&at| (left..left + panel.width).contains(&place(indices[at])[0]));
            let own: Vec<usize> = own.collect();
            let places = own
                .iter()
                .map(|&at| place(indices[at]))
                .map(|[column, row]| [column - left, row]);
            let found = self.pixels(panel, known, &places.collect::<Vec<_>>())?;
            own.into_iter()
                .zip(found)
                .for_each(|(at, pixel)| pixels[at] = pixel);
            left += panel.width;
        }
        Some(Film::with_opacity(pixels.len(), 1, pixels))
    }

    /// The pixels of a panel at these columns and rows.
    fn pixels(
        &self,
        panel: &Panel,
        known: &NodeGradients,
        places: &[[usize; 2]],
    ) -> Option<Vec<[f32; 4]>> {
        let volume = as_stored(panel.classified()?);
        let caster = RayCaster::with_gradients(&volume, known);
        let pixel = |&place: &[usize; 2]| {
            let (pixel, work) = caster.pixel(place, [panel.width, panel.height]);
            self.work.fetch_add(work.total(), Ordering::Relaxed);
            (!self.is_late()).then_some(pixel)
        };
        places.par_iter().map(pixel).collect()
    }
}

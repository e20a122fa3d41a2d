//! Images of one scene under sets of conventions.

use crate::conventions::{NodeGradients, as_stored, ray_caster::RayCaster, under};
use crate::film::Film;
use crate::naming::likeness::{SLOWEST, WORK_PER_SECOND};
use crate::render::Detail;
use crate::scene::{Classified, Panel, Scene};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Images of a scene under sets of conventions, and the work that they take.
pub struct Images<'a> {
    /// The scene, with samples.
    scene: &'a Scene,
    /// Gradients at the nodes of the volume of each panel.
    gradients: Vec<NodeGradients>,
    work: AtomicU64,
    limit: Option<Limit>,
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
    pub fn of(scene: &'a Scene, seconds: Option<f64>) -> Images<'a> {
        let limit = |seconds: f64| Limit {
            work: (seconds * WORK_PER_SECOND) as u64,
            end: Duration::try_from_secs_f64(seconds * f64::from(SLOWEST))
                .ok()
                .and_then(|time| Instant::now().checked_add(time)),
        };
        Images {
            scene,
            gradients: scene.panels.iter().map(|_| NodeGradients::default()).collect(),
            work: AtomicU64::new(0),
            limit: seconds.map(limit),
        }
    }

    /// True after the work of the limit; to be asked where all images that were begun are done, as their order is
    /// not the same on all machines.
    pub fn is_work_done(&self) -> bool {
        let done = self.work.load(Ordering::Relaxed);
        self.limit.as_ref().is_some_and(|limit| done >= limit.work) || self.is_late()
    }

    fn is_late(&self) -> bool {
        let end = self.limit.as_ref().and_then(|limit| limit.end);
        end.is_some_and(|end| Instant::now() >= end)
    }

    /// The image under the conventions of `set`, with the step of the scene halved `halvings` times. `None` after the
    /// latest end.
    pub fn under(&self, set: &[usize], halvings: usize, detail: Detail) -> Option<Film> {
        let scene = under(self.scene, set).with_halved_steps(halvings);
        let panels = scene.panels.iter().zip(&self.gradients);
        let films = panels.map(|(panel, known)| self.panel(panel, panel.classified()?, known, detail));
        Some(Film::side_by_side(&films.collect::<Option<Vec<Film>>>()?))
    }

    fn panel(
        &self,
        panel: &Panel,
        volume: &Classified,
        known: &NodeGradients,
        detail: Detail,
    ) -> Option<Film> {
        let volume = as_stored(volume);
        let caster = RayCaster::with_gradients(&volume, known);
        let (width, height) = (panel.width, panel.height);
        let columns: Vec<usize> = detail.columns(width).collect();
        let rows: Vec<usize> = detail.rows(height).collect();
        let row = |&row: &usize| {
            let pixels = columns.iter().map(|&column| {
                let (pixel, work) = caster.pixel([column, row], [width, height]);
                self.work.fetch_add(work.total(), Ordering::Relaxed);
                pixel
            });
            (!self.is_late()).then(|| pixels.collect())
        };
        let pixels: Option<Vec<Vec<[f32; 4]>>> = rows.par_iter().map(row).collect();
        Some(Film::with_opacity(columns.len(), rows.len(), pixels?.concat()))
    }
}

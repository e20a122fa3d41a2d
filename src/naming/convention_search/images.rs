//! Images of one scene under sets of conventions.

use crate::conventions::{NodeGradients, RayCaster, under};
use crate::film::Film;
use crate::naming::diagnosis::SearchClock;
use crate::render::Detail;
use crate::scene::{Panel, Scene};
use rayon::prelude::*;

/// Images of a scene under sets of conventions, and the work that they take.
pub struct Images<'a> {
    pub scene: &'a Scene,
    pub clock: &'a SearchClock<'a>,
    /// Gradients at the nodes of the volume of each panel.
    gradients: Vec<NodeGradients>,
}

impl<'a> Images<'a> {
    /// Images of `scene` within the limit of this clock.
    pub fn of(scene: &'a Scene, clock: &'a SearchClock<'a>) -> Images<'a> {
        let gradients = scene.panels.iter().map(|_| NodeGradients::default());
        Images {
            gradients: gradients.collect(),
            scene,
            clock,
        }
    }

    /// The image under the conventions of `set`. `None` after the latest end.
    pub fn under(&self, set: &[usize], detail: Detail) -> Option<Film> {
        self.of_scene(&under(self.scene, set), detail)
    }

    /// The image of `scene`, the scene of this search under any conventions. `None` after the latest end.
    pub fn of_scene(&self, scene: &Scene, detail: Detail) -> Option<Film> {
        let panels = scene.panels.iter().zip(&self.gradients);
        let films = panels.map(|(panel, known)| self.of_panel(panel, known, detail));
        Some(Film::side_by_side(&films.collect::<Option<Vec<Film>>>()?))
    }

    fn of_panel(&self, panel: &Panel, known: &NodeGradients, detail: Detail) -> Option<Film> {
        let caster = RayCaster::with_gradients(panel.classified()?, Some(known));
        let columns: Vec<usize> = detail.places(panel.width).collect();
        let rows: Vec<usize> = detail.places(panel.height).collect();
        let pixel = |index: usize| {
            let place = [columns[index % columns.len()], rows[index / columns.len()]];
            let (pixel, work) = caster.pixel(place, [panel.width, panel.height]);
            self.clock.spend(work.total());
            (!self.clock.is_stopped()).then_some(pixel)
        };
        let pixels = (0..columns.len() * rows.len()).into_par_iter().map(pixel);
        let pixels = pixels.collect::<Option<Vec<[f32; 4]>>>()?;
        Some(Film::with_opacity(columns.len(), rows.len(), pixels))
    }
}

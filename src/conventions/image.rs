//! Images under conventions of other renderers.

use super::ray_caster::RayCaster;
use crate::film::Film;
use crate::scene::{Classified, Scene};
use rayon::prelude::*;

/// The image of `scene`: radiance, background included, and the opacity of the volume in front of
/// it; one ray through the centre of each pixel.
pub fn render(scene: &Classified, size: [usize; 2]) -> Film {
    let [width, height] = size;
    let caster = RayCaster::new(scene);
    let pixels = (0..width * height).into_par_iter();
    let pixels = pixels.map(|index| caster.pixel([index % width, index / width], size).0);
    Film::with_opacity(width, height, pixels.collect())
}

/// The images of `scenes`; `None` if a panel is no classified volume.
pub(super) fn render_all(scenes: &[Scene]) -> Option<Vec<Film>> {
    let image = |scene: &Scene| {
        let panels = scene.panels.iter();
        let panels =
            panels.map(|panel| Some(render(panel.classified()?, [panel.width, panel.height])));
        Some(Film::side_by_side(&panels.collect::<Option<Vec<Film>>>()?))
    };
    scenes.iter().map(image).collect()
}

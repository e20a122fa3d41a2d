//! Images under conventions of other renderers.

use super::field_caster::FieldCaster;
use super::ray_caster::RayCaster;
use super::several::{CommonSteps, each_alone};
use super::stored_values::as_stored;
use crate::film::Film;
use crate::scene::{Classified, Mode, Scene};
use rayon::prelude::*;

/// The image of `scene`: radiance, background included, and the opacity of the volume in front of
/// it; one ray through the centre of each pixel.
pub fn render(scene: &Classified, size: [usize; 2]) -> Film {
    let [width, height] = size;
    let pixels = (0..width * height).into_par_iter();
    let pixels = pixels.map(|index| [index % width, index / width]);
    let pixels = if scene.volume_count() > 1 {
        let volumes = each_alone(scene);
        let caster = CommonSteps::new(scene, &volumes);
        pixels.map(|pixel| caster.pixel(pixel, size).0).collect()
    } else if scene.mode == Mode::Composited {
        let scene = as_stored(scene);
        let caster = RayCaster::new(&scene);
        pixels.map(|pixel| caster.pixel(pixel, size).0).collect()
    } else {
        let caster = FieldCaster::new(scene);
        let ray = |pixel| scene.camera.ray(pixel, size);
        pixels.map(|pixel| caster.pixel(&ray(pixel)).0).collect()
    };
    Film::with_opacity(width, height, pixels)
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

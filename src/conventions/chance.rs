//! Images that bound those of a renderer that leaves something to chance or to rounding.

use super::first_samples::scenes_of_first_samples;
use super::image::render_all;
use super::rounded_places::scenes_of_rounded_places;
use crate::film::Film;
use crate::scene::Scene;

/// The images of `scene` with each choice that the caster leaves to chance or to rounding made in turn; `None` if there
/// is none, or a panel is no classified volume.
pub fn images_by_chance(scene: &Scene) -> Option<Vec<Film>> {
    render_all(&scenes_by_chance(scene)?)
}

/// `scene` with each choice that the caster leaves to chance or to rounding made in turn; `None` if there is none.
pub(crate) fn scenes_by_chance(scene: &Scene) -> Option<Vec<Scene>> {
    scenes_of_first_samples(scene).or_else(|| scenes_of_rounded_places(scene))
}

/// Least and largest value of each channel in `images`, of one size: every pixel of a right image lies between them.
pub fn bounds(images: &[Film]) -> [Film; 2] {
    [
        combined(images, |values| {
            values.fold(f64::INFINITY, |least, value| least.min(value.into()))
        }),
        combined(images, |values| {
            values.fold(f64::NEG_INFINITY, |most, value| most.max(value.into()))
        }),
    ]
}

/// Means of `images` of all random places, by the trapezoid rule.
pub fn mean_of_places(images: &[Film]) -> Film {
    combined(images, |values| {
        let values: Vec<f64> = values.map(f64::from).collect();
        let ends = 0.5 * (values[0] + values[values.len() - 1]);
        (values.iter().sum::<f64>() - ends) / (values.len() - 1) as f64
    })
}

/// The image with a `value` of the values in `images` for each channel.
fn combined(images: &[Film], value: fn(&mut dyn Iterator<Item = f32>) -> f64) -> Film {
    let pixels = (0..images[0].radiance().len()).map(|index| {
        let pixels: Vec<[f32; 4]> = images.iter().map(|image| image.pixel(index)).collect();
        [0, 1, 2, 3].map(|channel| value(&mut pixels.iter().map(|pixel| pixel[channel])) as f32)
    });
    Film::with_opacity(images[0].width(), images[0].height(), pixels.collect())
}

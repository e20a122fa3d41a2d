//! Images of all places of the first sample of a ray, for renderers that choose it at random.

use super::image::render_all;
use crate::film::Film;
use crate::scene::{Fault, Panel, Scene};

/// Places of the first sample, at equal distances, the first and the last a whole step apart.
const PLACES: u32 = 33;

/// Least and largest value and mean of each channel over all places of the first sample.
///
/// An image with jitter has every pixel between `lower` and `upper`, and on average that of `mean`. The
/// places are 33 of infinitely many: where a sample enters or leaves the volume between two of them,
/// the bounds are off by the part of its step that is not seen.
#[derive(Clone, Debug)]
pub struct FirstSamples {
    /// Least values.
    pub lower: Film,
    /// Largest values.
    pub upper: Film,
    /// Means, by the trapezoid rule.
    pub mean: Film,
}

/// The images of `scene` with each place of the first sample in turn; `None` if no ray there has a random
/// one, or a panel is no classified volume.
pub fn images_of_first_samples(scene: &Scene) -> Option<FirstSamples> {
    let images = render_all(&scenes_of_first_samples(scene)?)?;
    let [lower, upper] = bounds(&images);
    Some(FirstSamples {
        lower,
        upper,
        mean: combined(&images, |values| {
            let values: Vec<f64> = values.map(f64::from).collect();
            let ends = 0.5 * (values[0] + values[values.len() - 1]);
            (values.iter().sum::<f64>() - ends) / f64::from(PLACES - 1)
        }),
    })
}

/// `scene` with each place of the first sample in turn; `None` if no ray has a random one.
pub(super) fn scenes_of_first_samples(scene: &Scene) -> Option<Vec<Scene>> {
    let mut volumes = scene.panels.iter().filter_map(Panel::classified);
    if !volumes.any(|volume| volume.conventions.is_random()) {
        return None;
    }
    let places = (0..PLACES).map(|place| f64::from(place) / f64::from(PLACES - 1));
    Some(places.map(|place| at_place(scene, place)).collect())
}

/// Least and largest value of each channel in `images`, of one size.
pub(crate) fn bounds(images: &[Film]) -> [Film; 2] {
    [
        combined(images, |values| {
            values.fold(f64::INFINITY, |least, value| least.min(value.into()))
        }),
        combined(images, |values| {
            values.fold(f64::NEG_INFINITY, |most, value| most.max(value.into()))
        }),
    ]
}

/// The image with a `value` of the values in `images` for each channel.
fn combined(images: &[Film], value: fn(&mut dyn Iterator<Item = f32>) -> f64) -> Film {
    let pixels = (0..images[0].radiance().len()).map(|index| {
        let pixels: Vec<[f32; 4]> = images.iter().map(|image| image.pixel(index)).collect();
        [0, 1, 2, 3].map(|channel| value(&mut pixels.iter().map(|pixel| pixel[channel])) as f32)
    });
    Film::with_opacity(images[0].width(), images[0].height(), pixels.collect())
}

/// `scene` with every first sample, or first step, at `place`.
fn at_place(scene: &Scene, place: f64) -> Scene {
    scene.with_volumes(|volume| {
        let conventions = &mut volume.conventions;
        if conventions.has_random_place() {
            (conventions.jitter, conventions.unstated_first_sample) = (false, false);
            conventions.first_sample = place;
        }
        if conventions.first_step_jitter {
            conventions.first_step_jitter = false;
            conventions.fault = Some(Fault::FirstStep(place));
        }
    })
}

//! Images of renderers that place the samples of a ray at random, or round their places.
//!
//! Nobody knows their random numbers, but a right image has every pixel among the images of all places, and
//! the mean of them on average.

use crate::compare::Picture;
use crate::compare::deterministic::tolerance_of_mean;
use crate::conventions::{bounds, images_by_chance, mean_of_places};
use crate::film::Film;
use crate::math::Sum;
use crate::scene::{Panel, Scene};

/// Largest number of pixels with random numbers of their own. Renderers for graphics cards repeat a texture of
/// noise; that of vtk.js has 32 × 32 pixels.
const INDEPENDENT: f64 = 1024.0;

/// Standard errors that the mean of an image may be off by: once in 10⁹ a right one is further off.
const ERRORS: f64 = 6.0;

/// The right image of `scene` that is nearest to `test`: each pixel of `test`, moved into the range of those of
/// all places of the samples. Where the mean of `test` is off by more than chance, the mean of that range, so that
/// the gate sees the difference. `None` if nothing in the scene is random or rounded, or `test` is no radiance of
/// its size.
pub fn nearest(scene: &Scene, test: &Picture) -> Option<Film> {
    let test = test.radiance()?;
    let images = images_by_chance(scene)?;
    let bounds = bounds(&images);
    if !bounds[0].is_comparable(test) {
        return None;
    }
    let mut volumes = scene.panels.iter().filter_map(Panel::classified);
    if volumes.any(|volume| volume.conventions.is_jittered()) {
        let mean = mean_of_places(&images);
        // A value that was rounded lies within half a code of what it was.
        if !is_mean_by_chance(&bounds, &mean, &test.nearest_to(&mean)) {
            return Some(mean);
        }
    }
    Some(within(&bounds, test))
}

/// `test` with each value moved into that of both images, in linear light.
pub(crate) fn within(bounds: &[Film; 2], test: &Film) -> Film {
    let pixels = (0..test.radiance().len()).map(|index| {
        let channel = |c: usize| {
            let [lower, upper] = bounds.each_ref().map(|film| film.radiance()[index][c]);
            test.radiance()[index][c].clamp(lower, upper.max(lower))
        };
        std::array::from_fn(channel)
    });
    Film::new(test.width(), test.height(), pixels.collect())
}

/// Whether the image is a random choice among the possible sample offsets, within noise and gate.
fn is_mean_by_chance([lower, upper]: &[Film; 2], all: &Film, test: &Film) -> bool {
    let count = test.radiance().len();
    (0..3).all(|c| {
        let (mut off, mut variance, mut right) = (Sum::default(), Sum::default(), Sum::default());
        for index in 0..count {
            let of = |film: &Film| f64::from(film.radiance()[index][c]);
            // No distribution within a range has more variance than its ends, each with half of the chance.
            let half = 0.5 * (of(upper) - of(lower));
            off.add(of(test) - of(all));
            variance.add(half * half);
            right.add(of(all));
        }
        let mean = |sum: &Sum| sum.value() / count as f64;
        let independent = INDEPENDENT.min(count as f64);
        let chance = ERRORS * (mean(&variance) / independent).sqrt();
        mean(&off).abs() <= chance + tolerance_of_mean(mean(&right))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Film;
    use crate::scene::Scene;
    use crate::suite::Suite;

    /// The scene of `sampled/thin` with samples at places of the caller.
    fn scene(jitter: bool, first_sample: f64) -> Scene {
        let suite = Suite::bundled().unwrap();
        let cases = suite.select(&["sampled/thin".to_owned()]).unwrap();
        cases[0].load_scene().unwrap().with_volumes(|volume| {
            volume.conventions.jitter = jitter;
            volume.conventions.first_sample = first_sample;
        })
    }

    fn rendered(scene: &Scene) -> Film {
        use crate::render::{Sampling, plans, render};
        render(&plans(scene), Sampling::default(), &|| ())
            .unwrap()
            .film
    }

    #[test]
    fn images_with_random_samples_are_their_own_nearest() {
        let random = scene(true, 0.5);
        let [own, other] = [&random, &scene(false, 0.31)].map(rendered);
        let same = |film: &Film| {
            let nearest = nearest(&random, &Picture::Radiance(film.clone())).unwrap();
            let pairs = nearest.radiance().iter().zip(film.radiance());
            let off = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > 2e-3);
            pairs.filter(|&(a, b)| off((a, b))).count()
        };
        assert_eq!(same(&own), 0);
        // One place for all rays is a random one, if the mean is by chance near that of all.
        assert_eq!(same(&other), 0);
        // A brighter image is not.
        let brighter = own
            .radiance()
            .iter()
            .map(|pixel| pixel.map(|value| 1.2 * value));
        let brighter = Film::new(own.width(), own.height(), brighter.collect());
        assert!(same(&brighter) > 0);
        assert!(nearest(&scene(false, 0.5), &Picture::Radiance(own)).is_none());
    }
}

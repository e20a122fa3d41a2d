//! Cost of the size of pixels: their centres in place of their areas.

use super::classified::{Shade, ShadedVolume, has_jumps};
use super::norms::root_mean_square;
use super::order::ExpectedOrder;
use super::results::{Parameter, Study};
use super::study::{PlannedSweep, Setting, SettingOutcome, SettingRun, Truth};
use super::timing::Clock;
use crate::geometry::{Camera, Ray};
use crate::math::Sum;
use crate::render::Counters;
use crate::scene::Classified;
use glam::DVec3;
use rayon::prelude::*;

/// Zoom on the middle of the image: only there do pixels become finer than the data.
const ZOOM: usize = 32;

/// Pixels of a side of that part.
const SIDES: [usize; 6] = [2, 4, 8, 16, 32, 64];

/// Points on a side of the finest image, by which areas are known.
const FINE: usize = 512;

/// Smallest opacity with which a volume has a silhouette.
const OPAQUE: f64 = 0.99;

/// Samples of every ray are as far apart as the scene says: pixels are compared with pixels.
///
/// Neither shaded nor shadowed: a highlight may be narrower than any pixel.
pub fn study(scene: &Classified, size: [usize; 2], clock: &Clock) -> Study {
    let scene = &Classified {
        phong: None,
        shadow: None,
        ..scene.clone()
    };
    let subject = &ShadedVolume::new(scene, Shade::None);
    let window = &Window::in_the_middle(&scene.camera, size);
    let fine = &FineImage::of(subject, scene, window);
    let channels = fine.0.iter().flat_map(|point| point.radiance.to_array());
    let scale = root_mean_square(channels);
    let sweep = |masked: bool| {
        let setting = |side: usize| {
            let run: SettingRun<'_> = Box::new(move || SettingOutcome {
                // Finer pixels are more rays: work is shared among pixels of the scene.
                rays: ((window.size[0] * window.size[1]).round() as usize).max(1),
                ..SettingOutcome::of_rays(side * side, &|index, work| {
                    let (x, y) = (index % side, index / side);
                    let centre = subject.cast(scene.step, &window.ray(side, x, y), work);
                    let (mean, whole) = fine.area(side, x, y);
                    (whole || !masked).then(|| (centre - mean).to_array())
                })
            });
            let edge = window.size[0] / side as f64;
            Setting::new(format!("{edge} pixels"), edge, run)
        };
        let masking = if masked { ", silhouettes left out" } else { "" };
        PlannedSweep {
            estimator: format!("centres of pixels{masking}"),
            is_ours: true,
            parameter: Parameter::Pixel,
            expected: match masked && !has_jumps(scene) {
                true => ExpectedOrder::of_step(2.0),
                false => ExpectedOrder::NOTHING,
            },
            settings: SIDES.map(setting).into(),
        }
    };
    let mut planned = vec![sweep(true)];
    if fine.has_silhouettes() {
        planned.push(sweep(false));
    }
    let truth = Truth {
        method: format!("means over {FINE} × {FINE} points"),
        scale,
        // The mean of n × n points is itself off by 1/n² of what their middle is: 1/64 at most
        // here. A reference that is a 64th off tells orders to within 0.03.
        bound: 1e-9,
        judged: None,
    };
    let quantity = format!(
        "radiance of the middle of the image, a thirty-second of it wide, neither shaded nor \
         shadowed: centre of a pixel for its area, in pixels of {} × {}",
        size[0], size[1]
    );
    Study::of("pixels", quantity, truth, &planned, &clock.untimed())
}

/// The part of an image around its middle.
struct Window<'s> {
    camera: &'s Camera,
    /// Size of the image, pixels.
    image: [usize; 2],
    /// First corner and size of the part, pixels.
    corner: [f64; 2],
    size: [f64; 2],
}

impl Window<'_> {
    fn in_the_middle(camera: &Camera, image: [usize; 2]) -> Window<'_> {
        let size = image.map(|pixels| pixels as f64 / ZOOM as f64);
        Window {
            camera,
            image,
            corner: [0, 1].map(|axis| (image[axis] as f64 - size[axis]) / 2.0),
            size,
        }
    }

    /// The ray through the middle of cell (x, y) of the window, cut into `side` × `side`.
    fn ray(&self, side: usize, x: usize, y: usize) -> Ray {
        let at = |axis: usize, index: usize| {
            self.corner[axis] + self.size[axis] * (index as f64 + 0.5) / side as f64
        };
        self.camera.ray_through([at(0, x), at(1, y)], self.image)
    }
}

/// A window by [`FINE`] × [`FINE`] points.
struct FineImage(Vec<FinePoint>);

struct FinePoint {
    radiance: DVec3,
    /// The ray meets the volume.
    hits: bool,
    /// The volume is not opaque there.
    is_clear: bool,
}

impl FineImage {
    fn of(subject: &ShadedVolume<'_>, scene: &Classified, window: &Window<'_>) -> FineImage {
        let points = (0..FINE * FINE).into_par_iter().map(|index| {
            let ray = window.ray(FINE, index % FINE, index / FINE);
            let layers = subject.layers(scene.step, &ray, &mut Counters::default());
            FinePoint {
                radiance: layers.before(scene.background),
                hits: subject.span(&ray).is_some(),
                is_clear: layers.opacity < OPAQUE,
            }
        });
        FineImage(points.collect())
    }

    /// Mean over a pixel, and whether no silhouette is in it: all of it meets the volume or none,
    /// and nothing in it is opaque.
    fn area(&self, side: usize, x: usize, y: usize) -> (DVec3, bool) {
        let edge = FINE / side;
        let mut sums = [Sum::default(); 3];
        let (mut hits, mut clear) = (0, true);
        for row in y * edge..(y + 1) * edge {
            for point in &self.0[row * FINE..][x * edge..(x + 1) * edge] {
                hits += usize::from(point.hits);
                clear &= point.is_clear;
                let channels = sums.iter_mut().zip(point.radiance.to_array());
                channels.for_each(|(sum, value)| sum.add(value));
            }
        }
        let count = edge * edge;
        let mean = DVec3::from_array(sums.map(|sum| sum.value() / count as f64));
        (mean, clear && (hits == 0 || hits == count))
    }

    fn has_silhouettes(&self) -> bool {
        let hits = self.0.iter().filter(|point| point.hits).count();
        hits % self.0.len() != 0 || self.0.iter().any(|point| !point.is_clear)
    }
}

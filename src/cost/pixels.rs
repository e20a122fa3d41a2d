//! Cost of the size of pixels: their centres in place of their areas.

use super::classified::{Shade, ShadedVolume, has_jumps};
use super::norms::root_mean_square;
use super::order::ExpectedOrder;
use super::results::{Parameter, Study};
use super::study::{PlannedSweep, Setting, SettingOutcome, SettingRun, Truth};
use super::timing::Clock;
use crate::geometry::Ray;
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
    let subject = ShadedVolume::new(scene, Shade::None);
    let window = [size[0] as f64 / ZOOM as f64, size[1] as f64 / ZOOM as f64];
    let corner = [
        (size[0] as f64 - window[0]) / 2.0,
        (size[1] as f64 - window[1]) / 2.0,
    ];
    // The ray through the middle of cell (x, y) of a window cut into `side` × `side`.
    let ray = |side: usize, x: usize, y: usize| -> Ray {
        let at = |axis: usize, index: usize| {
            corner[axis] + window[axis] * (index as f64 + 0.5) / side as f64
        };
        scene.camera.ray_through([at(0, x), at(1, y)], size)
    };
    let fine: Vec<(DVec3, bool, bool)> = (0..FINE * FINE)
        .into_par_iter()
        .map(|index| {
            let ray = ray(FINE, index % FINE, index / FINE);
            let layers = subject.layers(scene.step, &ray, &mut Counters::default());
            let seen = layers.before(scene.background);
            let is_clear = layers.opacity < OPAQUE;
            (seen, subject.span(&ray).is_some(), is_clear)
        })
        .collect();
    let scale = root_mean_square(fine.iter().flat_map(|(radiance, ..)| radiance.to_array()));
    // Mean over a pixel, and whether no silhouette is in it: all of it meets the volume or none,
    // and nothing in it is opaque.
    let area = |side: usize, x: usize, y: usize| -> (DVec3, bool) {
        let edge = FINE / side;
        let mut sums = [Sum::default(); 3];
        let (mut hits, mut clear) = (0, true);
        for row in y * edge..(y + 1) * edge {
            for (radiance, hit, is_clear) in &fine[row * FINE..][x * edge..(x + 1) * edge] {
                hits += usize::from(*hit);
                clear &= is_clear;
                let channels = sums.iter_mut().zip(radiance.to_array());
                channels.for_each(|(sum, value)| sum.add(value));
            }
        }
        let count = edge * edge;
        let mean = DVec3::from_array(sums.map(|sum| sum.value() / count as f64));
        (mean, clear && (hits == 0 || hits == count))
    };
    let (area, ray, subject) = (&area, &ray, &subject);
    let sweep = |masked: bool| {
        let setting = |side: usize| {
            let run: SettingRun<'_> = Box::new(move || SettingOutcome {
                // Finer pixels are more rays: work is shared among pixels of the scene.
                rays: ((window[0] * window[1]).round() as usize).max(1),
                ..SettingOutcome::of_rays(side * side, &|index, work| {
                    let (x, y) = (index % side, index / side);
                    let centre = subject.cast(scene.step, &ray(side, x, y), work);
                    let (mean, whole) = area(side, x, y);
                    (whole || !masked).then(|| (centre - mean).to_array())
                })
            });
            let edge = window[0] / side as f64;
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
    let hits = fine.iter().filter(|(_, hit, _)| *hit).count();
    if hits % fine.len() != 0 || fine.iter().any(|(.., is_clear)| !is_clear) {
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

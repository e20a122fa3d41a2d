//! The two renderers of surfaces and media over the pixels of an image.

use super::context::Scratch;
use super::line_of_sight::{LineOfSight, TOLERANCE};
use super::path_tracer::{PathFault, PathTracer};
use super::sampler::Sampler;
use super::scene_context::SceneContext;
use crate::math::Moments;
use crate::math::rng::{Purpose, Stream};
use crate::render::counters::Counters;
use crate::render::pixels::{Pixels, rows};
use crate::render::plan::RadiativeFeatures;
use crate::render::progress::SAMPLES_A_STEP;
use crate::scene::Radiative;
use glam::DVec3;
use std::sync::atomic::{AtomicU32, Ordering};

/// The radiance of each pixel by integrals along the line of sight; `scattering`: light is scattered, once.
pub(in crate::render) fn integrate(
    scene: &Radiative,
    features: RadiativeFeatures,
    scattering: bool,
    pixels: &Pixels<'_>,
) -> (Vec<Result<[f32; 3], PathFault>>, Counters) {
    let renderer = LineOfSight {
        scene: SceneContext::for_integrals(scene, features),
        scattering,
        tolerance: TOLERANCE,
    };
    let size = [pixels.width, pixels.height];
    rows(pixels, Scratch::default, |pixel, scratch, work| {
        let ray = scene.camera.ray(pixel, size);
        let radiance = renderer.radiance(&ray, scratch, work);
        finite(radiance).map(|radiance| radiance.as_vec3().to_array())
    })
}

/// The moments of the samples of each pixel, by channel: paths of at most `max_order` scatterings, each through a
/// random point of its pixel.
pub(in crate::render) fn trace(
    scene: &Radiative,
    features: RadiativeFeatures,
    max_order: Option<u32>,
    seed: u64,
    pixels: &Pixels<'_>,
) -> (Vec<Result<[Moments; 3], PathFault>>, Counters) {
    let tracer = PathTracer::new(scene, max_order, features);
    let size = [pixels.width, pixels.height];
    let edge = pixels.detail.edge();
    // The first pixel, in the order of the image, that has a path without an end. Each such path takes seconds, and
    // one of them makes the image worthless: those after it need not be traced. All before it are, so on any number
    // of threads the same one is found.
    let first_endless = AtomicU32::new(u32::MAX);
    rows(pixels, Scratch::default, |[column, row], scratch, work| {
        let index = (row * size[0] + column) as u32;
        if first_endless.load(Ordering::Relaxed) < index {
            return Err(PathFault::Endless);
        }
        let mut moments = [Moments::default(); 3];
        for sample in 0..pixels.samples {
            let mut sampler = Sampler::new(Stream::new(seed, index, sample));
            let [x, y] = sampler.pair(Purpose::Camera, 0);
            let place = [column as f64 + edge * x, row as f64 + edge * y];
            let ray = scene.camera.ray_through(place, size);
            let radiance = tracer.radiance(ray, sampler, scratch, work);
            if radiance == Err(PathFault::Endless) {
                first_endless.fetch_min(index, Ordering::Relaxed);
            }
            let radiance = finite(radiance?)?;
            for (moments, channel) in moments.iter_mut().zip(radiance.to_array()) {
                moments.add(channel);
            }
            if (sample + 1) % SAMPLES_A_STEP == 0 {
                pixels.progress.step();
            }
        }
        Ok(moments)
    })
}

/// A radiance that overflows has no mean: together with others it would become NaN.
fn finite(radiance: DVec3) -> Result<DVec3, PathFault> {
    if radiance.to_array().contains(&f64::INFINITY) {
        Err(PathFault::Infinite)
    } else {
        Ok(radiance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_without_bound_is_no_radiance() {
        let red = DVec3::new(f64::INFINITY, 0.0, 1.0);
        assert_eq!(finite(red), Err(PathFault::Infinite));
        assert_eq!(finite(DVec3::MAX), Ok(DVec3::MAX));
    }
}

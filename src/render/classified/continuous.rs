//! The image of a classified volume without samples: the integral of
//! [`reference::continuous`](crate::reference::continuous) in each pixel.

use crate::reference::continuous::{RayIntegrator, pixel};
use crate::render::counters::{Event, Work};
use crate::render::pixels::{Pixels, rows};
use crate::scene::Classified;

/// A pixel: radiance and opacity, and the bound on the error of its radiance.
pub(in crate::render) type BoundedPixel = ([f32; 4], f64);

/// The pixels of `scene`.
pub(in crate::render) fn integrate<W: Work>(
    scene: &Classified,
    pixels: &Pixels<'_>,
) -> (Vec<BoundedPixel>, W) {
    let integrator = RayIntegrator::new(scene);
    let size = [pixels.width, pixels.height];
    rows(
        pixels,
        || (),
        |position, _, (), work: &mut W| {
            let integral = integrator.along(&scene.camera.ray(position, size));
            work.count_times(Event::CellWalked, integral.cells);
            work.count_times(Event::DensityLookup, integral.cells);
            work.count_times(Event::Attenuation, integral.points);
            work.count_times(Event::EmissionTerm, integral.points);
            (pixel(&integral.light), integral.light.radiance_error)
        },
    )
}

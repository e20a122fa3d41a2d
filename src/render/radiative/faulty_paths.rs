//! Paths with a mistake, in place of those of the path tracer.

use super::path_tracer::PathFault;
use crate::faulty_tracer::{EndlessPath, FaultyTracer};
use crate::math::Moments;
use crate::render::counters::Counters;
use crate::render::pixels::{Pixels, each};
use crate::scene::{Radiative, TransportFault};

/// The moments of the samples of each pixel, by channel, of a tracer that makes the mistake `fault`.
pub(in crate::render) fn trace(
    scene: &Radiative,
    fault: TransportFault,
    seed: u64,
    pixels: &Pixels<'_>,
) -> (Vec<Result<[Moments; 3], PathFault>>, Counters) {
    let tracer = FaultyTracer::new(scene, Some(fault));
    let (size, edge) = ([pixels.width, pixels.height], pixels.detail.edge());
    each(pixels, |pixel, _| {
        let moments = tracer.pixel(pixel, size, edge, (seed, pixels.samples));
        moments.map_err(|EndlessPath| PathFault::Endless)
    })
}

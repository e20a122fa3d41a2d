//! Point clouds as volumes: read from Wavefront OBJ, splatted to a grid.

use super::error::VolumeFault;
use super::load_options::LoadOptions;
use super::obj_points::read_obj_points;
use super::samples::{Stored, VolumeRead};
use super::source::VolumeSource;
use super::splat::splat;
use crate::geometry::Aabb;
use std::io::Read;

/// Largest point cloud read, in bytes: 4 GiB, some hundred million points.
const MOST_BYTES: u64 = 1 << 32;

pub(super) fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let bytes = source.remaining();
    if bytes > MOST_BYTES {
        return Err(VolumeFault::from(format!(
            "the file has {bytes} bytes, and point clouds of at most {MOST_BYTES} are read: thin \
             it out"
        )));
    }
    let mut bytes = Vec::new();
    source.take(MOST_BYTES).read_to_end(&mut bytes)?;
    let points = read_obj_points(&bytes)?;
    drop(bytes);
    let grid = splat(&points, options.splatting)?;
    let extent = Aabb::around(points.iter().map(|point| point.position));
    let stored = Stored::Cloud {
        points: points.len(),
        extent: extent.expect("a point"),
    };
    Ok((grid, stored))
}

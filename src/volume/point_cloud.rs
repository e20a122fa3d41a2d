//! Point clouds as volumes: read from Wavefront OBJ, splatted to a grid.

use super::load_options::LoadOptions;
use super::obj_points::read_obj_points;
use super::samples::{Stored, VolumeRead};
use super::source::VolumeSource;
use super::splat::splat;
use crate::geometry::Aabb;

/// Largest point cloud read, in bytes: 4 GiB, some hundred million points.
const MOST_BYTES: u64 = 1 << 32;

pub(super) fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let points = read_obj_points(&source.all(MOST_BYTES, "thin the cloud out")?)?;
    let grid = splat(&points, options.splatting)?;
    let extent = Aabb::around(points.iter().map(|point| point.position));
    let stored = Stored::Cloud {
        points: points.len(),
        extent: extent.expect("a point"),
    };
    Ok((grid, stored))
}

//! Point clouds as volumes: read from Wavefront OBJ, splatted to a grid.

use super::error::VolumeError;
use super::grid::Grid;
use super::load_options::LoadOptions;
use super::obj_points::read_obj_points;
use super::reader::{Stored, VolumeReader};
use super::source::VolumeSource;
use super::splat::splat;
use crate::geometry::Aabb;
use glam::DVec3;

/// Largest point cloud read, in bytes: 4 GiB, some hundred million points.
const MOST_BYTES: u64 = 1 << 32;

/// Reader of point clouds in Wavefront OBJ. The splatted grid has the maximum 1.
#[derive(Clone, Copy, Debug)]
pub struct PointCloud;

impl VolumeReader for PointCloud {
    fn name(&self) -> &'static str {
        "point cloud (Wavefront OBJ)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &[".obj"]
    }

    fn is_point_cloud(&self) -> bool {
        true
    }

    fn read(
        &self,
        source: &mut VolumeSource,
        options: &LoadOptions,
    ) -> Result<(Grid<f32>, Stored), VolumeError> {
        if source.length() > MOST_BYTES {
            return Err(VolumeError::TooLarge {
                path: source.path().to_owned(),
                bytes: source.length(),
                most: MOST_BYTES,
            });
        }
        let bytes = source.bytes(MOST_BYTES)?;
        let points = match read_obj_points(&bytes) {
            Ok(points) => points,
            Err(error) if error.position.is_some() => return Err(source.fault_in_line(error)),
            Err(error) => return Err(source.fault(error)),
        };
        drop(bytes);
        let grid = splat(&points, options.splatting).map_err(|error| VolumeError::Splat {
            path: source.path().to_owned(),
            error,
        })?;
        let first = points[0].position;
        let around = |(min, max): (DVec3, DVec3), position| (min.min(position), max.max(position));
        let positions = points.iter().map(|point| point.position);
        let (min, max) = positions.fold((first, first), around);
        let stored = Stored::Cloud {
            points: points.len(),
            extent: Aabb { min, max },
        };
        Ok((grid, stored))
    }
}

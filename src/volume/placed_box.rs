//! The box of a volume, wherever a map places it in the world.

use super::Lattice;
use crate::geometry::{Aabb, Line, Ray, Span, Transform, length_of};
use glam::DVec3;

/// A box, and the map that places it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedBox {
    /// The box in the coordinates of the volume.
    pub bounds: Aabb,
    /// The map to the world; none where they are the same.
    pub to_world: Option<Transform>,
}

impl From<Aabb> for PlacedBox {
    /// A box that stands in the world as it is.
    fn from(bounds: Aabb) -> PlacedBox {
        PlacedBox {
            bounds,
            to_world: None,
        }
    }
}

impl PlacedBox {
    /// The span of `ray` inside.
    #[inline]
    pub fn span(&self, ray: &Ray) -> Option<Span> {
        match &self.to_world {
            None => self.bounds.span(ray),
            Some(to_world) => self.moved_span(to_world, ray),
        }
    }

    // Cold: compiled into the loop along a ray, it takes registers from boxes that no map places.
    #[cold]
    #[inline(never)]
    fn moved_span(&self, to_world: &Transform, ray: &Ray) -> Option<Span> {
        self.bounds.span_of(&to_world.line_to_object(ray))
    }

    /// `ray` in the coordinates of the volume, by distances of the world.
    #[inline]
    pub fn line(&self, ray: &Ray) -> Line {
        match &self.to_world {
            None => ray.into(),
            Some(to_world) => to_world.line_to_object(ray),
        }
    }

    /// A world point in the coordinates of the volume.
    #[inline]
    pub fn to_volume(&self, point: DVec3) -> DVec3 {
        self.to_world
            .map_or(point, |map| map.point_to_object(point))
    }

    /// A difference of points of the world in the coordinates of the volume.
    #[inline]
    pub(crate) fn vector_to_volume(&self, vector: DVec3) -> DVec3 {
        match &self.to_world {
            None => vector,
            Some(to_world) => to_world.vector_to_object(vector),
        }
    }

    /// A point of the volume in the world.
    pub fn in_world(&self, point: DVec3) -> DVec3 {
        self.to_world.map_or(point, |map| map.point(point))
    }

    /// Edges of the box in the world.
    pub fn edges(&self) -> [DVec3; 3] {
        images(self.bounds.size(), self.to_world.as_ref())
    }

    /// The smallest box of the world around it.
    pub(crate) fn world_bounds(&self) -> Aabb {
        self.to_world
            .map_or(self.bounds, |map| map.bounds(&self.bounds))
    }
}

/// Edges of a cell of `lattice` in the world.
pub fn cell_edges(lattice: &Lattice, to_world: Option<&Transform>) -> [DVec3; 3] {
    images(lattice.spacing(), to_world)
}

/// The length called *one voxel*: that of the shortest [edge of a cell](cell_edges).
pub fn voxel(lattice: &Lattice, to_world: Option<&Transform>) -> f64 {
    if to_world.is_none() {
        return lattice.voxel();
    }
    let lengths = cell_edges(lattice, to_world).map(length_of);
    lengths.into_iter().fold(f64::INFINITY, f64::min)
}

/// The images of vectors of these lengths along the axes.
fn images(lengths: DVec3, to_world: Option<&Transform>) -> [DVec3; 3] {
    [0, 1, 2].map(|axis| {
        let edge = DVec3::AXES[axis] * lengths[axis];
        to_world.map_or(edge, |map| map.vector(edge))
    })
}

//! Gradients of a scalar grid, computed once and stored at its nodes.

use super::{Grid, Lattice, Scalar};
use crate::geometry::{Transform, length_of};
use crate::math::power_of_two_below;
use glam::DVec3;
use rayon::prelude::*;

/// Central differences at every node, per world unit: `(f(i+1) − f(i−1)) / (2·spacing)`.
///
/// A border node takes the gradient of the nearest inner node. An axis with fewer than three
/// nodes has no inner node, and gradient 0 along it. Exact at inner nodes for fields that are at
/// most quadratic along each axis, but for the rounding of the stored numbers. Gradients are
/// stored in the precision of the grid.
pub fn gradients<T: Scalar>(grid: &Grid<T>) -> Grid<[T; 3]> {
    gradients_over(grid, 1.0, |gradient| gradient)
}

/// [`gradients`] for use as directions only: per length of the power of two at or below the
/// [voxel](Lattice::voxel) of the grid.
///
/// A power of two as unit changes no digit. Per world unit, the gradients of a small volume would
/// overflow `f32` and those of a large one underflow. Here none exceeds half the largest density,
/// and scaling the volume by a power of two changes no bit.
pub fn relative_gradients<T: Scalar>(grid: &Grid<T>) -> Grid<[T; 3]> {
    gradients_over(grid, power_of_two_below(grid.lattice().voxel()), |it| it)
}

/// [`relative_gradients`] of a grid that `to_world` places, in the world: those of the grid by the
/// [inverse transpose](Transform::gradient_map), before they are rounded.
pub(crate) fn placed_gradients<T: Scalar>(grid: &Grid<T>, to_world: &Transform) -> Grid<[T; 3]> {
    let unit = power_of_two_below(grid.lattice().voxel());
    let map = to_world.gradient_map();
    gradients_over(grid, unit, |gradient| map * gradient)
}

/// Lengths of the gradients at the nodes, per world unit, of a grid that `to_world` places, if any.
pub(crate) fn gradient_lengths(grid: &Grid<f32>, to_world: Option<&Transform>) -> Grid<f32> {
    let unit = power_of_two_below(grid.lattice().voxel());
    let length = |gradient: &[f32; 3]| {
        let mut gradient = DVec3::from_array(gradient.map(f64::from));
        if let Some(to_world) = to_world {
            // By the inverse transpose, whose rows these are.
            let rows = DVec3::AXES.map(|axis| to_world.vector_to_object(axis));
            gradient = DVec3::from_array(rows.map(|row| row.dot(gradient)));
        }
        // In the smallest volumes it is beyond the range of `f32`.
        (length_of(gradient) / unit).min(f64::from(f32::MAX)) as f32
    };
    let relative = relative_gradients(grid);
    let values = relative.values().iter().map(length).collect();
    Grid::new(*grid.lattice(), values).expect("one number per node")
}

/// Gradients per `unit` of length, a power of two, changed by `map`.
fn gradients_over<T: Scalar>(
    grid: &Grid<T>,
    unit: f64,
    map: impl Fn(DVec3) -> DVec3 + Sync,
) -> Grid<[T; 3]> {
    let spacing = grid.lattice().spacing() / unit;
    let lattice = *grid.lattice();
    let mut values = vec![[T::rounded(0.0); 3]; lattice.node_count()];
    let [nx, ny, _] = lattice.nodes();
    let planes = values.par_chunks_mut(nx * ny).enumerate();
    planes.for_each(|(k, plane)| {
        for (j, row) in plane.chunks_mut(nx).enumerate() {
            for (i, gradient) in row.iter_mut().enumerate() {
                let inner = inner(&lattice, [i, j, k]);
                *gradient = map(central_difference(grid, spacing, inner))
                    .to_array()
                    .map(T::rounded);
            }
        }
    });
    Grid::new(lattice, values).expect("one gradient per node")
}

/// The inner node nearest to `node`, axis by axis; an axis without inner nodes is left alone.
fn inner(lattice: &Lattice, node: [usize; 3]) -> [usize; 3] {
    let mut inner = node;
    for (axis, &nodes) in lattice.nodes().iter().enumerate() {
        if nodes >= 3 {
            inner[axis] = node[axis].clamp(1, nodes - 2);
        }
    }
    inner
}

// Always: as a call it took more than its work.
#[inline(always)]
fn central_difference<T: Scalar>(grid: &Grid<T>, spacing: DVec3, node: [usize; 3]) -> DVec3 {
    let (lattice, values) = (grid.lattice(), grid.values());
    let nodes = lattice.nodes();
    let index = lattice.index(node);
    let mut gradient = DVec3::ZERO;
    let mut stride = 1;
    for axis in 0..3 {
        if nodes[axis] >= 3 {
            let difference = values[index + stride].value() - values[index - stride].value();
            gradient[axis] = difference / (2.0 * spacing[axis]);
        }
        stride *= nodes[axis];
    }
    gradient
}

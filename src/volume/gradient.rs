//! Gradients of a scalar grid, computed once and stored at its nodes.

use super::{Grid, Lattice, Scalar};
use glam::DVec3;
use rayon::prelude::*;

/// Central differences at every node, per world unit: `(f(i+1) − f(i−1)) / (2·spacing)`.
///
/// A border node takes the gradient of the nearest inner node. An axis with fewer than three
/// nodes has no inner node, and gradient 0 along it. Exact at inner nodes for fields that are at
/// most quadratic along each axis, but for the rounding of the stored numbers. Gradients are
/// stored in the precision of the grid.
pub fn gradients<T: Scalar>(grid: &Grid<T>) -> Grid<[T; 3]> {
    let lattice = *grid.lattice();
    let mut values = vec![[T::rounded(0.0); 3]; lattice.node_count()];
    let [nx, ny, _] = lattice.nodes();
    let planes = values.par_chunks_mut(nx * ny).enumerate();
    planes.for_each(|(k, plane)| {
        for (j, row) in plane.chunks_mut(nx).enumerate() {
            for (i, gradient) in row.iter_mut().enumerate() {
                let inner = inner(&lattice, [i, j, k]);
                *gradient = central_difference(grid, inner).to_array().map(T::rounded);
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

fn central_difference<T: Scalar>(grid: &Grid<T>, node: [usize; 3]) -> DVec3 {
    let (lattice, values) = (grid.lattice(), grid.values());
    let nodes = lattice.nodes();
    let index = lattice.index(node);
    let mut gradient = DVec3::ZERO;
    let mut stride = 1;
    for axis in 0..3 {
        if nodes[axis] >= 3 {
            let difference = values[index + stride].value() - values[index - stride].value();
            gradient[axis] = difference / (2.0 * lattice.spacing()[axis]);
        }
        stride *= nodes[axis];
    }
    gradient
}

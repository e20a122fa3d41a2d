//! The cells around several points, and trilinear interpolation there, with the bits of [`Cell::trilinear`].
//!
//! The operations are those of one point, in the same order. They stand in loops over the points without a
//! branch, of which a compiler makes vector instructions; only the nodes are read one by one.

use super::{Cell, Grid, Lattice, Lerp, NodePoint};
use glam::DVec3;
use std::array::from_fn;

/// Points in node coordinates, by axis.
pub type NodePoints<const N: usize> = [[f64; N]; 3];

/// 2^52: added to a number from 0 up to that, it leaves no bit below 1, and the whole number in the low bits.
const TWO_52: f64 = 4_503_599_627_370_496.0;

/// The [`Cell`]s around several points.
#[derive(Clone, Copy, Debug)]
pub enum Cells<const N: usize> {
    /// All points between nodes.
    Between {
        /// Indices of their first nodes.
        low: [usize; N],
        /// Distances in the array to the neighbours along each axis.
        strides: [usize; 3],
        /// By axis, positions between the two nodes.
        t: [[f64; N]; 3],
    },
    /// Points anywhere.
    Anywhere([Cell; N]),
}

impl<const N: usize> Cells<N> {
    /// The cells of `lattice` around `points`, which are finite.
    // Always, here and below: only together with its caller is it compiled for the number of points.
    #[inline(always)]
    pub fn around(lattice: &Lattice, points: &NodePoints<N>) -> Cells<N> {
        if !are_between_nodes(lattice, points) {
            return Cells::Anywhere(from_fn(|i| {
                let point = DVec3::from_array(points.map(|axis| axis[i]));
                Cell::around(lattice, NodePoint(point))
            }));
        }
        let [nx, ny, _] = lattice.nodes();
        let strides = [1, nx, nx * ny];
        let mut t = [[0.0; N]; 3];
        // Whole numbers far below 2^53, so products and sums are exact.
        let mut low = [0.0; N];
        for (axis, stride) in strides.into_iter().enumerate() {
            let stride = stride as f64;
            for i in 0..N {
                let floor = floor(points[axis][i]);
                low[i] += floor * stride;
                t[axis][i] = points[axis][i] - floor;
            }
        }
        let mut first = [0; N];
        for i in 0..N {
            first[i] = whole(low[i]);
        }
        Cells::Between {
            low: first,
            strides,
            t,
        }
    }

    /// The cell of one point.
    #[inline(always)]
    pub fn cell(&self, index: usize) -> Cell {
        match self {
            Cells::Between { low, strides, t } => Cell {
                low: low[index],
                step: *strides,
                t: DVec3::from_array(t.map(|axis| axis[index])),
            },
            Cells::Anywhere(cells) => cells[index],
        }
    }

    /// The trilinear interpolants at their points.
    #[inline(always)]
    pub fn trilinear(&self, grid: &Grid<f32>) -> [f64; N] {
        let (low, [_, dy, dz], t) = match self {
            Cells::Between { low, strides, t } => (low, *strides, t),
            Cells::Anywhere(cells) => return cells.map(|cell| cell.trilinear(grid)),
        };
        let mut corners = [[0.0_f32; N]; 8];
        for i in 0..N {
            for (row, offset) in [0, dy, dz, dy + dz].into_iter().enumerate() {
                let first = low[i] + offset;
                let nodes = &grid.values()[first..first + 2];
                (corners[2 * row][i], corners[2 * row + 1][i]) = (nodes[0], nodes[1]);
            }
        }
        // A loop over arrays: a closure for each point would be a call.
        let [x, y, z] = t;
        let mut values = [0.0; N];
        for i in 0..N {
            let along_x =
                |row: [&[f32; N]; 2]| f64::lerp_between(row[0][i].into(), row[1][i].into(), x[i]);
            let [a, b, c, d, e, f, g, h] = &corners;
            let near = f64::lerp_between(along_x([a, b]), along_x([c, d]), y[i]);
            let far = f64::lerp_between(along_x([e, f]), along_x([g, h]), y[i]);
            values[i] = f64::lerp_between(near, far, z[i]);
        }
        values
    }
}

/// True if all `points` lie between nodes along every axis, none on the last.
#[inline(always)]
fn are_between_nodes<const N: usize>(lattice: &Lattice, points: &NodePoints<N>) -> bool {
    let last = lattice.last_node();
    let mut between = true;
    for (axis, points) in points.iter().enumerate() {
        for &point in points {
            between &= (0.0 <= point) & (point < last[axis]);
        }
    }
    between
}

/// `⌊x⌋` of a number from 0 up to 2^52.
#[inline(always)]
fn floor(x: f64) -> f64 {
    let nearest = (x + TWO_52) - TWO_52;
    nearest - f64::from(u8::from(nearest > x))
}

/// A whole number from 0 up to 2^52.
#[inline(always)]
fn whole(x: f64) -> usize {
    ((x + TWO_52).to_bits() - TWO_52.to_bits()) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Stream};

    fn grid(nodes: [usize; 3]) -> Grid<f32> {
        let lattice = Lattice::new(nodes, DVec3::new(0.1, 2.0, 0.7), DVec3::ONE).unwrap();
        let values = (0..lattice.node_count() as u32).map(|sample| {
            let value = Stream::new(3, 1, sample).uniform(0, Purpose::Camera, 0);
            (1000.0 * value - 500.0) as f32
        });
        let values = values.collect();
        Grid::new(lattice, values).unwrap()
    }

    fn assert_same<const N: usize>(grid: &Grid<f32>, points: [DVec3; N]) {
        let by_axis = from_fn(|axis| points.map(|point| point[axis]));
        let cells = Cells::around(grid.lattice(), &by_axis);
        let several = cells.trilinear(grid);
        for (index, point) in points.into_iter().enumerate() {
            let one = Cell::around(grid.lattice(), NodePoint(point)).trilinear(grid);
            assert_eq!(several[index].to_bits(), one.to_bits(), "{point}");
            let again = cells.cell(index).trilinear(grid);
            assert_eq!(again.to_bits(), one.to_bits(), "{point}");
        }
    }

    #[test]
    fn the_same_bits_as_point_by_point() {
        let grid = grid([17, 9, 12]);
        let last = grid.lattice().last_node();
        for sample in 0..20_000 {
            let stream = Stream::new(5, 2, sample);
            let part = |index| stream.uniform(0, Purpose::Camera, index);
            assert_same::<8>(
                &grid,
                from_fn(|i| {
                    let i = 3 * i as u32;
                    last * DVec3::new(part(i), part(i + 1), part(i + 2))
                }),
            );
        }
    }

    /// On nodes, beside them by an ulp, on the last, beyond it, and on axes of few nodes.
    #[test]
    fn the_same_bits_on_nodes_and_beyond_the_last() {
        let places = |last: f64| {
            let inner = [0.0, 1.0, last - 1.0, last, 0.5];
            let beside = inner.map(|place| [place, place.next_up(), place.next_down()]);
            let mut places = beside.concat();
            places.extend([-0.0, -3.0, last + 0.5, 1e10]);
            places
        };
        for nodes in [[5, 4, 3], [2, 2, 2], [1, 3, 2]] {
            let grid = grid(nodes);
            let [xs, ys, zs] = grid.lattice().last_node().to_array().map(places);
            for &x in &xs {
                for &y in &ys {
                    for &z in &zs {
                        let point = DVec3::new(x, y, z);
                        assert_same(&grid, [point; 3]);
                        assert_same(&grid, [DVec3::splat(0.25), point]);
                    }
                }
            }
        }
    }
}

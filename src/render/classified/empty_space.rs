//! Empty-space skipping.
//!
//! A sample whose opacity is exactly 0 changes no bit of the image. In a block of cells whose
//! values all have opacity 0, and in the blocks around it, samples are not taken.

use crate::optics::TransferFunction;
use crate::volume::{Grid, Lattice, NodePoint, Scalar};
use rayon::prelude::*;

/// Cells along the edge of a block.
const BLOCK: usize = 4;

/// For each block of 4³ cells, its distance to the nearest block that is not transparent.
#[derive(Clone, Debug)]
pub struct EmptySpace {
    blocks: [usize; 3],
    /// Chebyshev distance in blocks: 0 for a block that is not transparent; around a block at
    /// distance `n`, all blocks fewer than `n` away on every axis are transparent.
    distance: Vec<u8>,
}

impl EmptySpace {
    /// The transparent blocks of `grid` by `transfer_function`.
    pub fn of<T: Scalar>(grid: &Grid<T>, transfer_function: &TransferFunction) -> EmptySpace {
        let blocks = blocks(grid.lattice());
        let mut space = EmptySpace {
            blocks,
            distance: Vec::new(),
        };
        space.distance = (0..blocks.iter().product())
            .into_par_iter()
            .map(|block| {
                let (least, most) = range_of_nodes(grid, space.block(block));
                if transfer_function.is_transparent_between(least, most) {
                    u8::MAX
                } else {
                    0
                }
            })
            .collect();
        space.measure_distances();
        space
    }

    fn block(&self, index: usize) -> [usize; 3] {
        let [bx, by, _] = self.blocks;
        [index % bx, index / bx % by, index / (bx * by)]
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.blocks[1] + j) * self.blocks[0] + i
    }

    /// Two sweeps, each of which hands distances on to the neighbours swept after.
    /// Source: Rosenfeld & Pfaltz 1968, Pattern Recognition 1, 33–61.
    fn measure_distances(&mut self) {
        let count = self.distance.len();
        for index in (0..count).chain((0..count).rev()) {
            if self.distance[index] == 0 {
                continue;
            }
            let nearest = self
                .neighbours(index)
                .map(|n| self.distance[n])
                .min()
                .unwrap_or(u8::MAX);
            self.distance[index] = self.distance[index].min(nearest.saturating_add(1));
        }
    }

    fn neighbours(&self, index: usize) -> impl Iterator<Item = usize> {
        let block = self.block(index);
        let around =
            |axis: usize| block[axis].saturating_sub(1)..(block[axis] + 2).min(self.blocks[axis]);
        let (xs, ys, zs) = (around(0), around(1), around(2));
        zs.flat_map(move |k| {
            let xs = xs.clone();
            ys.clone()
                .flat_map(move |j| xs.clone().map(move |i| [i, j, k]))
        })
        .filter(move |&other| other != block)
        .map(|other| self.index(other))
    }
}

/// Number of blocks along each axis.
fn blocks(lattice: &Lattice) -> [usize; 3] {
    lattice
        .nodes()
        .map(|nodes| (nodes - 1).div_ceil(BLOCK).max(1))
}

/// Smallest and largest value among the nodes of a block, those on its faces included:
/// interpolation inside the block uses no others.
fn range_of_nodes<T: Scalar>(grid: &Grid<T>, block: [usize; 3]) -> (f64, f64) {
    let lattice: &Lattice = grid.lattice();
    let nodes = |axis: usize| {
        let first = block[axis] * BLOCK;
        first..(first + BLOCK + 1).min(lattice.nodes()[axis])
    };
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in nodes(2) {
        for j in nodes(1) {
            let row = lattice.index([0, j, k]);
            for value in &grid.values()[row + nodes(0).start..row + nodes(0).end] {
                least = least.min(value.value());
                most = most.max(value.value());
            }
        }
    }
    (least, most)
}

impl EmptySpace {
    /// Number of samples, from the one at `point` on, that are certainly transparent. From
    /// sample to sample no coordinate changes by more than `reach`.
    pub fn transparent_samples(&self, NodePoint(point): NodePoint, reach: f64) -> usize {
        let mut block = [0; 3];
        for axis in 0..3 {
            // A point half a node before the first lies in block 0: below 0 the conversion gives 0.
            let cell = point[axis] as u32 as usize;
            block[axis] = (cell / BLOCK).min(self.blocks[axis] - 1);
        }
        let distance = usize::from(self.distance[self.index(block)]);
        if distance <= 1 {
            return distance;
        }
        // Everything within this many nodes is transparent. Half a node is kept back: sample
        // positions are rounded, but by less than that for an eye nearer than 2⁵⁰ nodes.
        let clear = ((distance - 1) * BLOCK) as f64 - 0.5;
        1 + (clear / reach) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::{Appearance, Colormap, TransferOpacity};
    use glam::DVec3;

    fn spike(nodes: [usize; 3], at: [usize; 3]) -> EmptySpace {
        let lattice = Lattice::new(nodes, DVec3::ONE, DVec3::ZERO).unwrap();
        let mut values = vec![0.0_f32; lattice.node_count()];
        values[lattice.index(at)] = 1.0;
        let transfer_function = TransferFunction {
            appearance: Appearance::Formula {
                opacity: TransferOpacity { floor: 0.36 },
                colormap: Colormap::named("white").unwrap(),
                range: None,
            },
            reference_length: 1.0,
        };
        EmptySpace::of(&Grid::new(lattice, values).unwrap(), &transfer_function)
    }

    #[test]
    fn distances_are_chebyshev_distances_to_the_nearest_block_with_something() {
        // Node (8, 8, 8) is a corner of eight blocks: all of them hold it.
        let space = spike([33, 33, 33], [8, 8, 8]);
        for index in 0..space.distance.len() {
            let away = |c: usize| if c <= 1 { 1 - c } else { c - 2 };
            let expected = space.block(index).map(away).into_iter().max().unwrap();
            assert_eq!(usize::from(space.distance[index]), expected);
        }
    }

    #[test]
    fn no_sample_is_passed_over_that_could_see_the_spike() {
        let at = [21, 9, 14];
        let space = spike([40, 30, 20], at);
        let centre = DVec3::new(21.0, 9.0, 14.0);
        for index in 0..40 * 30 * 20 {
            let node = [index % 40, index / 40 % 30, index / 1200];
            let point = DVec3::new(node[0] as f64, node[1] as f64, node[2] as f64) + 0.3;
            for reach in [0.01, 0.7, 3.0, 50.0] {
                let skipped = space.transparent_samples(NodePoint(point), reach);
                if skipped > 0 {
                    // The last sample passed over may have come this close, on some axis.
                    let moved = (skipped - 1) as f64 * reach;
                    assert!((point - centre).abs().max_element() - moved >= 1.0);
                }
            }
        }
    }

    #[test]
    fn an_empty_grid_is_crossed_in_one_leap() {
        let mut space = spike([100, 1, 1], [0, 0, 0]);
        space.distance.fill(u8::MAX);
        let leap = space.transparent_samples(NodePoint(DVec3::ZERO), 0.5);
        assert!(leap >= 200);
    }
}

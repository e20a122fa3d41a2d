//! Grids by a formula for the values of their nodes, so that those of any size need no file.
//!
//! Values are exact in `f32`, or refused. A ramp is exact where its numbers are multiples of one power of two, u, and
//! no value exceeds 2²⁴ u, for the significand of an `f32` has 24 bits: slopes that are powers of two. Trilinear
//! interpolation then gives the linear function itself, whatever the size of the lattice.

use super::{Grid, Lattice};
use crate::geometry::{InvalidParameter, require};
use glam::DVec3;

/// Values of nodes (i, j, k).
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum NodeFormula {
    /// `value + slope·(i, j, k)`.
    Ramp {
        /// At the first node.
        value: f64,
        /// Change from node to node along x, y and z.
        slope: DVec3,
    },
    /// One value, and others at single nodes.
    Spots {
        /// At all other nodes.
        value: f64,
        /// Bricks of so many nodes to an edge have a spot of this value at their first node: an axis of no more nodes has
        /// it at its middle one.
        every: Option<(usize, f64)>,
        /// Further nodes, with their values.
        spots: Vec<([usize; 3], f64)>,
    },
}

impl NodeFormula {
    /// Largest number of nodes that are computed: 2²⁷, 512 MiB.
    pub const MOST_NODES: usize = 1 << 27;

    /// The values at the nodes of `lattice`. Refused: values that `f32` does not hold, and spots outside.
    pub fn grid(&self, lattice: Lattice) -> Result<Grid<f32>, InvalidParameter> {
        let nodes = lattice.nodes();
        let mut values = Vec::with_capacity(lattice.node_count());
        for index in 0..lattice.node_count() {
            let (name, value) = self.value(lattice.node(index), nodes);
            values.push(exact(name, value)?);
        }
        if let NodeFormula::Spots { spots, .. } = self {
            for &(node @ [i, j, k], value) in spots {
                let [x, y, z] = nodes.map(|count| count - 1);
                let message = format_args!(
                    "there is no node ({i}, {j}, {k}): nodes are counted from 0, the last is ({x}, {y}, {z})"
                );
                require(i <= x && j <= y && k <= z, "spot", message)?;
                values[lattice.index(node)] = exact("spot", value)?;
            }
        }
        Ok(Grid::new(lattice, values).expect("a value for each node"))
    }

    /// The value at a node of a lattice of so many, and the parameter that it follows from; of spots without the
    /// further ones.
    fn value(&self, node: [usize; 3], nodes: [usize; 3]) -> (&'static str, f64) {
        match *self {
            NodeFormula::Ramp { value, slope } => {
                let [i, j, k] = node.map(|index| index as f64);
                let value = value + slope.x * i + slope.y * j + slope.z * k;
                ("slope", value)
            }
            NodeFormula::Spots { value, every, .. } => match every {
                Some((every, bright)) if is_first_of_brick(node, nodes, every) => {
                    ("bright", bright)
                }
                _ => ("value", value),
            },
        }
    }
}

/// The value of a node, in which the parameter `name` has a part, if 32 bits hold it.
fn exact(name: &'static str, value: f64) -> Result<f32, InvalidParameter> {
    let stored = value as f32;
    let message = format_args!(
        "the value {value} of a node is not exact in 32 bits, which hold {}: give multiples of one power of two, such \
         as 0.125, of which no value has more than 2^24",
        f64::from(stored)
    );
    let is_exact = stored.is_finite() && f64::from(stored) == value;
    require(is_exact, name, message)?;
    Ok(stored)
}

/// True of the nodes at which bricks of `every` nodes to an edge begin.
fn is_first_of_brick(node: [usize; 3], nodes: [usize; 3], every: usize) -> bool {
    (0..3).all(|axis| match nodes[axis] {
        few if few <= every => node[axis] == few / 2,
        _ => node[axis].is_multiple_of(every),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(nodes: [usize; 3]) -> Lattice {
        Lattice::new(nodes, DVec3::ONE, DVec3::ZERO).unwrap()
    }

    #[test]
    fn ramps_are_exact_or_refused() {
        let ramp = |value, slope: [f64; 3]| NodeFormula::Ramp {
            value,
            slope: slope.into(),
        };
        let grid = ramp(-3.0, [0.125, 4.0, -0.25])
            .grid(lattice([5, 4, 3]))
            .unwrap();
        for index in 0..60 {
            let [i, j, k] = grid.lattice().node(index).map(|index| index as f64);
            let exact = -3.0 + (i + 32.0 * j - 2.0 * k) / 8.0;
            assert_eq!(f64::from(grid.values()[index]), exact);
        }
        for (value, slope) in [
            (0.1, [0.0; 3]),
            (0.0, [0.1, 0.0, 0.0]),
            // 25 bits at the last node.
            (1.0, [0.0, 1.0 / 16_777_216.0, 0.0]),
            (1e300, [0.0; 3]),
            (1e-300, [0.0; 3]),
        ] {
            let error = ramp(value, slope).grid(lattice([5, 4, 3])).unwrap_err();
            assert_eq!(error.name, "slope", "{value} {slope:?}");
        }
    }

    #[test]
    fn spots_begin_bricks_and_lie_anywhere() {
        let spots = NodeFormula::Spots {
            value: 0.5,
            every: Some((4, 2.0)),
            spots: vec![([8, 0, 0], 3.0), ([1, 2, 1], 4.0)],
        };
        let grid = spots.grid(lattice([9, 4, 3])).unwrap();
        let bright = grid.values().iter().enumerate();
        let bright = bright.filter(|(_, value)| **value != 0.5);
        let bright = bright.map(|(index, value)| (grid.lattice().node(index), *value));
        // Along y and z there are no more nodes than bricks have: the middle one.
        let expected = [
            ([8, 0, 0], 3.0),
            ([0, 2, 1], 2.0),
            ([1, 2, 1], 4.0),
            ([4, 2, 1], 2.0),
            ([8, 2, 1], 2.0),
        ];
        assert_eq!(bright.collect::<Vec<_>>(), expected);
        let outside = NodeFormula::Spots {
            value: 0.0,
            every: None,
            spots: vec![([0, 4, 0], 1.0)],
        };
        let error = outside.grid(lattice([9, 4, 3])).unwrap_err();
        assert!(error.message.contains("(0, 4, 0)") && error.message.contains("(8, 3, 2)"));
    }
}

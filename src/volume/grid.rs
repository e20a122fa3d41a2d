//! A value at every node of a lattice.

use super::Lattice;
use thiserror::Error;

/// Values at the nodes of a [`Lattice`], x fastest: densities as `f32` or `f64`, gradients as
/// three of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<T> {
    lattice: Lattice,
    values: Vec<T>,
}

/// Reason for refusing the values of a grid.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GridError {
    /// Not one value per node.
    #[error("a grid of {nodes} nodes needs as many values, got {values}")]
    Count {
        /// Nodes of the lattice.
        nodes: usize,
        /// Values given.
        values: usize,
    },
    /// A density that no transfer function is defined for.
    #[error("voxel ({}, {}, {}) holds {value}: densities must be finite and not negative", node[0], node[1], node[2])]
    Density {
        /// The first such node, (i, j, k).
        node: [usize; 3],
        /// Its value.
        value: f64,
    },
}

impl<T> Grid<T> {
    /// A grid of the given values, one per node, x fastest.
    pub fn new(lattice: Lattice, values: Vec<T>) -> Result<Grid<T>, GridError> {
        let (nodes, count) = (lattice.node_count(), values.len());
        if nodes != count {
            return Err(GridError::Count {
                nodes,
                values: count,
            });
        }
        Ok(Grid { lattice, values })
    }

    /// The lattice of the nodes.
    #[inline]
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// The values, x fastest.
    #[inline]
    pub fn values(&self) -> &[T] {
        &self.values
    }
}

impl<T: Copy + Into<f64>> Grid<T> {
    /// Smallest and largest value. For a grid of [densities](Grid::check_densities).
    pub fn range(&self) -> (f64, f64) {
        self.values.iter().map(|&value| value.into()).fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(low, high), value: f64| (low.min(value), high.max(value)),
        )
    }

    /// Checks that every value is a density: finite and not negative. Names the first that is
    /// not.
    pub fn check_densities(&self) -> Result<(), GridError> {
        let wrong = self.values.iter().position(|&value| {
            let value: f64 = value.into();
            !(value.is_finite() && value >= 0.0)
        });
        match wrong {
            None => Ok(()),
            Some(index) => Err(GridError::Density {
                node: self.lattice.node(index),
                value: self.values[index].into(),
            }),
        }
    }
}

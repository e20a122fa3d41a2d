//! A value at every node of a lattice.

use super::Lattice;
use crate::geometry::{InvalidParameter, require};

/// Values at the nodes of a [`Lattice`], x fastest: densities as `f32` or `f64`, gradients as
/// three of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<T> {
    lattice: Lattice,
    values: Vec<T>,
}

impl<T> Grid<T> {
    /// A grid of the given values, one per node, x fastest.
    pub fn new(lattice: Lattice, values: Vec<T>) -> Result<Grid<T>, InvalidParameter> {
        let (nodes, count) = (lattice.node_count(), values.len());
        let message = format_args!("a grid of {nodes} nodes needs as many values, got {count}");
        require(nodes == count, "values", message)?;
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
    pub fn check_densities(&self) -> Result<(), InvalidParameter> {
        let wrong = self.values.iter().position(|&value| {
            let value: f64 = value.into();
            !(value.is_finite() && value >= 0.0)
        });
        wrong.map_or(Ok(()), |index| {
            let [i, j, k] = self.lattice.node(index);
            let value: f64 = self.values[index].into();
            let message = format!(
                "voxel ({i}, {j}, {k}) holds {value}: densities must be finite and not negative"
            );
            Err(InvalidParameter::new("values", message))
        })
    }
}

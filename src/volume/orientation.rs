//! The axes of a stored grid and those of the world.

use super::error::{VolumeFault, refused};
use super::{Centring, Lattice};
use crate::geometry::{Transform, length_of};
use crate::math::atan2;
use glam::{DMat3, DVec3};

/// The treatment of axes other than x, y and z.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Orientation {
    /// Axes along those of the world, in any order and either direction, are rearranged to x, y, z;
    /// all others are an error.
    #[default]
    World,
    /// As [`Orientation::World`], and axes that point elsewhere are kept: a map places the grid.
    Oblique,
    /// The stored axes are used as x, y and z, with the lengths of their steps as spacing. The
    /// position of the first sample is unchanged.
    AsStored,
}

/// Positions of the samples of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Samples along each axis as stored, the fastest first: at least one, together at most
    /// [`Lattice::MOST_NODES`].
    pub sizes: [usize; 3],
    /// From one sample to the next along each stored axis, world units.
    pub steps: [DVec3; 3],
    /// Position of the first sample, world units.
    pub first: DVec3,
    /// Faces of the box of the file: at the outermost samples, or half a step beyond.
    pub centring: Centring,
}

/// Placement of stored samples in a grid.
pub(super) struct Placement {
    /// Positions of the nodes.
    pub lattice: Lattice,
    /// The map of those positions into the world, of oblique axes.
    pub to_world: Option<Transform>,
    /// For each axis of the world, the stored axis that runs along it; true if backwards.
    from: [(usize, bool); 3],
}

/// A step this far off an axis of the world, as a share of its length, still runs along it:
/// headers hold `f32` or decimal numbers. The thousandth sample is then off by a hundredth of a
/// voxel.
const OFF_AXIS: f64 = 1e-5;

impl Axes {
    /// Axes along those of the world, of samples at the nodes of a lattice.
    pub(super) fn of(lattice: &Lattice) -> Axes {
        Axes {
            sizes: lattice.nodes(),
            steps: DVec3::AXES.map(|axis| axis * lattice.spacing()),
            first: lattice.first(),
            centring: lattice.centring(),
        }
    }

    /// The same places, for samples that run fastest along the last axis and slowest along the first.
    pub(super) fn reversed(mut self) -> Axes {
        self.sizes.reverse();
        self.steps.reverse();
        self
    }

    /// The lattice of the samples, and the order they take in it.
    ///
    /// The faces of the box lie by `centring`, if given, in place of what the file says.
    pub(super) fn placement(
        &self,
        centring: Option<Centring>,
        orientation: Orientation,
    ) -> Result<Placement, VolumeFault> {
        let centring = centring.unwrap_or(self.centring);
        let steps = self.steps;
        let lengths = DVec3::from_array(steps.map(length_of));
        Lattice::check_spacing(lengths)?;
        if orientation == Orientation::AsStored {
            return self.as_stored(lengths, self.first, centring, None);
        }
        let mut from = [None; 3];
        for stored in 0..3 {
            let direction = steps[stored] / lengths[stored];
            let along = direction.abs().max_position();
            let mut off = direction;
            off[along] = 0.0;
            if length_of(off) > OFF_AXIS && orientation == Orientation::Oblique {
                // With the lengths of the steps as spacing, from the origin on, and turned to where they are.
                let [x, y, z] = [0, 1, 2].map(|axis| steps[axis] / lengths[axis]);
                let to_world = Transform::from_matrix(DMat3::from_cols(x, y, z), self.first);
                let to_world = to_world.map_err(
                    |_| "the axes of the file lie in one plane of the world: the header is wrong",
                )?;
                return self.as_stored(lengths, DVec3::ZERO, centring, Some(to_world));
            }
            if length_of(off) > OFF_AXIS {
                let axis = stored + 1;
                let degrees = atan2(length_of(off), direction[along].abs()).to_degrees();
                return refused(format!(
                    "axis {axis} of the file is rotated by {degrees:.4} degrees from the nearest axis of the world, \
                    and only classified volumes stand obliquely: resample the volume along x, y and z, or use its \
                    axes as stored: `orientation = \"as-stored\"` beside `file` in the scene"
                ));
            }
            if let Some((other, _)) = from[along] {
                return refused(format!(
                    "axes {} and {} of the file point along the same axis of the world, {}: the header is wrong",
                    other + 1,
                    stored + 1,
                    ['x', 'y', 'z'][along]
                ));
            }
            from[along] = Some((stored, direction[along] < 0.0));
        }
        let from = from.map(|axis| axis.expect("three stored axes along three of the world"));
        let nodes = from.map(|(stored, _)| self.sizes[stored]);
        let mut spacing = DVec3::ZERO;
        let mut first = self.first;
        for (axis, (stored, backwards)) in from.into_iter().enumerate() {
            let step = steps[stored][axis];
            spacing[axis] = step.abs();
            if backwards {
                first[axis] += step * (self.sizes[stored] - 1) as f64;
            }
        }
        let lattice = Lattice::new(nodes, spacing, first)?.with_centring(centring)?;
        Ok(Placement {
            lattice,
            to_world: None,
            from,
        })
    }

    /// The samples in the order in which they are stored.
    fn as_stored(
        &self,
        spacing: DVec3,
        first: DVec3,
        centring: Centring,
        to_world: Option<Transform>,
    ) -> Result<Placement, VolumeFault> {
        Ok(Placement {
            lattice: Lattice::new(self.sizes, spacing, first)?.with_centring(centring)?,
            to_world,
            from: AS_STORED,
        })
    }
}

/// Stored axes that are those of the lattice.
const AS_STORED: [(usize, bool); 3] = [(0, false), (1, false), (2, false)];

impl Placement {
    /// `values`, stored with `sizes` along their axes, in the order of the lattice.
    pub(super) fn put(&self, values: Vec<f32>, sizes: [usize; 3]) -> Vec<f32> {
        if self.from == AS_STORED {
            return values;
        }
        let [nx, ny, nz] = sizes;
        let strides = [1, nx, nx * ny];
        let ends = [nx, ny, nz];
        let at = |axis: usize, index: usize| {
            let (stored, backwards) = self.from[axis];
            let index = if backwards {
                ends[stored] - 1 - index
            } else {
                index
            };
            index * strides[stored]
        };
        let [mx, my, mz] = self.lattice.nodes();
        let mut turned = Vec::with_capacity(values.len());
        for k in 0..mz {
            for j in 0..my {
                let row = at(2, k) + at(1, j);
                turned.extend((0..mx).map(|i| values[row + at(0, i)]));
            }
        }
        turned
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twelve samples along 2 × 3 × 2 steps, each holding its index; the first lies at (10, 20, 30).
    fn axes(steps: [DVec3; 3]) -> Axes {
        Axes {
            sizes: [2, 3, 2],
            steps,
            first: DVec3::new(10.0, 20.0, 30.0),
            centring: Centring::Nodes,
        }
    }

    fn error(steps: [DVec3; 3]) -> String {
        let placement = axes(steps).placement(None, Orientation::World);
        placement.err().unwrap().to_string()
    }

    /// Whatever the order and the signs, the value at a point of the world is the one the file
    /// puts there.
    #[test]
    fn every_signed_permutation_keeps_values_at_their_points() {
        let unit = [DVec3::X, DVec3::Y, DVec3::Z];
        let orders = [
            [0, 1, 2],
            [0, 2, 1],
            [1, 0, 2],
            [1, 2, 0],
            [2, 0, 1],
            [2, 1, 0],
        ];
        for order in orders {
            for signs in 0..8 {
                let sign = |axis: usize| if signs >> axis & 1 == 1 { -1.0 } else { 1.0 };
                let steps: [DVec3; 3] = std::array::from_fn(|axis| {
                    unit[order[axis]] * (sign(axis) * (axis + 1) as f64)
                });
                let axes = axes(steps);
                let placement = axes.placement(None, Orientation::World).unwrap();
                let values = placement.put((0..12).map(|v| v as f32).collect(), axes.sizes);
                let lattice = placement.lattice;
                for (index, value) in values.into_iter().enumerate() {
                    let stored = value as usize;
                    let [i, j, k] = [stored % 2, stored / 2 % 3, stored / 6].map(|n| n as f64);
                    let point = axes.first + steps[0] * i + steps[1] * j + steps[2] * k;
                    assert_eq!(lattice.position(lattice.node(index)), point, "{steps:?}");
                }
            }
        }
    }

    #[test]
    fn oblique_and_parallel_axes_are_refused() {
        let turned = DVec3::new(0.6, 0.8, 0.0);
        assert_eq!(
            error([turned, DVec3::new(-0.8, 0.6, 0.0), DVec3::Z]),
            "axis 1 of the file is rotated by 36.8699 degrees from the nearest axis of the world, \
            and only classified volumes stand obliquely: resample the volume along x, y and z, or use its axes \
            as stored: `orientation = \"as-stored\"` beside `file` in the scene"
        );
        assert_eq!(
            error([DVec3::X, -DVec3::X, DVec3::Z]),
            "axes 1 and 2 of the file point along the same axis of the world, x: the header is \
             wrong"
        );
        assert!(error([DVec3::X, DVec3::ZERO, DVec3::Z]).contains("must be positive and finite"));
        let nan = DVec3::new(f64::NAN, 0.0, 0.0);
        assert!(error([nan, DVec3::Y, DVec3::Z]).contains("must be positive and finite"));
    }

    #[test]
    fn axes_as_stored_keep_their_lengths() {
        let axes = axes([DVec3::new(3.0, 4.0, 0.0), -DVec3::Z, DVec3::Y]);
        let placement = axes.placement(None, Orientation::AsStored).unwrap();
        assert_eq!(placement.lattice.nodes(), [2, 3, 2]);
        assert_eq!(placement.lattice.spacing(), DVec3::new(5.0, 1.0, 1.0));
        assert_eq!(placement.lattice.first(), axes.first);
        assert_eq!(placement.put(vec![1.0, 2.0], [2, 1, 1]), [1.0, 2.0]);
    }

    #[test]
    fn the_rounding_of_headers_is_no_turn() {
        let off = DVec3::new(2.0, 1e-5, -1e-6);
        let placement = axes([off, DVec3::Y, DVec3::Z]).placement(None, Orientation::World);
        assert_eq!(
            placement.unwrap().lattice.spacing(),
            DVec3::new(2.0, 1.0, 1.0)
        );
    }
}

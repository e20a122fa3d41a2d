//! Gradients of the field at samples, for shading.

use super::work::RayWork;
use crate::geometry::Direction;
use crate::scene::{Classified, Conventions, Fault, Gradient, StoredValues};
use crate::volume::{Cell, Grid, Lattice, NodePoint, relative_gradients};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::{Arc, Mutex};

/// Gradients of a scene's field, all scaled by one factor: shading uses their directions alone.
pub enum Gradients {
    /// Stored at the nodes.
    Stored(Arc<GradientGrid>),
    /// Stored at the nodes, of the world, in which a map places the volume.
    World(Arc<GradientGrid>),
    /// Differences of the interpolant at the sample, over `2 · reach` in node coordinates, divided by
    /// as many spacings along each axis.
    Differences {
        /// Half of the difference along each axis, in spacings.
        reach: DVec3,
    },
    /// The derivative of the interpolant.
    Derivative,
    /// Differences of the interpolant over the components of the ray's step, undivided.
    RayStep,
}

impl Gradients {
    /// The gradients of `scene`, by its conventions; those at nodes are taken from `known`, or added to it.
    pub fn of(scene: &Classified, known: &NodeGradients) -> Gradients {
        let grid = &*scene.grid;
        if scene.to_world.is_some() && takes_volrefs(&scene.conventions) {
            return Gradients::World(Arc::new(scene.gradients()));
        }
        match scene.conventions.gradient {
            Gradient::Interpolant => Gradients::Derivative,
            Gradient::RayStep => Gradients::RayStep,
            Gradient::Texture => {
                let nodes = DVec3::from_array(grid.lattice().nodes().map(|nodes| nodes as f64));
                // An axis with one node has no differences, whatever the reach.
                let reach = nodes / (nodes - 1.0).max(DVec3::ONE);
                Gradients::Differences { reach }
            }
            Gradient::Central => known.stored(scene, relative_gradients),
            Gradient::Forward => known.stored(scene, |grid| at_nodes(grid, FORWARD, None)),
            Gradient::Sobel => known.stored(scene, |grid| at_nodes(grid, CENTRAL, Some(SMOOTH))),
            Gradient::Backward => known.stored(scene, |grid| at_nodes(grid, BACKWARD, None)),
        }
    }

    /// True if they are of the world, not of the coordinates of the volume.
    pub fn are_of_the_world(&self) -> bool {
        matches!(self, Gradients::World(_))
    }

    /// The gradient at a sample of a ray with a step in node coordinates, in any unit.
    pub fn at(
        &self,
        scene: &Classified,
        (point, step): (NodePoint, DVec3),
        cell: &Cell,
        work: &mut RayWork,
    ) -> DVec3 {
        let lattice = scene.grid.lattice();
        let mut differences = |[low, high]: [DVec3; 2]| {
            let mut gradient = DVec3::ZERO;
            for axis in 0..3 {
                let mut value = |place: f64| {
                    work.density_lookups += 1;
                    let mut moved = point.0;
                    moved[axis] = place;
                    let cell = Cell::around(lattice, NodePoint(moved));
                    scene.interpolation.read(&*scene.grid, &cell)
                };
                let spacing = lattice.spacing()[axis] / lattice.voxel();
                gradient[axis] = (value(high[axis]) - value(low[axis])) / spacing;
            }
            gradient
        };
        match self {
            Gradients::Stored(grid) | Gradients::World(grid) => {
                work.gradient_lookups += 1;
                scene.interpolation.read(&**grid, cell)
            }
            Gradients::Differences { reach } => differences([point.0 - *reach, point.0 + *reach]),
            Gradients::RayStep => {
                // Undivided: not by the spacing either.
                let spacing = lattice.spacing() / lattice.voxel();
                differences([point.0 - step, point.0 + step]) * spacing
            }
            // Within its cell the interpolant is linear along each axis.
            Gradients::Derivative => {
                let last = DVec3::from_array(lattice.nodes().map(|nodes| nodes as f64 - 2.0));
                let low = point.0.floor().min(last).max(DVec3::ZERO);
                differences([low, low + 1.0])
            }
        }
    }
}

/// Gradients at the nodes of one volume under several sets of conventions, each kind computed once.
#[derive(Debug, Default)]
pub(crate) struct NodeGradients(Mutex<Vec<(Kind, Arc<GradientGrid>)>>);

/// Gradients at nodes.
type GradientGrid = Grid<[f32; 3]>;

/// Conventions that gradients at nodes depend on: the values, the differences, normalisation and its bits.
type Kind = (StoredValues, Gradient, bool, Option<u32>);

/// Largest number of nodes with gradients that are kept, of all kinds together: 0.8 GB.
const MOST_KEPT: usize = 1 << 26;

impl NodeGradients {
    fn stored(
        &self,
        scene: &Classified,
        compute: impl Fn(&Grid<f32>) -> GradientGrid,
    ) -> Gradients {
        let conventions = &scene.conventions;
        let kind = (
            conventions.stored_values,
            conventions.gradient,
            conventions.normalised_at_nodes,
            conventions.normal_bits,
        );
        let lock = || self.0.lock().expect("no panic holds it");
        let known = lock().iter().find(|it| it.0 == kind).map(|it| it.1.clone());
        let gradients = known.unwrap_or_else(|| {
            // Without the lock: threads that compute take up other work, which may come here.
            let new = Arc::new(rounded(scene, compute(&scene.grid)));
            let mut kept = lock();
            if (kept.len() + 1) * scene.grid.values().len() <= MOST_KEPT {
                kept.push((kind, new.clone()));
            }
            new
        });
        Gradients::Stored(gradients)
    }
}

/// True of conventions under which gradients are volref's own, as they are.
fn takes_volrefs(conventions: &Conventions) -> bool {
    let volrefs = Conventions::default();
    conventions.gradient == volrefs.gradient
        && conventions.normalised_at_nodes == volrefs.normalised_at_nodes
        && conventions.normal_bits == volrefs.normal_bits
        && conventions.cell_centred == volrefs.cell_centred
        && conventions.normal_space == volrefs.normal_space
        && conventions.fault != Some(Fault::GradientsAsVectors)
        && conventions.fault != Some(Fault::GradientsUnmapped)
}

/// Weights of a node's neighbours and of itself along an axis.
type Kernel = [f64; 3];

const FORWARD: Kernel = [0.0, -1.0, 1.0];
const BACKWARD: Kernel = [-1.0, 1.0, 0.0];
const CENTRAL: Kernel = [-0.5, 0.0, 0.5];
const SMOOTH: Kernel = [0.25, 0.5, 0.25];

/// Gradients at the nodes of `grid`, per voxel: differences by `difference` along each axis, of values
/// that are weighted by `across` along the two others.
fn at_nodes(grid: &Grid<f32>, difference: Kernel, across: Option<Kernel>) -> Grid<[f32; 3]> {
    let lattice = *grid.lattice();
    let values: Vec<f64> = grid.values().iter().map(|&value| value.into()).collect();
    let per_voxel = lattice.voxel() / lattice.spacing();
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let smooth = across
            .iter()
            .flat_map(|across| others.map(|axis| (axis, *across)));
        smooth.fold(
            filtered(&lattice, &values, axis, difference),
            |values, (axis, across)| filtered(&lattice, &values, axis, across),
        )
    });
    let gradients = (0..values.len()).map(|node| {
        let gradient = DVec3::new(x[node], y[node], z[node]) * per_voxel;
        gradient.as_vec3().to_array()
    });
    Grid::new(lattice, gradients.collect()).expect("one gradient per node")
}

/// Sums over the neighbours of each node along `axis`, by the weights of `kernel`. Beyond the border
/// the field has the values of the border.
fn filtered(lattice: &Lattice, values: &[f64], axis: usize, kernel: Kernel) -> Vec<f64> {
    let last = lattice.nodes()[axis] - 1;
    let stride = [0, 1, 2].map(|axis| lattice.nodes()[..axis].iter().product::<usize>())[axis];
    let at = |index: usize| {
        let place = index / stride % (last + 1);
        let before = values[if place > 0 { index - stride } else { index }];
        let after = values[if place < last { index + stride } else { index }];
        kernel[0] * before + kernel[1] * values[index] + kernel[2] * after
    };
    (0..values.len()).into_par_iter().map(at).collect()
}

/// Stored gradients, normalised and rounded as the conventions of `scene` have it.
fn rounded(scene: &Classified, gradients: Grid<[f32; 3]>) -> Grid<[f32; 3]> {
    let conventions = &scene.conventions;
    if !conventions.normalised_at_nodes && conventions.normal_bits.is_none() {
        return gradients;
    }
    let round = |component: f64| match conventions.normal_bits {
        Some(bits) => {
            let most = ((1_u32 << bits) - 1) as f64;
            ((component + 1.0) * 0.5 * most).round() / most * 2.0 - 1.0
        }
        None => component,
    };
    let normals = gradients.values().iter().map(|gradient| {
        let gradient = DVec3::from_array(gradient.map(f64::from));
        match Direction::of(gradient) {
            Some(normal) => normal.to_array().map(|component| round(component) as f32),
            None => [0.0; 3],
        }
    });
    Grid::new(*gradients.lattice(), normals.collect()).expect("one normal per node")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f = x² + 3 y z at the nodes of a lattice with spacing (1, 1, 2).
    fn grid() -> Grid<f32> {
        let spacing = DVec3::new(1.0, 1.0, 2.0);
        let lattice = Lattice::new([5, 5, 5], spacing, DVec3::ZERO).unwrap();
        let values = (0..lattice.node_count()).map(|index| {
            let [x, y, z] = lattice.position(lattice.node(index)).to_array();
            (x * x + 3.0 * y * z) as f32
        });
        Grid::new(lattice, values.collect()).unwrap()
    }

    /// At a node, where the gradient of f is (2x, 3z, 3y).
    #[test]
    fn differences_at_nodes() {
        let grid = grid();
        let node = grid.lattice().index([2, 1, 3]);
        let at = |difference, across| {
            DVec3::from_array(at_nodes(&grid, difference, across).values()[node].map(f64::from))
        };
        let exact = DVec3::new(4.0, 18.0, 3.0);
        assert_eq!(at(CENTRAL, Some(SMOOTH)), exact);
        // A forward difference of x² is 2x + 1; the rest is linear along each axis.
        assert_eq!(at(FORWARD, None), exact + DVec3::X);
        assert_eq!(at(BACKWARD, None), exact - DVec3::X);
    }

    /// Beyond the last node the field is constant.
    #[test]
    fn forward_differences_end_at_the_border() {
        let grid = grid();
        let node = grid.lattice().index([4, 4, 1]);
        let gradients = at_nodes(&grid, FORWARD, None);
        assert_eq!(gradients.values()[node], [0.0, 0.0, 12.0]);
    }
}

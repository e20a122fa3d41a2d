//! What the resolution of the data costs: the same field on coarser grids.

use super::classified::{Shade, Subject};
use super::collocation::{Collocation, Light};
use super::image::thumbnail;
use super::norms::root_mean_square;
use super::order::Expected;
use super::results::{Knob, Reference, Study};
use super::study::{Climb, Outcome, Setting, climb, prices};
use super::timing::Clock;
use crate::geometry::Ray;
use crate::render::Counters;
use crate::scene::Classified;
use crate::volume::{Cell, Grid, Lattice};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Pixels of the larger side of the image that is looked at.
const SIDE: usize = 16;

/// Distances between nodes, in those of the data.
const SPACINGS: [f64; 6] = [8.0, 6.0, 4.0, 3.0, 2.0, 1.5];

/// Each element of the integrals is good to this: far below what a grid is off by.
const TOLERANCE: f64 = 1e-9;

/// `grid` with nodes `factor ≥ 1` times as far apart, over the same box: its interpolant, looked
/// up at the nodes. None where an axis would have fewer than two.
pub fn coarsened(grid: &Grid<f32>, factor: f64) -> Option<Grid<f32>> {
    let lattice = grid.lattice();
    let fine = lattice.nodes();
    let nodes = fine.map(|nodes| match nodes {
        1 => 1,
        _ => ((nodes - 1) as f64 / factor).round() as usize + 1,
    });
    if (0..3).any(|axis| fine[axis] > 1 && nodes[axis] < 2) {
        return None;
    }
    // How far apart, in nodes of the fine grid.
    let apart = DVec3::from_array(std::array::from_fn(|axis| match nodes[axis] {
        1 => 1.0,
        nodes => (fine[axis] - 1) as f64 / (nodes - 1) as f64,
    }));
    let coarse = Lattice::new(nodes, lattice.spacing() * apart, lattice.first()).ok()?;
    let value = |index: usize| {
        let node = coarse.node(index).map(|index| index as f64);
        let point = DVec3::from_array(node) * apart;
        Cell::around(lattice, point).trilinear(grid) as f32
    };
    let values = (0..coarse.node_count()).map(value).collect();
    Grid::new(coarse, values).ok()
}

/// The image of `scene`, of `size` pixels in full, from coarser and coarser data; none where
/// there are too few.
pub fn study(scene: &Classified, size: [usize; 2], clock: &Clock) -> Option<Study> {
    if scene.grid.lattice().centring() == crate::volume::Centring::Cells {
        return None;
    }
    let size = thumbnail(size, SIDE);
    let rays: Vec<Ray> = (0..size[0] * size[1])
        .map(|index| scene.camera.ray([index % size[0], index / size[0]], size))
        .collect();
    let plain = Classified {
        shadow: None,
        ..scene.clone()
    };
    let collocation = Collocation::new();
    let image = |scene: &Classified| -> Vec<Light> {
        let subject = Subject::new(scene, Shade::None);
        rays.par_iter()
            .map(|ray| subject.exact(&collocation, ray, TOLERANCE).0)
            .collect()
    };
    let right = image(&plain);
    let scale = root_mean_square(right.iter().flat_map(|light| light.radiance.to_array()));
    let bound = right
        .iter()
        .map(|light| light.radiance_error)
        .fold(0.0, f64::max)
        / scale;
    let scenes: Vec<(f64, Classified)> = SPACINGS
        .into_iter()
        .filter_map(|factor| {
            let grid = coarsened(&scene.grid, factor)?;
            let coarse = Classified {
                grid: Arc::new(grid),
                ..plain.clone()
            };
            Some((factor, coarse))
        })
        .collect();
    if scenes.len() < SPACINGS.len() {
        return None;
    }
    let (image, right, rays) = (&image, &right, &rays);
    let settings = scenes.iter().map(|(factor, coarse)| Setting {
        name: format!("{factor} voxels"),
        value: factor * scene.grid.lattice().voxel(),
        run: Box::new(move || {
            let found = image(coarse).into_iter().zip(right);
            let errors =
                found.flat_map(|(light, right)| (light.radiance - right.radiance).to_array());
            // What the renderer would look up, with its own step in voxels of the coarse grid.
            let subject = Subject::new(coarse, Shade::None);
            let mut work = Counters::default();
            for ray in rays {
                subject.cast(scene.step * factor, ray, &mut work);
            }
            Outcome {
                errors: errors.collect(),
                work,
                rays: rays.len(),
            }
        }),
        single: None,
    });
    let climbs = [Climb {
        estimator: "coarser data".to_owned(),
        is_ours: false,
        knob: Knob::Spacing,
        // Data are no smooth field: what lies between their nodes is not known, and how fast
        // coarser ones come near them says how smooth they happen to be.
        expected: Expected::NOTHING,
        settings: settings.collect(),
    }];
    // What is measured is an error of the data; the time of its measurement is nobody's.
    let untimed = Clock { runs: 0, ..*clock };
    let ladders = climb(&climbs, scale, bound, None, &untimed);
    Some(Study {
        name: "data",
        quantity: format!(
            "radiance of {} × {} pixels without shadow, from coarser data",
            size[0], size[1]
        ),
        reference: Reference {
            method: "the data as they are; integrals by collocation, for coarse data as well"
                .to_owned(),
            bound,
        },
        judged_on: None,
        prices: prices(&ladders, bound),
        pictures: vec![],
        worst_ray: None,
        ladders,
    })
}

//! What the resolution of the data costs: the same field on coarser grids.

use super::classified::{Shade, ShadedVolume};
use super::collocation::{CollocatedLight, Collocation};
use super::image::in_words;
use super::norms::root_mean_square;
use super::order::ExpectedOrder;
use super::results::{Parameter, Reference, Study};
use super::study::{PlannedSweep, Setting, SettingOutcome, run_sweeps};
use super::thumbnail;
use super::timing::Clock;
use super::transmittance::{Crossings, MediumOnRay, RayThroughMedia};
use crate::math::exp;
use crate::media::Field;
use crate::render::{Counters, Event};
use crate::scene::Classified;
use crate::volume::{Cell, Centring, Grid, GridDensity, Interpolation, Lattice, NodePoint};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;
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
        let point = NodePoint(DVec3::from_array(node) * apart);
        Cell::around(lattice, point).trilinear(grid) as f32
    };
    let values = (0..coarse.node_count()).map(value).collect();
    Grid::new(coarse, values).ok()
}

fn in_voxels_of_data(factor: f64) -> String {
    // What follows from a whole number of nodes has any number of digits.
    in_words((factor * 1e3).round() / 1e3)
}

fn name_of(interpolation: Interpolation) -> &'static str {
    match interpolation {
        Interpolation::Trilinear => "trilinear",
        Interpolation::Nearest => "nearest node",
    }
}

/// The transmittance of the rays of `crossings` from coarser and coarser grids, by either
/// interpolation, cell by cell; none where not all that varies is a grid, or one has too few
/// nodes.
pub fn of_grids(crossings: &Crossings<'_>, clock: &Clock) -> Option<Study> {
    if !crossings.rays.iter().all(RayThroughMedia::is_through_grids) {
        return None;
    }
    let parts = || crossings.rays.iter().flat_map(|ray| &ray.parts);
    let right: Vec<f64> = crossings.rays.iter().map(|ray| exp(-ray.depth)).collect();
    let scale = root_mean_square(right.iter().copied());
    // The grids by medium, coarser.
    let coarse = |factor: f64, interpolation: Interpolation| {
        let mut grids: BTreeMap<usize, GridDensity> = BTreeMap::new();
        for part in parts() {
            if let Field::Grid(grid) = part.density.field()
                && !grids.contains_key(&part.medium)
            {
                if grid.grid().lattice().centring() == Centring::Cells {
                    return None;
                }
                let grid = Arc::new(coarsened(grid.grid(), factor)?);
                grids.insert(part.medium, GridDensity::new(grid, interpolation));
            }
        }
        Some((factor, grids))
    };
    let all_trilinear = parts().all(|part| match part.density.field() {
        Field::Grid(grid) => grid.interpolation() == Interpolation::Trilinear,
        _ => false,
    });
    let sweeps = [Interpolation::Trilinear, Interpolation::Nearest].map(|interpolation| {
        let is_own = all_trilinear == (interpolation == Interpolation::Trilinear);
        let spacings = SPACINGS.into_iter().chain((!is_own).then_some(1.0));
        let grids: Option<Vec<_>> = spacings
            .map(|factor| coarse(factor, interpolation))
            .collect();
        (interpolation, is_own, grids)
    });
    if sweeps.iter().any(|(.., grids)| grids.is_none()) {
        return None;
    }
    let right = &right;
    let planned = sweeps.iter().map(|(interpolation, is_own, grids)| {
        let settings = grids.iter().flatten().map(|(factor, grids)| Setting {
            name: in_voxels_of_data(*factor),
            value: factor * crossings.unit,
            run: Box::new(move || {
                let mut lookups = 0;
                let errors = crossings.rays.iter().zip(right).map(|(ray, right)| {
                    let depth = |part: &MediumOnRay<'_>| {
                        let (line, span) = (&part.line, part.span);
                        let grid = &grids[&part.medium];
                        let column = grid.integral(line.origin, line.direction, span, &mut lookups);
                        part.sigma * column
                    };
                    exp(-ray.parts.iter().map(depth).sum::<f64>()) - right
                });
                let errors = errors.collect();
                SettingOutcome {
                    errors,
                    work: Counters::from([(Event::DensityLookup, lookups)]),
                    rays: crossings.rays.len(),
                    channels: 1,
                }
            }),
            single: None,
        });
        PlannedSweep {
            estimator: format!("{}, cell by cell", name_of(*interpolation)),
            is_ours: *is_own,
            parameter: Parameter::Spacing,
            expected: ExpectedOrder::NOTHING,
            settings: settings.collect(),
        }
    });
    let planned: Vec<PlannedSweep<'_>> = planned.collect();
    let bound = 1e-15;
    let sweeps = run_sweeps(&planned, scale, bound, None, &clock.untimed());
    Some(Study::of(
        "data",
        "transmittance of the same rays from coarser data, by either interpolation".to_owned(),
        Reference {
            method: "the data as they are, cell by cell".to_owned(),
            bound,
        },
        sweeps,
    ))
}

/// The image of `scene`, of `size` pixels in full, from coarser and coarser data, by either
/// interpolation; none where there are too few nodes.
pub fn study(scene: &Classified, size: [usize; 2], clock: &Clock) -> Option<Study> {
    if scene.grid.lattice().centring() == Centring::Cells {
        return None;
    }
    let size = thumbnail::thumbnail(size, SIDE);
    let rays = thumbnail::rays(&scene.camera, size);
    let plain = Classified {
        shadow: None,
        ..scene.clone()
    };
    let collocation = Collocation::new();
    let image = |subject: &ShadedVolume<'_>| -> Vec<CollocatedLight> {
        rays.par_iter()
            .map(|ray| subject.exact(&collocation, ray, TOLERANCE).0)
            .collect()
    };
    let right = image(&ShadedVolume::new(&plain, Shade::None));
    let scale = root_mean_square(right.iter().flat_map(|light| light.radiance.to_array()));
    let bound = right
        .iter()
        .map(|light| light.radiance_error)
        .fold(0.0, f64::max)
        / scale;
    let voxel = scene.grid.lattice().voxel();
    let by = |interpolation: Interpolation| -> Vec<(f64, Classified)> {
        // With the interpolation of the scene the data as they are have no error.
        let finest = (interpolation != scene.interpolation).then_some(1.0);
        let spacings = SPACINGS.into_iter().chain(finest);
        let mut scenes: Vec<_> = spacings
            .filter_map(|factor| coarsened(&scene.grid, factor))
            .map(|grid| {
                let factor = grid.lattice().voxel() / voxel;
                let coarse = Classified {
                    grid: Arc::new(grid),
                    interpolation,
                    ..plain.clone()
                };
                (factor, coarse)
            })
            .collect();
        // A whole number of nodes may be the same for two wishes.
        scenes.dedup_by(|a, b| a.0 == b.0);
        scenes
    };
    let sweeps = [Interpolation::Trilinear, Interpolation::Nearest]
        .map(|interpolation| (interpolation, by(interpolation)));
    if sweeps.iter().all(|(_, scenes)| scenes.is_empty()) {
        return None;
    }
    let (image, right, rays) = (&image, &right, &rays);
    let planned = sweeps.iter().map(|(interpolation, scenes)| {
        let settings = scenes.iter().map(|(factor, coarse)| Setting {
            name: in_voxels_of_data(*factor),
            value: factor * voxel,
            run: Box::new(move || {
                let subject = ShadedVolume::new(coarse, Shade::None);
                let found = image(&subject).into_iter().zip(right);
                let errors =
                    found.flat_map(|(light, right)| (light.radiance - right.radiance).to_array());
                // What the renderer would look up, with its own step in voxels of the coarse grid.
                let mut work = Counters::default();
                for ray in rays {
                    subject.cast(scene.step * factor, ray, &mut work);
                }
                SettingOutcome {
                    errors: errors.collect(),
                    work,
                    rays: rays.len(),
                    channels: 3,
                }
            }),
            single: None,
        });
        PlannedSweep {
            estimator: name_of(*interpolation).to_owned(),
            is_ours: *interpolation == scene.interpolation,
            parameter: Parameter::Spacing,
            // Data are no smooth field: what lies between their nodes is not known, and how fast
            // coarser ones come near them says how smooth they happen to be.
            expected: ExpectedOrder::NOTHING,
            settings: settings.collect(),
        }
    });
    let planned: Vec<PlannedSweep<'_>> = planned.collect();
    // What is measured is an error of the data; the time of its measurement is nobody's.
    let sweeps = run_sweeps(&planned, scale, bound, None, &clock.untimed());
    Some(Study::of(
        "data",
        format!(
            "radiance of {} × {} pixels without shadow, from coarser data, by either interpolation",
            size[0], size[1]
        ),
        Reference {
            method: "the data as they are; integrals by collocation, for coarse data as well"
                .to_owned(),
            bound,
        },
        sweeps,
    ))
}

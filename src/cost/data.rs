//! Cost of the resolution of the data: the same field on coarser grids.

use super::classified::{Shade, ShadedVolume};
use super::image::{Rays, in_words};
use super::norms::root_mean_square;
use super::order::ExpectedOrder;
use super::results::{Parameter, Study};
use super::study::{PlannedSweep, Setting, SettingOutcome, SettingRun, Truth};
use super::thumbnail;
use super::timing::Clock;
use super::transmittance::{Crossings, MediumOnRay, RayThroughMedia};
use crate::geometry::Ray;
use crate::math::exp;
use crate::optics::Field;
use crate::optics::collocation::Collocation;
use crate::render::Event;
use crate::render::counters::Work;
use crate::scene::Classified;
use crate::volume::{Cell, Centring, Grid, GridDensity, Interpolation, Lattice, NodePoint};
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Pixels of the larger side of the small image.
const SIDE: usize = 16;

/// Distances between nodes, in units of the data's.
const SPACINGS: [f64; 6] = [8.0, 6.0, 4.0, 3.0, 2.0, 1.5];

/// Accuracy of each element of the integrals: far below the error of a coarser grid.
const TOLERANCE: f64 = 1e-9;

/// `grid` with nodes `factor ≥ 1` times as far apart, over the same box: its interpolant, looked
/// up at the nodes. None where an axis would have fewer than two.
pub(crate) fn coarsened(grid: &Grid<f32>, factor: f64) -> Option<Grid<f32>> {
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

/// Both interpolations, the own one of the data or not, with the distances between nodes that are
/// tried: with their own interpolation the data as they are have no error.
fn interpolations(own: Interpolation) -> [(Interpolation, bool, Vec<f64>); 2] {
    [Interpolation::Trilinear, Interpolation::Nearest].map(|interpolation| {
        let is_own = own == interpolation;
        let finest = (!is_own).then_some(1.0);
        let spacings = SPACINGS.into_iter().chain(finest);
        (interpolation, is_own, spacings.collect())
    })
}

/// The setting of nodes `factor` times as far apart as those of the data, which are `unit` apart.
fn setting(factor: f64, unit: f64, run: SettingRun<'_>) -> Setting<'_> {
    // What follows from a whole number of nodes has any number of digits.
    let name = in_words((factor * 1e3).round() / 1e3);
    Setting::new(name, factor * unit, run)
}

/// The sweep of an interpolation.
///
/// Data are no smooth field: what lies between their nodes is not known, and how fast coarser ones
/// come near them says how smooth they happen to be. So no order is expected.
fn sweep<'a>(
    interpolation: Interpolation,
    method: &str,
    is_ours: bool,
    settings: Vec<Setting<'a>>,
) -> PlannedSweep<'a> {
    let name = match interpolation {
        Interpolation::Trilinear => "trilinear",
        Interpolation::Nearest => "nearest node",
    };
    PlannedSweep {
        estimator: format!("{name}{method}"),
        is_ours,
        parameter: Parameter::Spacing,
        expected: ExpectedOrder::NOTHING,
        settings,
    }
}

/// The transmittance of the rays of `crossings` from coarser and coarser grids, by either
/// interpolation, cell by cell; none where not all that varies is a grid, or one has too few
/// nodes.
pub(crate) fn of_grids(crossings: &Crossings<'_>, clock: &Clock) -> Option<Study> {
    if !crossings.rays.iter().all(RayThroughMedia::is_through_grids) {
        return None;
    }
    let right: Vec<f64> = crossings.rays.iter().map(|ray| exp(-ray.depth)).collect();
    let scale = root_mean_square(right.iter().copied());
    let mut parts = crossings.rays.iter().flat_map(|ray| &ray.parts);
    let all_trilinear = parts.all(|part| match part.density.field() {
        Field::Grid(grid) => grid.interpolation() == Interpolation::Trilinear,
        _ => false,
    });
    let own = match all_trilinear {
        true => Interpolation::Trilinear,
        false => Interpolation::Nearest,
    };
    let mut sweeps = Vec::new();
    for (interpolation, is_own, spacings) in interpolations(own) {
        let spacings = spacings.into_iter();
        let grids: Option<Vec<_>> = spacings
            .map(|factor| Some((factor, coarser_grids(crossings, factor, interpolation)?)))
            .collect();
        sweeps.push((interpolation, is_own, grids?));
    }
    let right = &right;
    let planned = sweeps.iter().map(|(interpolation, is_own, grids)| {
        let settings = grids.iter().map(|(factor, grids)| {
            let run = move || {
                SettingOutcome::of_rays(right.len(), &|index, work| {
                    let mut lookups = 0;
                    let depth = |part: &MediumOnRay<'_>| {
                        let (line, span) = (&part.line, part.span);
                        let grid = &grids[&part.medium];
                        let column = grid.integral(line.origin, line.direction, span, &mut lookups);
                        part.sigma * column
                    };
                    let depth: f64 = crossings.rays[index].parts.iter().map(depth).sum();
                    work.count_times(Event::DensityLookup, lookups);
                    Some([exp(-depth) - right[index]])
                })
            };
            setting(*factor, crossings.unit, Box::new(run))
        });
        sweep(
            *interpolation,
            ", cell by cell",
            *is_own,
            settings.collect(),
        )
    });
    let planned: Vec<PlannedSweep<'_>> = planned.collect();
    let truth = Truth {
        method: "the data as they are, cell by cell".to_owned(),
        scale,
        bound: 1e-15,
        judged: None,
    };
    let quantity = "transmittance of the same rays from coarser data, by either interpolation";
    let clock = clock.untimed();
    Some(Study::of(
        "data",
        quantity.to_owned(),
        truth,
        &planned,
        &clock,
    ))
}

/// The grids of the media of `crossings` by medium, with nodes `factor` times as far apart.
fn coarser_grids(
    crossings: &Crossings<'_>,
    factor: f64,
    interpolation: Interpolation,
) -> Option<BTreeMap<usize, GridDensity>> {
    let mut grids = BTreeMap::new();
    for part in crossings.rays.iter().flat_map(|ray| &ray.parts) {
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
    Some(grids)
}

/// The image of `scene`, of `size` pixels in full, from coarser and coarser data, by either
/// interpolation; none where there are too few nodes.
pub fn study(scene: &Classified, size: [usize; 2], clock: &Clock) -> Option<Study> {
    if scene.grid.lattice().centring() == Centring::Cells {
        return None;
    }
    let plain = Classified {
        shadow: None,
        ..scene.clone()
    };
    let collocation = Collocation::new();
    let exact = |subject: &ShadedVolume<'_>, ray: &Ray| subject.exact(&collocation, ray, TOLERANCE);
    let size = thumbnail::thumbnail(size, SIDE);
    let rays = Rays::against(&plain, Shade::None, size, |subject, ray| {
        (exact(subject, ray).0, true)
    });
    let voxel = scene.voxel();
    let sweeps = interpolations(scene.interpolation).map(|(interpolation, is_own, spacings)| {
        let grids = spacings.into_iter();
        let grids = grids.filter_map(|factor| coarsened(&scene.grid, factor));
        let mut scenes: Vec<(f64, Classified)> = grids
            .map(|grid| {
                let factor = grid.lattice().voxel() / scene.grid.lattice().voxel();
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
        (interpolation, is_own, scenes)
    });
    if sweeps.iter().all(|(.., scenes)| scenes.is_empty()) {
        return None;
    }
    let (rays, exact) = (&rays, &exact);
    let planned = sweeps.iter().map(|(interpolation, is_own, scenes)| {
        let settings = scenes.iter().map(|(factor, coarse)| {
            let subject = ShadedVolume::new(coarse, Shade::None);
            let run = rays.run(move |ray, _, work| {
                // What the renderer would look up, with its own step in voxels of the coarse grid.
                subject.cast(scene.step * factor, ray, work);
                exact(&subject, ray).0.radiance
            });
            setting(*factor, voxel, run)
        });
        sweep(*interpolation, "", *is_own, settings.collect())
    });
    let planned: Vec<PlannedSweep<'_>> = planned.collect();
    let [width, height] = size;
    let quantity = format!(
        "radiance of {width} × {height} pixels without shadow, from coarser data, by either \
         interpolation"
    );
    let truth =
        rays.truth("the full-resolution data; all integrals, coarse ones included, by collocation");
    // What is measured is an error of the data; the time of its measurement is nobody's.
    Some(Study::of(
        "data",
        quantity,
        truth,
        &planned,
        &clock.untimed(),
    ))
}

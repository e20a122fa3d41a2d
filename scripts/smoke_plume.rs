//! Generates the smoke cloud of the suite: one moment of a small fluid simulation.
//!
//! Warm smoke leaves a small vent in the floor, rises through slightly draughty air, rolls up
//! into rings and spreads into a head. The density at one moment is written as a point cloud,
//! one point for each lattice node that holds smoke. `generate-smoke.sh` runs this; the method
//! and its sources are in `smoke_fluid.rs`.
//!
//! The same bits come out on every platform: one thread, a fixed order, only correctly rounded
//! operations and the pinned elementary functions, and noise from an integer hash.
//!
//! The constants, here and there, were chosen by eye: for a narrow stem, visible curls and a
//! file within its budget.

mod smoke_fluid;

use std::fmt::Write as _;
use std::process::ExitCode;
use std::{env, fs};

use smoke_fluid::{
    Cell, HEIGHT, ROW, SMOKE, Vector, WIDTH, advance, cells, filter, length, settled,
};
use volref::math::pow;

/// Steps from still air to the moment that is kept.
const STEPS: usize = 184;
/// Rows simulated above the highest smoke: the air there hardly moves, and time is saved.
const HEADROOM: usize = 20;

/// Speed of the draughts in the air before the smoke comes, and their size in cells.
const DRAUGHT_SPEED: f64 = 0.12;
const DRAUGHT_SIZE: f64 = 28.0;

/// Radius of the vent, and height of its centre above the floor, in cells.
const VENT_RADIUS: f64 = 3.5;
const VENT_HEIGHT: f64 = 1.5;
/// Upward speed at which the smoke leaves the vent.
const VENT_SPEED: f64 = 1.5;
/// The vent puffs, by this share of its strength: each puff rolls up into a ring of its own.
const PUFF: f64 = 0.35;
const PUFF_STEPS: f64 = 12.0;
/// The vent wanders by so many cells and pushes sideways, so that no symmetry survives.
const SWAY: f64 = 1.2;
const SWAY_STEPS: f64 = 14.0;
const SIDEWAYS_PUSH: f64 = 0.3;

/// Any number; this one gave a handsome plume.
const SEED: u64 = 2024;

/// Density written as 1. The few cells above it, mostly in the stem, are cut off there so that
/// the rest has the whole range.
const FULL: f64 = 0.9;
/// Exponent applied to the density so that the thin smoke of the head and the wisps shows.
const GAMMA: f64 = 0.6;
/// Nodes with less density than this are left out; they would hardly be visible.
const FAINTEST: f64 = 0.03;
/// Nodes of the written lattice per unit of length. Two decimals keep the lines short.
const NODES_PER_UNIT: usize = 100;

// ---- Noise -------------------------------------------------------------------------------

/// A number in [−1, 1) for a lattice point: multiply-and-shift mixing as in SplitMix64.
fn hash(point: [i64; 3], channel: u64) -> f64 {
    let mut bits = SEED;
    for key in [point[0] as u64, point[1] as u64, point[2] as u64, channel] {
        bits = (bits ^ key).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        bits ^= bits >> 29;
        bits = bits.wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits ^= bits >> 32;
    }
    (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Value noise: the hash at whole points, blended smoothly between them.
fn noise(position: Vector, channel: u64) -> f64 {
    let floor = position.map(f64::floor);
    let blend = [0, 1, 2].map(|axis| {
        let t = position[axis] - floor[axis];
        t * t * (3.0 - 2.0 * t)
    });
    let mut sum = 0.0;
    for corner in 0..8 {
        let mut weight = 1.0;
        let mut point = [0; 3];
        for axis in 0..3 {
            let upper = corner >> axis & 1;
            weight *= if upper == 1 {
                blend[axis]
            } else {
                1.0 - blend[axis]
            };
            point[axis] = floor[axis] as i64 + upper;
        }
        sum += weight * hash(point, channel);
    }
    sum
}

/// Noise along time only.
fn wander(time: f64, channel: u64) -> f64 {
    noise([time, 0.5, 0.5], channel)
}

// ---- Air and vent ------------------------------------------------------------------------

/// Air without smoke, moving in large lazy swirls of two sizes.
fn draughty_air() -> Vec<Cell> {
    let speed = |position: Vector, channel| {
        // A ratio that is not whole, so that the two lattices of the noise never coincide.
        let finer = position.map(|p| 2.3 * p);
        DRAUGHT_SPEED * (noise(position, channel) + 0.5 * noise(finer, channel + 3))
    };
    let swirl = |cell: [usize; 3]| {
        let position = cell.map(|c| c as f64 / DRAUGHT_SIZE);
        [
            speed(position, 0),
            speed(position, 1),
            speed(position, 2),
            0.0,
        ]
    };
    cells(HEIGHT).map(swirl).collect()
}

/// Draws density and velocity near the vent halfway towards those of the fresh smoke.
fn emit(field: &mut [Cell], time: f64) {
    let sway_time = time / SWAY_STEPS;
    let middle = WIDTH as f64 / 2.0;
    let centre = [
        middle + SWAY * wander(sway_time, 6),
        VENT_HEIGHT,
        middle + SWAY * wander(sway_time, 7),
    ];
    let push = [8, 9].map(|channel| SIDEWAYS_PUSH * wander(2.0 * sway_time, channel));
    let strength = 1.0 + PUFF * wander(time / PUFF_STEPS, 10);
    let reach = (VENT_HEIGHT + VENT_RADIUS) as usize + 1;
    for (cell, at) in field.iter_mut().zip(cells(reach)) {
        let distance = length([0, 1, 2].map(|axis| at[axis] as f64 - centre[axis])) / VENT_RADIUS;
        let inside = (1.0 - distance * distance).max(0.0);
        // Flat in the middle and smooth at the rim.
        let cover = inside * (2.0 - inside);
        cell[0] += cover * push[0];
        cell[1] += 0.5 * cover * (VENT_SPEED * strength - cell[1]);
        cell[2] += cover * push[1];
        cell[SMOKE] += 0.5 * cover * (strength - cell[SMOKE]);
    }
}

// ---- The simulation ----------------------------------------------------------------------

/// Rows that hold smoke or soon may.
fn active_rows(field: &[Cell]) -> usize {
    let holds_smoke = |row: &[Cell]| row.iter().any(|cell| cell[SMOKE] > 1e-4);
    let highest = field.chunks(ROW).rposition(holds_smoke).unwrap_or(0);
    (highest + HEADROOM).min(HEIGHT)
}

/// The density of the smoke after all steps.
fn simulate() -> Vec<f64> {
    let mut field = settled(draughty_air());
    let mut pressure = vec![0.0; field.len()];
    for step in 0..STEPS {
        emit(&mut field, step as f64);
        let active = active_rows(&field) * ROW;
        advance(&mut field[..active], &mut pressure[..active]);
    }
    // The limited advection leaves streaks one cell wide, which shading would exaggerate.
    filter(&mut field, SMOKE..SMOKE + 1, 1.0);
    field.iter().map(|cell| cell[SMOKE]).collect()
}

// ---- The point cloud ---------------------------------------------------------------------

/// A lattice node that holds smoke, and the density there in thousandths.
struct Node {
    at: [usize; 3],
    thousandths: usize,
}

/// The visible nodes, moved so that the smallest coordinate along each axis is 0.
fn visible_nodes(density: &[f64]) -> Vec<Node> {
    let mut nodes = Vec::new();
    for (at, &raw) in cells(HEIGHT).zip(density) {
        let shown = pow((raw / FULL).clamp(0.0, 1.0), GAMMA);
        if shown >= FAINTEST {
            nodes.push(Node {
                at,
                thousandths: (1000.0 * shown).round() as usize,
            });
        }
    }
    for axis in 0..3 {
        let least = nodes.iter().map(|node| node.at[axis]).min().unwrap_or(0);
        nodes.iter_mut().for_each(|node| node.at[axis] -= least);
    }
    nodes
}

/// Decimal text of a lattice coordinate, as short as it gets.
fn coordinate(node: usize) -> f64 {
    node as f64 / NODES_PER_UNIT as f64
}

fn write_cloud(nodes: &[Node]) -> String {
    let extent = [0, 1, 2].map(|axis| nodes.iter().map(|n| n.at[axis]).max().unwrap_or(0));
    let [width, height, depth] = extent.map(coordinate);
    let mut text = format!(
        "# A plume of smoke: one moment of a fluid simulation, as a point cloud.\n\
         # Each line is: v x y z density, with y up and the density in (0, 1].\n\
         # The points are nodes of a regular lattice through the origin, spacing {spacing};\n\
         # nodes not listed hold no smoke. Extent: 0..{width} x 0..{height} x 0..{depth}.\n\
         # The density is the simulated one, scaled, cut off at 1 and raised to the power\n\
         # {GAMMA}, which brings out the wisps.\n\
         # Made by scripts/generate-smoke.sh (scripts/smoke_plume.rs); do not edit.\n\
         # Licence: MIT OR Apache-2.0, as the rest of the project.\n",
        spacing = coordinate(1),
    );
    for node in nodes {
        let [x, y, z] = node.at.map(coordinate);
        let density = node.thousandths as f64 / 1000.0;
        writeln!(text, "v {x} {y} {z} {density}").expect("writing to a String cannot fail");
    }
    text
}

fn main() -> ExitCode {
    let Some(path) = env::args_os().nth(1) else {
        eprintln!("usage: smoke-plume <output.obj>");
        return ExitCode::from(2);
    };
    let cloud = write_cloud(&visible_nodes(&simulate()));
    if let Err(error) = fs::write(&path, cloud) {
        eprintln!("smoke-plume: cannot write {}: {error}", path.display());
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

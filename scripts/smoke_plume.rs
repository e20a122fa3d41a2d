//! Generates the smoke cloud of the suite: one moment of a small fluid simulation.
//!
//! Warm smoke leaves a small vent in the floor, rises through slightly draughty air, rolls up
//! into rings and spreads into a head. The density at one moment is written as a point cloud,
//! one point for each lattice node that holds smoke. `generate-smoke.sh` runs this.
//!
//! Sources:
//! - Stam 1999, "Stable Fluids": forces, projection and advection one after the other.
//! - Fedkiw, Stam, Jensen 2001, "Visual Simulation of Smoke": buoyancy, vorticity confinement.
//! - Selle, Fedkiw, Kim, Liu, Rossignac 2008, "An Unconditionally Stable MacCormack Method":
//!   the advection, which keeps the curls that plain semi-Lagrangian steps wash out.
//! - Shapiro 1970, "Smoothing, Filtering, and Boundary Effects": the filter against odd-even
//!   modes, which a projection with all quantities at the cell centres cannot see.
//!
//! The same bits come out on every platform: one thread, a fixed order, only correctly rounded
//! operations and the pinned elementary functions, and noise from an integer hash.
//!
//! Inside the simulation one cell is the unit of length and one step the unit of time. The
//! constants were chosen by eye, for a narrow stem, visible curls and a file within its budget.

use std::fmt::Write as _;
use std::ops::Range;
use std::process::ExitCode;
use std::{env, fs};

use volref::math::pow;

/// Cells along x and z; wide enough that the smoke never reaches the open sides.
const WIDTH: usize = 96;
/// Cells along y, which points up; the smoke stops short of the open top.
const HEIGHT: usize = 128;
/// Cells in one horizontal row of the domain, and the distance in memory between two rows.
const ROW: usize = WIDTH * WIDTH;
/// Distance in memory to the next cell along x, y and z.
const STRIDES: [usize; 3] = [1, ROW, WIDTH];
/// Rows simulated above the highest smoke: the air there hardly moves, and time is saved.
const HEADROOM: usize = 20;

/// Steps from still air to the moment that is kept.
const STEPS: usize = 184;
/// Upward acceleration of smoke of density 1. Heat is taken to travel with the smoke.
const BUOYANCY: f64 = 0.035;
/// Vorticity confinement; five times this tore the curls into grain.
const CONFINEMENT: f64 = 0.03;
/// Share of the odd-even modes taken out of the velocity at each step; with a third of this,
/// streaks one cell wide remained.
const FILTERING: f64 = 0.9;
/// Share of the smoke that is left after one step.
const PERSISTENCE: f64 = 0.999;
/// Red-black sweeps per step; each starts from the last step's pressure, so few are enough.
const SWEEPS: usize = 25;
/// Over-relaxation factor, in the usual range for a few dozen sweeps.
const RELAXATION: f64 = 1.75;

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

type Vector = [f64; 3];

/// The three components of the velocity, then the density of the smoke. They travel together
/// because one trajectory and one set of weights serve all four.
type Cell = [f64; 4];
const SMOKE: usize = 3;

fn index(x: usize, y: usize, z: usize) -> usize {
    y * ROW + z * WIDTH + x
}

/// Number of rows of a field. Rows are outermost in memory, so that the lower part of the
/// domain is a prefix of the slice.
fn rows<T>(field: &[T]) -> usize {
    field.len() / ROW
}

/// All cells of so many rows, in the order of memory.
fn cells(rows: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..rows).flat_map(|y| (0..WIDTH).flat_map(move |z| (0..WIDTH).map(move |x| [x, y, z])))
}

/// The cells at least `border` cells away from every side.
fn interior(rows: usize, border: usize) -> impl Iterator<Item = usize> {
    let across = border..WIDTH - border;
    (border..rows - border).flat_map(move |y| {
        let across = across.clone();
        across
            .clone()
            .flat_map(move |z| across.clone().map(move |x| index(x, y, z)))
    })
}

fn length(v: Vector) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

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

// ---- One step of the fluid ---------------------------------------------------------------

/// Warm smoke rises; a little of it thins out.
fn rise(field: &mut [Cell]) {
    for cell in field {
        cell[1] += BUOYANCY * cell[SMOKE];
        cell[SMOKE] *= PERSISTENCE;
    }
}

/// The two neighbours of a cell along each axis. Air moves on unchanged beyond the open sides;
/// under the floor is its mirror image, so that nothing flows through.
fn neighbours(field: &[Cell], at: [usize; 3]) -> [[Cell; 2]; 3] {
    [0, 1, 2].map(|axis| {
        let last = [WIDTH, rows(field), WIDTH][axis] - 1;
        let shifted = |to: usize| {
            let mut moved = at;
            moved[axis] = to;
            field[index(moved[0], moved[1], moved[2])]
        };
        let mut before = shifted(at[axis].saturating_sub(1));
        if axis == 1 && at[1] == 0 {
            before[1] = -before[1];
        }
        [before, shifted((at[axis] + 1).min(last))]
    })
}

/// ∂(component)/∂(axis) by central differences, from the neighbours of a cell.
fn slope(around: &[[Cell; 2]; 3], component: usize, axis: usize) -> f64 {
    0.5 * (around[axis][1][component] - around[axis][0][component])
}

/// Curl of the velocity.
fn vorticity(field: &[Cell]) -> Vec<Vector> {
    let curl = |at| {
        let d = neighbours(field, at);
        [
            slope(&d, 2, 1) - slope(&d, 1, 2),
            slope(&d, 0, 2) - slope(&d, 2, 0),
            slope(&d, 1, 0) - slope(&d, 0, 1),
        ]
    };
    cells(rows(field)).map(curl).collect()
}

/// Vorticity confinement: pushes the air around each vortex, where the lattice has slowed it.
fn confine(field: &mut [Cell]) {
    /// Below this the direction of the gradient is rounding noise.
    const FLAT: f64 = 1e-6;
    let vorticity = vorticity(field);
    let magnitude: Vec<f64> = vorticity.iter().map(|&v| length(v)).collect();
    for i in interior(rows(field), 1) {
        let gradient = STRIDES.map(|stride| magnitude[i + stride] - magnitude[i - stride]);
        let steepness = length(gradient);
        if steepness < FLAT {
            continue;
        }
        let [nx, ny, nz] = gradient.map(|g| CONFINEMENT * g / steepness);
        let [wx, wy, wz] = vorticity[i];
        field[i][0] += ny * wz - nz * wy;
        field[i][1] += nz * wx - nx * wz;
        field[i][2] += nx * wy - ny * wx;
    }
}

/// Shapiro's filter of fourth order along each axis: removes velocities that alternate from
/// cell to cell and leaves all that is smooth.
fn filter(field: &mut [Cell], components: Range<usize>, share: f64) {
    let mut old = field.to_vec();
    for stride in STRIDES {
        old.copy_from_slice(field);
        for i in interior(rows(field), 2) {
            for k in components.clone() {
                let near = old[i - stride][k] + old[i + stride][k];
                let far = old[i - 2 * stride][k] + old[i + 2 * stride][k];
                let fourth_difference = far - 4.0 * near + 6.0 * old[i][k];
                // 16 is the fourth difference of ±1.
                field[i][k] -= share * fourth_difference / 16.0;
            }
        }
    }
}

/// Index of the cell below, where the pressure under the floor equals that on it.
fn below(i: usize) -> usize {
    if i < ROW { i } else { i - ROW }
}

/// Solves Poisson's equation by red-black successive over-relaxation. The outermost cells are
/// open air at pressure 0, except on the floor.
fn relax(pressure: &mut [f64], divergence: &[f64], sweeps: usize) {
    let top = pressure.len() - ROW;
    pressure[top..].fill(0.0);
    for half_sweep in 0..2 * sweeps {
        for y in 0..rows(pressure) - 1 {
            for z in 1..WIDTH - 1 {
                let first = 1 + (y + z + half_sweep) % 2;
                for i in (index(first, y, z)..index(WIDTH - 1, y, z)).step_by(2) {
                    let around = pressure[i - 1]
                        + pressure[i + 1]
                        + pressure[below(i)]
                        + pressure[i + ROW]
                        + pressure[i - WIDTH]
                        + pressure[i + WIDTH];
                    let balanced = (around - divergence[i]) / 6.0;
                    pressure[i] += RELAXATION * (balanced - pressure[i]);
                }
            }
        }
    }
}

/// Makes the velocity free of divergence by taking away the gradient of the pressure.
fn project(field: &mut [Cell], pressure: &mut [f64], sweeps: usize) {
    let outflow = |at| {
        let d = neighbours(field, at);
        slope(&d, 0, 0) + slope(&d, 1, 1) + slope(&d, 2, 2)
    };
    let divergence: Vec<f64> = cells(rows(field)).map(outflow).collect();
    relax(pressure, &divergence, sweeps);
    for y in 0..rows(field) - 1 {
        for z in 1..WIDTH - 1 {
            for i in index(1, y, z)..index(WIDTH - 1, y, z) {
                field[i][0] -= 0.5 * (pressure[i + 1] - pressure[i - 1]);
                field[i][1] -= 0.5 * (pressure[i + ROW] - pressure[below(i)]);
                field[i][2] -= 0.5 * (pressure[i + WIDTH] - pressure[i - WIDTH]);
            }
        }
    }
}

/// The eight cells around a position, and where between them it lies.
struct Surroundings<'a> {
    corners: [&'a Cell; 8],
    fraction: Vector,
}

impl<'a> Surroundings<'a> {
    /// Positions outside the domain count as the nearest ones on its border.
    fn new(field: &'a [Cell], position: Vector) -> Self {
        let mut base = 0;
        let mut fraction = [0.0; 3];
        for axis in 0..3 {
            let last = [WIDTH, rows(field), WIDTH][axis] - 1;
            let inside = position[axis].clamp(0.0, last as f64);
            let lower = (inside as usize).min(last - 1);
            base += lower * STRIDES[axis];
            fraction[axis] = inside - lower as f64;
        }
        let [x, y, z] = STRIDES;
        let corners =
            [0, x, y, x + y, z, x + z, y + z, x + y + z].map(|offset| &field[base + offset]);
        Self { corners, fraction }
    }

    fn interpolate(&self) -> Cell {
        let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let [fx, fy, fz] = self.fraction;
        [0, 1, 2, 3].map(|k| {
            let edge = |n: usize| lerp(self.corners[n][k], self.corners[n + 1][k], fx);
            lerp(lerp(edge(0), edge(2), fy), lerp(edge(4), edge(6), fy), fz)
        })
    }

    /// `value`, confined to the range of the eight corners.
    fn limit(&self, value: Cell) -> Cell {
        [0, 1, 2, 3].map(|k| {
            let low = self
                .corners
                .iter()
                .map(|c| c[k])
                .fold(f64::INFINITY, f64::min);
            let high = self
                .corners
                .iter()
                .map(|c| c[k])
                .fold(f64::NEG_INFINITY, f64::max);
            value[k].clamp(low, high)
        })
    }
}

/// The position reached from a cell's centre at this velocity.
fn travel(at: [usize; 3], velocity: Vector, time: f64) -> Vector {
    [0, 1, 2].map(|axis| at[axis] as f64 + velocity[axis] * time)
}

/// Carries velocity and smoke along the flow: a step there, a step back, and half of the
/// difference that shows as the correction, limited so that nothing overshoots.
fn advect(field: &[Cell]) -> Vec<Cell> {
    let mut arrived = Vec::with_capacity(field.len());
    let mut carriers = Vec::with_capacity(field.len());
    for (at, &[u, v, w, _]) in cells(rows(field)).zip(field) {
        // The midpoint rule: straight steps would spiral out of every vortex.
        let midpoint = travel(at, [u, v, w], -0.5);
        let [u, v, w, _] = Surroundings::new(field, midpoint).interpolate();
        let origin = travel(at, [u, v, w], -1.0);
        arrived.push(Surroundings::new(field, origin).interpolate());
        carriers.push([u, v, w]);
    }
    let corrected = |(i, at): (usize, [usize; 3])| {
        let returned = Surroundings::new(&arrived, travel(at, carriers[i], 1.0)).interpolate();
        let better = [0, 1, 2, 3].map(|k| arrived[i][k] + 0.5 * (field[i][k] - returned[k]));
        Surroundings::new(field, travel(at, carriers[i], -1.0)).limit(better)
    };
    cells(rows(field)).enumerate().map(corrected).collect()
}

/// Rows that hold smoke or soon may.
fn active_rows(field: &[Cell]) -> usize {
    let holds_smoke = |row: &[Cell]| row.iter().any(|cell| cell[SMOKE] > 1e-4);
    let highest = field.chunks(ROW).rposition(holds_smoke).unwrap_or(0);
    (highest + HEADROOM).min(HEIGHT)
}

/// The density of the smoke after so many steps.
fn simulate() -> Vec<f64> {
    let mut field = draughty_air();
    let mut pressure = vec![0.0; field.len()];
    // The first projection starts from nothing.
    project(&mut field, &mut pressure, 3 * SWEEPS);
    pressure.fill(0.0);
    for step in 0..STEPS {
        emit(&mut field, step as f64);
        let active = active_rows(&field) * ROW;
        let active_field = &mut field[..active];
        rise(active_field);
        confine(active_field);
        filter(active_field, 0..SMOKE, FILTERING);
        project(active_field, &mut pressure[..active], SWEEPS);
        let moved = advect(active_field);
        active_field.copy_from_slice(&moved);
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
         # The density is the simulated one to the power {GAMMA}, which brings out the wisps.\n\
         # Made by scripts/generate-smoke.sh from scripts/smoke_plume.rs; do not edit.\n\
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

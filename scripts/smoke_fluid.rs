//! The fluid of the smoke plume: one step of Stam's stable fluids on a box of cells.
//!
//! Sources:
//! - Stam 1999, "Stable Fluids": forces, projection and advection one after the other.
//! - Fedkiw, Stam, Jensen 2001, "Visual Simulation of Smoke": buoyancy, vorticity confinement.
//! - Selle, Fedkiw, Kim, Liu, Rossignac 2008, "An Unconditionally Stable MacCormack Method":
//!   the advection, which keeps the curls that plain semi-Lagrangian steps wash out.
//! - Shapiro 1970, "Smoothing, Filtering, and Boundary Effects": the filter against odd-even
//!   modes, which a projection with all quantities at the cell centres cannot see.
//!
//! One cell is the unit of length and one step the unit of time.

use std::ops::Range;

/// Cells along x and z; wide enough that the smoke never reaches the open sides.
pub const WIDTH: usize = 96;
/// Cells along y, which points up; the smoke stops short of the open top.
pub const HEIGHT: usize = 128;
/// Cells in one horizontal row of the domain, and the distance in memory between two rows.
pub const ROW: usize = WIDTH * WIDTH;
/// Distance in memory to the next cell along x, y and z.
const STRIDES: [usize; 3] = [1, ROW, WIDTH];
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

pub type Vector = [f64; 3];

/// The three components of the velocity, then the density of the smoke. They travel together
/// because one trajectory and one set of weights serve all four.
pub type Cell = [f64; 4];
pub const SMOKE: usize = 3;

fn index(x: usize, y: usize, z: usize) -> usize {
    y * ROW + z * WIDTH + x
}

/// Number of rows of a field. Rows are outermost in memory, so that the lower part of the
/// domain is a prefix of the slice.
fn rows<T>(field: &[T]) -> usize {
    field.len() / ROW
}

/// All cells of so many rows, in the order of memory.
pub fn cells(rows: usize) -> impl Iterator<Item = [usize; 3]> {
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

pub fn length(v: Vector) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// Warm smoke rises; a little of it thins out.
fn rise(field: &mut [Cell]) {
    for cell in field {
        cell[1] += BUOYANCY * cell[SMOKE];
        cell[SMOKE] *= PERSISTENCE;
    }
}

/// Moves a field on by one step. `pressure` carries over from step to step as the first guess.
pub fn advance(field: &mut [Cell], pressure: &mut [f64]) {
    rise(field);
    confine(field);
    filter(field, 0..SMOKE, FILTERING);
    project(field, pressure, SWEEPS);
    let moved = advect(field);
    field.copy_from_slice(&moved);
}

/// A field made free of divergence. There is no first guess, hence more sweeps.
pub fn settled(mut field: Vec<Cell>) -> Vec<Cell> {
    let mut pressure = vec![0.0; field.len()];
    project(&mut field, &mut pressure, 3 * SWEEPS);
    field
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
pub fn filter(field: &mut [Cell], components: Range<usize>, share: f64) {
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
        let mut low = *self.corners[0];
        let mut high = low;
        for corner in self.corners {
            for k in 0..4 {
                // Plain comparisons: `min` and `max` cost more for the sake of NaN.
                low[k] = if corner[k] < low[k] {
                    corner[k]
                } else {
                    low[k]
                };
                high[k] = if corner[k] > high[k] {
                    corner[k]
                } else {
                    high[k]
                };
            }
        }
        [0, 1, 2, 3].map(|k| value[k].clamp(low[k], high[k]))
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

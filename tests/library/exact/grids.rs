//! The density of a grid, integrated along a line with many digits; and how well an `f64` can.

use super::{Big, U, big, rounded};
use glam::DVec3;
use volref::geometry::Span;
use volref::volume::{GridDensity, Interpolation};

/// A line in node units, by world distances.
struct ExactLine {
    origin: [Big; 3],
    direction: [Big; 3],
}

impl ExactLine {
    fn at(&self, t: &Big) -> [Big; 3] {
        std::array::from_fn(|axis| &self.origin[axis] + &self.direction[axis] * t)
    }
}

/// `∫ density dt` over `span`: all the planes where the density changes its polynomial, sorted;
/// between two of them Simpson's rule, which integrates cubics exactly, or the constant.
pub fn integral(density: &GridDensity, origin: DVec3, direction: DVec3, span: Span) -> Big {
    let lattice = density.grid().lattice();
    let spacing = lattice.spacing().to_array().map(big);
    let line = ExactLine {
        origin: std::array::from_fn(|axis| {
            (big(origin[axis]) - big(lattice.first()[axis])) / &spacing[axis]
        }),
        direction: std::array::from_fn(|axis| big(direction[axis]) / &spacing[axis]),
    };
    let nearest = density.interpolation() == Interpolation::Nearest;
    let (near, far) = (big(span.near), big(span.far));
    let mut cuts = vec![near.clone(), far.clone()];
    for axis in (0..3).filter(|&axis| direction[axis] != 0.0) {
        let nodes = lattice.nodes()[axis];
        let planes = (0..nodes).map(|node| {
            if nearest {
                node as f64 - 0.5
            } else {
                node as f64
            }
        });
        let crossings =
            planes.map(|plane| (big(plane) - &line.origin[axis]) / &line.direction[axis]);
        cuts.extend(crossings.filter(|t| near < *t && *t < far));
    }
    cuts.sort();
    let two = big(2.0);
    let mut sum = big(0.0);
    for pair in cuts.windows(2) {
        let length = &pair[1] - &pair[0];
        let middle = line.at(&((&pair[0] + &pair[1]) / &two));
        if nearest {
            sum += big(nearest_value(density, &middle)) * length;
            continue;
        }
        let value = |at: &[Big; 3]| trilinear_value(density, &middle, at);
        let ends = value(&line.at(&pair[0])) + value(&line.at(&pair[1]));
        sum += (ends + big(4.0) * value(&middle)) * length / big(6.0);
    }
    sum
}

/// The value of the node nearest to a place inside its cell.
fn nearest_value(density: &GridDensity, place: &[Big; 3]) -> f64 {
    let lattice = density.grid().lattice();
    let node = std::array::from_fn(|axis| {
        let last = (lattice.nodes()[axis] - 1) as f64;
        rounded(&place[axis]).round().clamp(0.0, last) as usize
    });
    f64::from(density.grid().values()[lattice.index(node)])
}

/// The polynomial of the cell that `within` lies in, at the place `at`: corner by corner.
fn trilinear_value(density: &GridDensity, within: &[Big; 3], at: &[Big; 3]) -> Big {
    let lattice = density.grid().lattice();
    let low: [f64; 3] = std::array::from_fn(|axis| rounded(&within[axis]).floor());
    let share: [Big; 3] = std::array::from_fn(|axis| &at[axis] - big(low[axis]));
    let mut sum = big(0.0);
    for corner in 0..8 {
        let mut weight = big(1.0);
        let mut node = [0; 3];
        for axis in 0..3 {
            let upper = corner >> axis & 1;
            weight *= if upper == 1 {
                share[axis].clone()
            } else {
                big(1.0) - &share[axis]
            };
            let last = (lattice.nodes()[axis] - 1) as f64;
            node[axis] = (low[axis] + f64::from(upper)).clamp(0.0, last) as usize;
        }
        sum += weight * big(f64::from(density.grid().values()[lattice.index(node)]));
    }
    sum
}

/// A bound on the rounding of [`GridDensity::integral`], in units of density times length.
///
/// In units of `u`, with `Q` the largest node coordinate on the way, of an axis: that of the
/// origin, what is gone from there to the end, and one for the shift to the corners of cells.
///
/// - A place is off by `10Q` nodes: the origin in node units 2, the direction 1, the distance 4
///   (the two places of Gauss's rule: a constant, two products and a sum), a product and a sum
///   with what came before, 3. A plane is crossed `6Q` nodes beside it at most: the origin 2, the
///   shift 1, the direction 1, a difference and a quotient. The same 10 shall do for both.
/// - The trilinear density changes by no more per node than the range of values `R` on each of
///   three axes: `30QR`. Three interpolations of three roundings of at most the largest value V
///   each, 9V; the rule's sum, half, product and length, 4V; the sum of the pieces, which carries
///   its error, 2V and the products of roundings 1V. A place that is taken to lie in the cell
///   beside its own sees that cell's polynomial, which has the same value in their plane: that is
///   an error in the place again.
/// - The nearest node's value is exact but changes at the planes: wrong for as long as a plane is
///   displaced, `10Q/|d|` in distance with `d` the direction in node units, to either side, at
///   every plane of the axis, by at most R. Where a ray runs beside a plane, that is long; where it
///   runs in one, to rounding, all of its length.
pub fn integral_error(density: &GridDensity, origin: DVec3, direction: DVec3, span: Span) -> f64 {
    let lattice = density.grid().lattice();
    let (least, most) = density.grid().range();
    let range = most - least;
    let direction = direction / lattice.spacing();
    let reach = span.near.abs().max(span.far.abs());
    let coordinates = lattice.to_nodes(origin).0.abs() + direction.abs() * reach + 1.0;
    match density.interpolation() {
        Interpolation::Trilinear => {
            let places = coordinates.x + coordinates.y + coordinates.z;
            U * span.length() * (10.0 * places * range + 16.0 * most)
        }
        Interpolation::Nearest => {
            let displaced = (0..3).map(|axis| {
                let beside = 10.0 * U * coordinates[axis];
                if direction[axis] != 0.0 {
                    let planes = lattice.nodes()[axis] as f64;
                    return 2.0 * planes * beside / direction[axis].abs();
                }
                // Along a plane, the whole ray may be taken to lie on the other side of it.
                let from_node = lattice.to_nodes(origin).0[axis].fract().abs();
                let in_a_plane = (from_node - 0.5).abs() <= beside;
                if in_a_plane { span.length() } else { 0.0 }
            });
            displaced.sum::<f64>() * range + 7.0 * U * span.length() * most
        }
    }
}

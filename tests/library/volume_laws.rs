//! Laws of splatting, interpolation and gradients, each over its whole domain.

use crate::common::{self, vector};
use glam::DVec3;
use proptest::prelude::*;
use std::sync::Arc;
use volref::geometry::{Aabb, Line, Ray};
use volref::math::{Sum, powu};
use volref::volume::*;

/// Half a unit in the last place of 1: the largest relative error of one rounding.
const U: f64 = f64::EPSILON / 2.0;

fn config() -> ProptestConfig {
    common::failures_in("fixtures/proptest-regressions/volume_laws.txt")
}

fn lattice(least_nodes: usize) -> impl Strategy<Value = Lattice> {
    let nodes = prop::array::uniform3(least_nodes..=9);
    (nodes, vector(0.01..10.0), vector(-10.0..10.0))
        .prop_map(|(nodes, spacing, first)| Lattice::new(nodes, spacing, first).unwrap())
}

fn grid<T: std::fmt::Debug + Clone>(
    value: impl Strategy<Value = T> + Clone,
) -> impl Strategy<Value = Grid<T>> {
    lattice(1).prop_flat_map(move |lattice| {
        prop::collection::vec(value.clone(), lattice.node_count())
            .prop_map(move |values| Grid::new(lattice, values).unwrap())
    })
}

/// Any node position, any place inside, and some way outside; often halfway between nodes.
fn position() -> impl Strategy<Value = DVec3> {
    let coordinate = prop_oneof![
        -12.0..20.0_f64,
        (-24..40_i32).prop_map(|halves| f64::from(halves) / 2.0)
    ];
    vector(coordinate)
}

fn nodes_of(lattice: &Lattice) -> impl Iterator<Item = [usize; 3]> + use<> {
    let lattice = *lattice;
    (0..lattice.node_count()).map(move |index| lattice.node(index))
}

fn in_node_units(node: [usize; 3]) -> DVec3 {
    DVec3::from_array(node.map(|n| n as f64))
}

/// A grid of the values of `field` at the nodes, which it is given in node units.
fn sampled<T>(lattice: Lattice, field: impl Fn([usize; 3]) -> T) -> Grid<T> {
    Grid::new(lattice, nodes_of(&lattice).map(field).collect()).unwrap()
}

// Splatting.

fn cloud() -> impl Strategy<Value = Vec<CloudPoint>> {
    // Tenths make clouds that are lattices, or nearly, by decimal numbers.
    let coordinate = prop_oneof![
        -10.0..10.0_f64,
        (-50..50_i32).prop_map(|tenths| f64::from(tenths) / 10.0)
    ];
    let weight = prop_oneof![Just(0.0), Just(1.0), 0.0..10.0_f64];
    let point =
        (prop::array::uniform3(coordinate), weight).prop_map(|(position, weight)| CloudPoint {
            position: position.into(),
            weight,
        });
    let two_apart = |points: &Vec<CloudPoint>| {
        let first = points[0].position;
        points.iter().any(|point| point.position != first)
    };
    prop::collection::vec(point, 2..60).prop_filter("two distinct points", two_apart)
}

fn splatting() -> impl Strategy<Value = Splatting> {
    (0..4_usize, 2..20_usize).prop_map(|(padding, inside)| Splatting {
        resolution: Some(inside + 2 * padding),
        padding,
    })
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn splatting_conserves_the_weight(points in cloud(), splatting in splatting()) {
        let grid = splat_weights(&points, splatting).unwrap();
        let given = points.iter().map(|point| point.weight).collect::<Sum>().value();
        let spread = grid.values().iter().copied().collect::<Sum>().value();
        // A share takes six roundings (three of 1 − t, three products), a node at most n − 1
        // additions to something; the two sums here are rounded once each, and one rounding
        // covers their second-order terms.
        let roundings = (points.len() + 8) as f64;
        let bound = roundings * U / (1.0 - roundings * U) * given;
        prop_assert!((given - spread).abs() <= bound, "{given} became {spread}");
    }

}

// Interpolation.

proptest! {
    #![proptest_config(config())]

    #[test]
    fn trilinear_fields_are_reproduced(
        lattice in lattice(1),
        coefficients in prop::array::uniform8(-100..=100_i32),
        within in vector(0.0..1.0),
    ) {
        let coefficients = coefficients.map(f64::from);
        let terms = |DVec3 { x, y, z }| {
            let products = [1.0, x, y, z, x * y, y * z, x * z, x * y * z];
            std::array::from_fn::<f64, 8, _>(|n| coefficients[n] * products[n])
        };
        // Whole numbers, so the stored values are exact.
        let grid = sampled(lattice, |node| terms(in_node_units(node)).iter().sum::<f64>());
        let last = in_node_units(lattice.nodes().map(|n| n - 1));
        let at = within * last;
        let expected: f64 = terms(at).iter().sum();
        let value = Cell::around(&lattice, NodePoint(at)).trilinear(&grid);
        // Let S bound the sum of the magnitudes of the terms throughout the cell, hence the
        // values at its corners. One a + (b − a)·t takes a difference and a product, each at
        // most 2S, and a sum of at most S: 5uS, three times in a row. The expected value takes
        // three products and seven additions: 10uS. One more covers products of errors.
        let far_corner = (at.floor() + 1.0).min(last);
        let magnitude: f64 = terms(far_corner).iter().map(|term| term.abs()).sum();
        prop_assert!((value - expected).abs() <= 26.0 * U * magnitude, "{value} {expected}");
    }

    #[test]
    fn the_nearest_node_is_the_nearest(lattice in lattice(1), at in position()) {
        let indices = sampled(lattice, |node| lattice.index(node) as f64);
        let distance = |node: [usize; 3]| (at - in_node_units(node)).abs();
        let least = nodes_of(&lattice)
            .map(distance)
            .fold(DVec3::INFINITY, DVec3::min);
        // Of several, the last: the one with the larger index on each axis.
        let nearest = nodes_of(&lattice).filter(|&node| distance(node) == least).last();
        let found = Cell::around(&lattice, NodePoint(at)).nearest(&indices);
        prop_assert_eq!(Some(lattice.node(found as usize)), nearest);
    }
}

// Gradients.

/// A lattice with dyadic spacing and position, where whole-number fields are exact.
fn dyadic_lattice(least_nodes: usize) -> impl Strategy<Value = Lattice> {
    let spacing = prop::array::uniform3(-2..=2_i32);
    let first = prop::array::uniform3(-8..=8_i32);
    (prop::array::uniform3(least_nodes..=6), spacing, first).prop_map(|(nodes, spacing, first)| {
        let spacing = DVec3::from_array(spacing.map(power_of_two));
        let first = DVec3::from_array(first.map(|quarters| f64::from(quarters) / 4.0));
        Lattice::new(nodes, spacing, first).unwrap()
    })
}

fn power_of_two(exponent: i32) -> f64 {
    let power = powu(2.0, exponent.unsigned_abs());
    if exponent < 0 { 1.0 / power } else { power }
}

fn density() -> std::ops::Range<f32> {
    0.0..1000.0
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn quadratic_fields_have_exact_gradients(
        lattice in dyadic_lattice(3),
        constant in -20..=20_i32,
        linear in prop::array::uniform3(-20..=20_i32),
        diagonal in prop::array::uniform3(-20..=20_i32),
        mixed in prop::array::uniform3(-20..=20_i32),
        quadratic in any::<bool>(),
    ) {
        let vector = |numbers: [i32; 3]| DVec3::from_array(numbers.map(f64::from));
        let curved = f64::from(u8::from(quadratic));
        let linear = vector(linear);
        let (diagonal, mixed) = (vector(diagonal) * curved, vector(mixed) * curved);
        // mixed: the coefficients of yz, zx and xy.
        let field = |p: DVec3| {
            f64::from(constant)
                + linear.dot(p)
                + (diagonal * p).dot(p)
                + mixed.dot(DVec3::new(p.y * p.z, p.z * p.x, p.x * p.y))
        };
        let slope = |p: DVec3| {
            let [a, b, c] = mixed.to_array();
            linear + 2.0 * diagonal * p
                + DVec3::new(b * p.z + c * p.y, c * p.x + a * p.z, a * p.y + b * p.x)
        };
        let double = sampled(lattice, |node| field(lattice.position(node)));
        // At most 20 bits: exact in f32 as well.
        let single = sampled(lattice, |node| field(lattice.position(node)) as f32);
        let (double, single) = (gradients(&double), gradients(&single));
        for node in nodes_of(&lattice) {
            let mut inner = node;
            for axis in 0..3 {
                inner[axis] = node[axis].clamp(1, lattice.nodes()[axis] - 2);
            }
            // At a border node, the gradient of the nearest inner one.
            let expected = slope(lattice.position(inner));
            let index = lattice.index(node);
            prop_assert_eq!(DVec3::from_array(double.values()[index]), expected);
            prop_assert_eq!(DVec3::from_array(single.values()[index].map(f64::from)), expected);
        }
    }

    #[test]
    fn thin_axes_have_no_gradient(grid in grid(density())) {
        let gradients = gradients(&grid);
        for axis in (0..3).filter(|&axis| grid.lattice().nodes()[axis] < 3) {
            prop_assert!(gradients.values().iter().all(|gradient| gradient[axis] == 0.0));
        }
        // The other axes do not notice: every slice has the gradient it has alone.
        if let [nx, ny, 2] = grid.lattice().nodes() {
            let slice = Lattice::new([nx, ny, 1], grid.lattice().spacing(), DVec3::ZERO).unwrap();
            let values = grid.values()[nx * ny..].to_vec();
            let alone = volref::volume::gradients(&Grid::new(slice, values).unwrap());
            prop_assert_eq!(&gradients.values()[nx * ny..], alone.values());
        }
    }

}

// ---------------------------------------------------------------------------------------------
// Bounds on densities.

/// A point of a box, faces and corners as often as the inside.
fn within(bounds: &Aabb, place: [f64; 3]) -> DVec3 {
    let at = DVec3::from(place).clamp(DVec3::ZERO, DVec3::ONE);
    (bounds.min + bounds.size() * at).clamp(bounds.min, bounds.max)
}

proptest! {
    #![proptest_config(config())]

    /// No density of a grid, as it is computed, is outside its range over a box around the
    /// point: any values, boxes that begin and end anywhere, inside the grid and beyond it.
    #[test]
    fn ranges_of_grids_hold(
        values in prop::collection::vec(prop_oneof![Just(0.0_f32), 0.0..1e-3_f32, 0.0..1e6_f32], 60),
        cells in any::<bool>(),
        nearest in any::<bool>(),
        first in prop::array::uniform3(-3.0..3.0_f64),
        corner in prop::array::uniform3(-1.5..6.5_f64),
        size in prop::array::uniform3(0.0..4.0_f64),
        place in prop::array::uniform3(-0.5..1.5_f64),
    ) {
        let (first, spacing) = (DVec3::from(first), DVec3::new(0.3, 0.7, 1.1));
        let mut lattice = Lattice::new([3, 4, 5], spacing, first).unwrap();
        if cells {
            lattice = lattice.with_centring(Centring::Cells).unwrap();
        }
        let interpolation = if nearest { Interpolation::Nearest } else { Interpolation::Trilinear };
        let grid = Arc::new(Grid::new(lattice, values).unwrap());
        let density = GridDensity::new(grid, interpolation);
        let min = first + DVec3::from(corner) * spacing;
        let bounds = Aabb::new(min, min + DVec3::from(size) * spacing).unwrap();
        let range = density.range_over(&bounds);
        let found = density.density(within(&bounds, place));
        prop_assert!(range.low <= found && found <= range.high, "{found} {range:?}");
    }

    /// Blocks of a division hold the bounds of what is in them, and a walk meets each point in
    /// a block that it lies in.
    #[test]
    fn blocks_hold_along_lines(
        origin in prop::array::uniform3(-4.0..4.0_f64),
        target in prop::array::uniform3(-0.9..0.9_f64),
        centre in prop::array::uniform3(-1.0..1.0_f64),
        counts in prop::array::uniform3(1_usize..6),
        t in 0.0..1.0_f64,
    ) {
        let bounds = Aabb::new(DVec3::NEG_ONE, DVec3::ONE).unwrap();
        let blob = Blob { centre: centre.into(), peak: 2.0, width: 0.4 };
        let size = bounds.size() / DVec3::from_array(counts.map(|count| count as f64));
        let blocks = Blocks::of(&blob, bounds, counts, size);
        let (origin, target) = (DVec3::from(origin), DVec3::from(target));
        prop_assume!((target - origin).length() > 1e-3);
        let ray = Ray::new(origin, target - origin).unwrap();
        let Some(span) = bounds.span(&ray) else { return Ok(()); };
        for visit in blocks.walk(&Line::from(&ray), span) {
            let range = blocks.range_in(visit.cell);
            let block = blocks.cell_bounds(visit.cell);
            let point = ray.at(visit.span.near + t * visit.span.length());
            // A point of the visit is a point of the block, but for roundings.
            let moved = (point.clamp(block.min, block.max) - point).abs().max_element();
            prop_assert!(moved < 1e-13);
            let found = blob.density(point.clamp(block.min, block.max));
            prop_assert!(range.low <= found && found <= range.high);
        }
    }
}

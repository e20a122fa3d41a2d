//! Interpolation and gradients against numbers from outside.
//!
//! Not tested, because nothing here corresponds: `cell_centred_first_last` (grids are
//! node-centred), `analytic_gradient_per_cell_unit` (gradients are stored at the nodes and
//! interpolated, not derived from the interpolant) and `one_sided_difference_at_min_corner` (a
//! border node takes the gradient of the nearest inner node). Gradients at queries in a border
//! cell, and at the corner, differ by that same rule.

use crate::common::entries::numbers;
use glam::DVec3;
use serde_json::Value;
use volref::volume::*;

fn entry(id: &str) -> Value {
    let text = include_str!("../../fixtures/known-answers/interpolation_gradient.json");
    let file: Value = serde_json::from_str(text).unwrap();
    let entries = file["entries"].as_array().unwrap();
    let entry = entries.iter().find(|entry| entry["id"] == id).unwrap();
    entry.clone()
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&numbers(value))
}

fn vectors(value: &Value) -> Vec<DVec3> {
    value.as_array().unwrap().iter().map(vector).collect()
}

fn counts(value: &Value) -> [usize; 3] {
    let counts = value.as_array().unwrap();
    std::array::from_fn(|axis| counts[axis].as_u64().unwrap() as usize)
}

fn lattice(entry: &Value) -> Lattice {
    let inputs = &entry["inputs"];
    let nodes = counts(&inputs["resolution"]);
    let (min, max) = (vector(&inputs["min"]), vector(&inputs["max"]));
    let intervals = DVec3::from_array(nodes.map(|n| (n - 1) as f64));
    Lattice::new(nodes, (max - min) / intervals, min).unwrap()
}

fn sampled(lattice: Lattice, field: impl Fn(DVec3) -> f64) -> Grid<f64> {
    let nodes = (0..lattice.node_count()).map(|index| lattice.node(index));
    let values = nodes.map(|node| field(lattice.position(node))).collect();
    Grid::new(lattice, values).unwrap()
}

fn cell(lattice: &Lattice, world: DVec3) -> Cell {
    Cell::around(lattice, lattice.to_nodes(world))
}

#[track_caller]
fn assert_close(entry: &Value, found: f64, expected: f64) {
    let digits = entry["digits"].as_u64().unwrap();
    let relative = format!("1e-{digits}").parse::<f64>().unwrap();
    // An expected zero is meant absolutely.
    let magnitude = if expected == 0.0 { 1.0 } else { expected.abs() };
    assert!(
        (found - expected).abs() <= relative * magnitude,
        "found {found}, expected {expected}"
    );
}

/// The digits count against the length of the vector: a component may be a small difference of
/// large values, with their rounding.
#[track_caller]
fn assert_vectors_close(entry: &Value, found: DVec3, expected: DVec3) {
    let distance = (found - expected).length();
    assert_close(entry, expected.length() + distance, expected.length());
}

/// The queries whose cell has only inner nodes, with their index.
fn inner_queries(entry: &Value) -> Vec<(usize, DVec3)> {
    let lattice = lattice(entry);
    let last = DVec3::from_array(lattice.nodes().map(|n| (n - 2) as f64));
    let inner = |query: DVec3| {
        let at = lattice.to_nodes(query).0;
        at.cmpge(DVec3::ONE).all() && at.cmple(last).all()
    };
    let queries = vectors(&entry["inputs"]["query"]).into_iter().enumerate();
    queries.filter(|&(_, query)| inner(query)).collect()
}

/// Interpolated gradients are those of the entry, at its two inner queries.
#[track_caller]
fn assert_gradients_close(entry: &Value, gradients: &Grid<[f64; 3]>) {
    let expected = vectors(&entry["expected"]["gradient"]);
    let queries = inner_queries(entry);
    assert_eq!(queries.len(), 2);
    for (index, query) in queries {
        let found = cell(gradients.lattice(), query).trilinear(gradients);
        assert_vectors_close(entry, found, expected[index]);
    }
}

#[test]
fn p001_a_trilinear_field_is_reproduced() {
    let entry = entry("interpolation-p001");
    let [a, b, c, d, e, f, g, h] = numbers(&entry["inputs"]["coefficients_1_x_y_z_xy_yz_xz_xyz"])
        .try_into()
        .unwrap();
    let lattice = lattice(&entry);
    let grid = sampled(lattice, |DVec3 { x, y, z }| {
        a + b * x + c * y + d * z + e * x * y + f * y * z + g * x * z + h * x * y * z
    });
    let expected = numbers(&entry["expected"]["value"]);
    let queries = vectors(&entry["inputs"]["query"]);
    assert_eq!(queries.len(), expected.len());
    for (&query, expected) in queries.iter().zip(expected) {
        assert_close(&entry, cell(&lattice, query).trilinear(&grid), expected);
    }
    let [first, last] = numbers(&entry["expected"]["node_centred_first_last"])
        .try_into()
        .unwrap();
    assert_close(&entry, grid.values()[0], first);
    assert_close(&entry, grid.values()[lattice.node_count() - 1], last);

    assert_gradients_close(&entry, &gradients(&grid));
}

#[test]
fn p002_a_quadratic_field_is_interpolated_and_its_gradient_exact() {
    let entry = entry("interpolation-p002");
    let inputs = &entry["inputs"];
    let constant = inputs["constant"].as_f64().unwrap();
    let linear = vector(&inputs["linear"]);
    let rows = vectors(&inputs["hessian"]);
    let hessian = |p: DVec3| DVec3::new(rows[0].dot(p), rows[1].dot(p), rows[2].dot(p));
    let field = |p: DVec3| constant + linear.dot(p) + p.dot(hessian(p)) / 2.0;
    let lattice = lattice(&entry);
    let grid = sampled(lattice, field);
    let truth = numbers(&entry["expected"]["value"]);
    let between = numbers(&entry["expected"]["value_interpolated_on_node_grid"]);
    let queries = vectors(&inputs["query"]);
    assert_eq!(queries.len(), between.len());
    for ((&query, truth), between) in queries.iter().zip(truth).zip(between) {
        assert_close(&entry, field(query), truth);
        assert_close(&entry, cell(&lattice, query).trilinear(&grid), between);
    }

    let gradients = gradients(&grid);
    assert_gradients_close(&entry, &gradients);
    // The corner takes the gradient of node (1, 1, 1), one step along the Hessian from its own.
    let corner = vector(&entry["expected"]["gradient_at_min_corner"]);
    let found = DVec3::from_array(gradients.values()[0]);
    assert_vectors_close(&entry, found, corner + hessian(lattice.spacing()));
}

#[test]
fn p003_a_single_cell() {
    let entry = entry("interpolation-p003");
    let lattice = Lattice::new([2, 2, 2], DVec3::ONE, DVec3::ZERO).unwrap();
    let grid = Grid::new(lattice, numbers(&entry["inputs"]["corners"])).unwrap();
    let expected = numbers(&entry["expected"]["value"]);
    let queries = vectors(&entry["inputs"]["query"]);
    assert_eq!(queries.len(), expected.len());
    for (&query, expected) in queries.iter().zip(expected) {
        assert_close(&entry, cell(&lattice, query).trilinear(&grid), expected);
    }
}

#[test]
fn p004_x_runs_fastest() {
    let entry = entry("interpolation-p004");
    let nodes = counts(&entry["inputs"]["resolution"]);
    let lattice = Lattice::new(nodes, DVec3::ONE, DVec3::ZERO).unwrap();
    let grid = sampled(lattice, |p| p.x + 10.0 * p.y + 100.0 * p.z);
    let indices = numbers(&entry["inputs"]["linear_index"]);
    let expected = numbers(&entry["expected"]["value"]);
    assert_eq!(indices.len(), expected.len());
    for (index, expected) in indices.into_iter().zip(expected) {
        assert_eq!(grid.values()[index as usize], expected);
    }
}

//! Shapes and their maps in numbers.

use super::inline_arrays::{Entries, Json};
use crate::geometry::{Aabb, Mesh, Rectangle, Shape, Sphere, Transform};

/// A shape, with the map that places it; a mesh as `of_mesh` states it.
pub(super) fn of_shape(
    shape: &Shape,
    mut of_mesh: impl FnMut(&Mesh) -> Entries,
) -> (Entries, Option<&Transform>) {
    match shape {
        Shape::Sphere(sphere) => (of_sphere(sphere), None),
        Shape::Box(bounds) => (of_box(bounds), None),
        Shape::Rectangle(rectangle) => (of_rectangle(rectangle), None),
        Shape::Mesh(mesh) => (of_mesh(mesh), None),
        Shape::PlacedSphere(placed) => (of_sphere(placed.shape()), Some(placed.to_world())),
        Shape::PlacedBox(placed) => (of_box(placed.shape()), Some(placed.to_world())),
        Shape::PlacedMesh(placed) => (of_mesh(placed.shape()), Some(placed.to_world())),
    }
}

/// The rows of a map.
pub(super) fn matrix(to_world: &Transform) -> Json {
    let rows = to_world.rows().map(|row| Json::from(Vec::from(row)));
    Json::List(rows.into())
}

/// The rows of a map, or null.
pub(super) fn matrix_or_null(to_world: Option<&Transform>) -> Json {
    to_world.map_or(().into(), matrix)
}

pub(super) fn of_sphere(sphere: &Sphere) -> Entries {
    vec![
        ("kind", "sphere".into()),
        ("centre", sphere.centre().to_array().into()),
        ("radius", sphere.radius().into()),
    ]
}

pub(super) fn of_box(bounds: &Aabb) -> Entries {
    vec![
        ("kind", "box".into()),
        ("min", bounds.min.to_array().into()),
        ("max", bounds.max.to_array().into()),
    ]
}

pub(super) fn of_rectangle(rectangle: &Rectangle) -> Entries {
    let [corner, edge_u, edge_v] = rectangle.corner_and_edges();
    vec![
        ("kind", "rectangle".into()),
        ("corner", corner.to_array().into()),
        ("edge_u", edge_u.to_array().into()),
        ("edge_v", edge_v.to_array().into()),
    ]
}

/// A mesh with its numbers inline.
pub(super) fn of_mesh(mesh: &Mesh) -> Entries {
    let vertices = mesh.vertices().iter();
    let vertices = vertices.map(|vertex| Json::from(Vec::from(vertex.to_array())));
    let faces = mesh.faces().iter().map(|face| Json::from(Vec::from(*face)));
    vec![
        ("kind", "mesh".into()),
        ("vertices", Json::List(vertices.collect())),
        ("triangles", Json::List(faces.collect())),
    ]
}

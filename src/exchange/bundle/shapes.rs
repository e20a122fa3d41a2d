//! Shapes and their maps in numbers.

use super::inline_arrays::{Entries, Json};
use crate::exchange::forms::{Base, Placing};
use crate::geometry::{Mesh, Transform};

/// A shape, with the map that places it; a mesh as `of_mesh` states it.
pub(super) fn of_shape(
    (base, to_world): Placing<'_>,
    of_mesh: impl FnOnce(&Mesh) -> Entries,
) -> (Entries, Json) {
    let entries = match base {
        Base::Sphere(sphere) => vec![
            ("kind", "sphere".into()),
            ("centre", sphere.centre().to_array().into()),
            ("radius", sphere.radius().into()),
        ],
        Base::Box(bounds) => vec![
            ("kind", "box".into()),
            ("min", bounds.min.to_array().into()),
            ("max", bounds.max.to_array().into()),
        ],
        Base::Rectangle(rectangle) => {
            let [corner, edge_u, edge_v] = rectangle.corner_and_edges();
            vec![
                ("kind", "rectangle".into()),
                ("corner", corner.to_array().into()),
                ("edge_u", edge_u.to_array().into()),
                ("edge_v", edge_v.to_array().into()),
            ]
        }
        Base::Mesh(mesh) => of_mesh(mesh),
    };
    (entries, to_world.map_or(().into(), matrix))
}

/// The rows of a map.
pub(super) fn matrix(to_world: &Transform) -> Json {
    let rows = to_world.rows().map(|row| Json::from(Vec::from(row)));
    Json::List(rows.into())
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

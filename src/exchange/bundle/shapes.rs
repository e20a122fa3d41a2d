//! Shapes and their maps in numbers.

use super::inline_arrays::{Entries, Json, entries};
use crate::exchange::forms::{Base, Placing};
use crate::geometry::{Mesh, Transform};

/// A shape, with the map that places it; a mesh as `of_mesh` states it.
pub(super) fn of_shape(
    (base, to_world): Placing<'_>,
    of_mesh: impl FnOnce(&Mesh) -> Entries,
) -> (Entries, Json) {
    let entries = match base {
        Base::Sphere(sphere) => entries! {
            "kind": "sphere", "centre": sphere.centre(), "radius": sphere.radius(),
        },
        Base::Box(bounds) => entries! { "kind": "box", "min": bounds.min, "max": bounds.max },
        Base::Rectangle(rectangle) => {
            let [corner, edge_u, edge_v] = rectangle.corner_and_edges();
            entries! { "kind": "rectangle", "corner": corner, "edge_u": edge_u, "edge_v": edge_v }
        }
        Base::Mesh(mesh) => of_mesh(mesh),
    };
    (entries, to_world.map_or(().into(), matrix))
}

/// The rows of a map.
pub(super) fn matrix(to_world: &Transform) -> Json {
    to_world.rows().into()
}

/// A mesh with its numbers inline.
pub(super) fn of_mesh(mesh: &Mesh) -> Entries {
    entries! {
        "kind": "mesh", "vertices": mesh.vertices().to_vec(), "triangles": mesh.faces().to_vec(),
    }
}

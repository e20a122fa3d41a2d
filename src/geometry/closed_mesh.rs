//! Meshes that enclose a volume.

use super::forward::forward;
use super::{Aabb, Crossing, Hit, Mesh, ObjFault, Ray, Side, Solid, Span, Surface};
use crate::math::Sum;
use std::sync::Arc;

/// A mesh without border, its normals outward: the boundary of a body or a medium. It may be
/// concave, have holes like a ring, and be in several pieces; a piece turned inside out within
/// another is a cavity.
#[derive(Clone, Debug)]
pub struct ClosedMesh(Arc<Mesh>);

/// A side of a face: the lower vertex number first.
struct MeshEdge {
    ends: [usize; 2],
    /// Whether the face traverses the edge from the lower number to the higher.
    ascending: bool,
    face: usize,
}

impl ClosedMesh {
    /// `mesh`, if every edge belongs to exactly two faces that run along it in opposite
    /// directions, and the enclosed volume is positive.
    ///
    /// Vertices at the same position count as different unless they have the same number;
    /// [`Mesh::load`] gives them the same number.
    pub fn new(mesh: impl Into<Arc<Mesh>>) -> Result<ClosedMesh, ObjFault> {
        let mesh = mesh.into();
        check_edges(&mesh)?;
        let volume = volume(&mesh);
        if volume > 0.0 {
            Ok(ClosedMesh(mesh))
        } else {
            Err(ObjFault::in_file(format!(
                "the mesh is inside out (it encloses the volume {volume}); reverse the order of the corners of every face"
            )))
        }
    }

    /// The surface itself.
    pub fn mesh(&self) -> &Mesh {
        &self.0
    }

    /// True if `mesh` is closed and its normals point inward.
    pub(crate) fn is_inside_out(mesh: &Mesh) -> bool {
        volume(mesh) < 0.0 && check_edges(mesh).is_ok()
    }
}

impl Surface for ClosedMesh {
    forward! { (.0)
        fn bounds() -> Aabb;
        fn crossing(ray: &Ray, limit: f64) -> Option<Crossing>;
        fn hit_at(ray: &Ray, crossing: &Crossing) -> Hit;
        fn blocks(ray: &Ray, limit: f64) -> bool;
    }
}

impl Solid for ClosedMesh {
    /// Counts entries minus exits of the line. Over the whole line they cancel, through edges and
    /// vertices too, so that those ahead of the origin tell how often it is inside, without a test of
    /// its own.
    fn append_spans(&self, ray: &Ray, spans: &mut Vec<Span>) {
        let mut crossings = Vec::with_capacity(16);
        self.0.crossings(ray, 0.0, &mut crossings);
        crossings.retain(|crossing| crossing.t >= 0.0);
        // In before out where both are at the same place: pieces that touch make one span.
        crossings.sort_unstable_by(|a, b| {
            let out = |side| side == Side::Back;
            a.t.total_cmp(&b.t).then(out(a.side).cmp(&out(b.side)))
        });
        let out = crossings.iter().filter(|it| it.side == Side::Back).count();
        // Depth within the pieces around the origin.
        let mut depth = 2 * out as i64 - crossings.len() as i64;
        let mut entered = 0.0;
        for crossing in &crossings {
            if crossing.side == Side::Front {
                depth += 1;
                if depth == 1 {
                    entered = crossing.t;
                }
            } else {
                if depth == 1 {
                    spans.extend(super::ray::ahead(entered, crossing.t));
                }
                depth -= 1;
            }
        }
    }
}

fn edges(mesh: &Mesh) -> Vec<MeshEdge> {
    let sides = |&[a, b, c]: &[usize; 3]| [[a, b], [b, c], [c, a]];
    let faces = mesh.faces().iter().enumerate();
    faces
        .flat_map(|(face, corners)| {
            sides(corners).map(|[from, to]| MeshEdge {
                ends: [from.min(to), from.max(to)],
                ascending: from < to,
                face,
            })
        })
        .collect()
}

/// Checks that every edge has two faces that agree about their front.
fn check_edges(mesh: &Mesh) -> Result<(), ObjFault> {
    let mut edges = edges(mesh);
    edges.sort_by_key(|edge| (edge.ends, edge.face));
    let mut shared = edges.chunk_by(|a, b| a.ends == b.ends);
    let agree = |sharing: &&[MeshEdge]| match sharing {
        [a, b] => a.ascending != b.ascending,
        _ => false,
    };
    let Some(sharing) = shared.find(|sharing| !agree(sharing)) else {
        return Ok(());
    };
    let [from, to] = sharing[0].ends.map(|vertex| mesh.vertices()[vertex]);
    let faces: Vec<String> = (sharing.iter().map(|edge| mesh.face_name(edge.face))).collect();
    Err(ObjFault::in_file(format!(
        "the edge from {from} to {to} belongs to {}, and a closed boundary has two faces at each, which run along it in \
         opposite directions: fill the hole, merge vertices by distance, or reverse the corners of a face, for instance \
         in Blender or MeshLab",
        faces.join(", ")
    )))
}

/// Signed volume, by tetrahedra from one vertex: a far origin would cost their digits.
fn volume(mesh: &Mesh) -> f64 {
    let apex = mesh.vertices()[mesh.faces()[0][0]];
    let tetrahedra = mesh.faces().iter().map(|face| {
        let [a, b, c] = face.map(|vertex| mesh.vertices()[vertex] - apex);
        a.dot(b.cross(c)) / 6.0
    });
    tetrahedra.collect::<Sum>().value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::crossing::TriangleCrossing;
    use glam::DVec3;
    use std::path::Path;

    fn mesh(name: &str) -> Mesh {
        Mesh::load(&Path::new("fixtures/meshes").join(name)).unwrap()
    }

    /// A sequence without pattern: the golden ratio's multiples, in [−1, 1).
    fn spread(index: usize) -> f64 {
        2.0 * (index as f64 * 0.618_033_988_749_894_9).fract() - 1.0
    }

    /// Crossings in and out, one way of many, must cancel to the last.
    fn check_parity(mesh: &Mesh, ray: &Ray) {
        let mut crossings: Vec<TriangleCrossing> = Vec::new();
        mesh.crossings(ray, f64::NEG_INFINITY, &mut crossings);
        let out = crossings.iter().filter(|c| c.side == Side::Back).count();
        assert_eq!(2 * out, crossings.len(), "{ray:?}");
    }

    #[test]
    fn every_line_leaves_a_closed_mesh_as_often_as_it_enters() {
        for name in ["gem.obj", "knot.obj"] {
            let mesh = mesh(name);
            let (centre, size) = (mesh.bounds().centre(), mesh.bounds().size().length());
            for index in 0..50_000 {
                let somewhere = |k: usize| {
                    let at = |j| spread(9 * index + 3 * k + j);
                    centre + DVec3::new(at(0), at(1), at(2)) * size
                };
                let face = mesh.faces()[index % mesh.faces().len()];
                let [a, b, _] = face.map(|vertex| mesh.vertices()[vertex]);
                // At nothing special; at a vertex, an edge, along an edge; along the axes.
                let (origin, target) = match index % 6 {
                    0 => (somewhere(0), somewhere(1)),
                    1 => (somewhere(0), a),
                    2 => (somewhere(0), a + (b - a) * (0.5 + 0.5 * spread(index))),
                    3 => (a, b),
                    4 => (a - DVec3::AXES[index / 6 % 3] * size, a),
                    _ => (a, a - DVec3::AXES[index / 6 % 3]),
                };
                if let Some(ray) = Ray::new(origin, target - origin) {
                    check_parity(&mesh, &ray);
                }
            }
        }
    }
}

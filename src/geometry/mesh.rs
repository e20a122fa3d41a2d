//! Triangle meshes, open or closed.

use super::bvh::Bvh;
use super::crossing::{RayFrame, TriangleCrossing};
use super::hit::RELATIVE_CLEARANCE;
use super::{
    Aabb, Crossing, Direction, Emitter, EmitterExtent, Hit, ObjFault, Ray, Surface, SurfacePoint,
    Transform, length_of,
};
use crate::math::Sum;
use glam::DVec3;

/// A triangle mesh, open or closed, with corners anticlockwise seen from the front. Media are
/// bounded by a [`ClosedMesh`](super::ClosedMesh).
#[derive(Clone, Debug)]
pub struct Mesh {
    vertices: Vec<DVec3>,
    faces: Vec<[usize; 3]>,
    /// Line of each face in its file, from 1; none without a file.
    lines: Vec<usize>,
    normals: Vec<Direction>,
    /// Area of all faces up to and including each.
    areas: Vec<f64>,
    bounds: Aabb,
    bvh: Bvh,
}

impl Mesh {
    /// The mesh of these faces, each three indices into `vertices`, from 0.
    pub fn new(vertices: Vec<DVec3>, faces: Vec<[usize; 3]>) -> Result<Mesh, ObjFault> {
        Mesh::of_lines(vertices, faces, Vec::new())
    }

    /// [`new`](Mesh::new) of a file; `lines` are those where the faces begin.
    pub(super) fn of_lines(
        vertices: Vec<DVec3>,
        faces: Vec<[usize; 3]>,
        lines: Vec<usize>,
    ) -> Result<Mesh, ObjFault> {
        let mut normals = Vec::with_capacity(faces.len());
        let mut areas = Vec::with_capacity(faces.len());
        let mut boxes = Vec::with_capacity(faces.len());
        let mut area = Sum::default();
        for (index, face) in faces.iter().enumerate() {
            let vertex = |at: usize| vertices.get(at).copied().filter(|it| it.is_finite());
            let name = || face_name(&lines, index);
            let [Some(a), Some(b), Some(c)] = face.map(vertex) else {
                let message = format!("{} has no finite vertex at a corner", name());
                return Err(ObjFault::in_file(message));
            };
            normals.push(perpendicular(b - a, c - a).ok_or_else(|| {
                let face = name();
                ObjFault::in_file(format!(
                    "{face} has no area: its corners {a}, {b} and {c} lie on a line; remove it"
                ))
            })?);
            area.add(0.5 * (b - a).cross(c - a).length());
            areas.push(area.value());
            boxes.extend(Aabb::around([a, b, c]));
        }
        let bounds = boxes
            .iter()
            .copied()
            .reduce(Aabb::union)
            .ok_or_else(ObjFault::no_faces)?;
        let area = area.value();
        if !(area > 0.0 && area.is_finite()) {
            return Err(ObjFault::in_file(format!(
                "the mesh's area is {area}: its size leaves the range of numbers; choose other units"
            )));
        }
        Ok(Mesh {
            bvh: Bvh::new(&boxes),
            vertices,
            faces,
            lines,
            normals,
            areas,
            bounds,
        })
    }

    /// The surface of a box, as twelve triangles that face outwards. A flat box is refused, since
    /// it has triangles without area.
    pub fn cuboid(bounds: &Aabb) -> Result<Mesh, ObjFault> {
        let sides = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let faces = sides
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        Mesh::new(bounds.corners().to_vec(), faces.collect())
    }

    /// Positions, in world units.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Indices of each face's corners.
    pub fn faces(&self) -> &[[usize; 3]] {
        &self.faces
    }

    /// The mesh with every vertex transformed. Mirroring preserves the front.
    pub fn transformed(&self, transform: &Transform) -> Result<Mesh, ObjFault> {
        let vertices = self.vertices.iter().map(|&v| transform.point(v)).collect();
        let mut faces = self.faces.clone();
        if transform.mirrors() {
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        Mesh::of_lines(vertices, faces, self.lines.clone())
    }

    /// Name of the face with this index, for messages.
    pub(super) fn face_name(&self, index: usize) -> String {
        face_name(&self.lines, index)
    }

    /// All crossings at `t ≥ from` of the whole line, and maybe others, in no particular order.
    pub(super) fn crossings(&self, ray: &Ray, from: f64, crossings: &mut Vec<TriangleCrossing>) {
        let frame = RayFrame::new(ray);
        self.bvh.walk(ray, from, f64::INFINITY, |face, limit| {
            crossings.extend(frame.crossing(self.corners(face)));
            limit
        });
    }

    fn corners(&self, face: usize) -> [DVec3; 3] {
        self.faces[face].map(|vertex| self.vertices[vertex])
    }

    /// The crossing's error, 104u of the reach, stays below a quarter of this (see
    /// [`super::hit`]); so does that of a point by weights: three products and sums.
    fn point(&self, face: usize, [at_b, at_c]: [f64; 2]) -> SurfacePoint {
        let [a, b, c] = self.corners(face);
        SurfacePoint {
            position: a + (b - a) * at_b + (c - a) * at_c,
            normal: self.normals[face],
            clearance: RELATIVE_CLEARANCE * self.bounds.reach(),
        }
    }

    /// A crossing at `t > 0` that is nearer than `best`, or as near with a smaller number.
    fn nearer(
        &self,
        frame: &RayFrame,
        face: usize,
        best: Option<(usize, TriangleCrossing)>,
        limit: f64,
    ) -> Option<(usize, TriangleCrossing)> {
        let crossing = frame.crossing(self.corners(face))?;
        let wins = match best {
            None => crossing.t < limit,
            Some((number, best)) => crossing.t < best.t || (crossing.t == best.t && face < number),
        };
        (crossing.t > 0.0 && wins).then_some((face, crossing))
    }
}

impl Surface for Mesh {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn bounding_sphere(&self) -> (DVec3, f64) {
        let centre = self.bounds.centre();
        let distances = self.vertices.iter().map(|&it| length_of(it - centre));
        (centre, distances.fold(0.0, f64::max))
    }

    fn crossing(&self, ray: &Ray, limit: f64) -> Option<Crossing> {
        let mut frame = None;
        let mut best = None;
        self.bvh.walk(ray, 0.0, limit, |face, nearest| {
            let frame = frame.get_or_insert_with(|| RayFrame::new(ray));
            best = self.nearer(frame, face, best, limit).or(best);
            best.map_or(nearest, |(_, crossing)| crossing.t)
        });
        best.map(|(face, crossing)| {
            let [_, at_b, at_c] = crossing.weights;
            Crossing::new(crossing.t, crossing.side, face, [at_b, at_c])
        })
    }

    fn hit_at(&self, _: &Ray, crossing: &Crossing) -> Hit {
        Hit::new(crossing, self.point(crossing.face, crossing.uv))
    }

    fn blocks(&self, ray: &Ray, limit: f64) -> bool {
        let mut frame = None;
        let mut blocked = false;
        self.bvh.walk(ray, 0.0, limit, |face, nearest| {
            let frame = frame.get_or_insert_with(|| RayFrame::new(ray));
            blocked |= self.nearer(frame, face, None, limit).is_some();
            if blocked { f64::NEG_INFINITY } else { nearest }
        });
        blocked
    }
}

impl Emitter for Mesh {
    fn area(&self) -> f64 {
        self.areas[self.areas.len() - 1]
    }

    /// Centroids of the faces by area; the mean square over a triangle with the corners a, b, c is
    /// `(a² + b² + c² + (a + b + c)²)/12`.
    fn extent(&self) -> EmitterExtent {
        let mean = |of: &dyn Fn([DVec3; 3]) -> DVec3| {
            let mut before = 0.0;
            let mut sum = DVec3::ZERO;
            for (face, &area) in self.areas.iter().enumerate() {
                sum += of(self.corners(face)) * ((area - before) / self.area());
                before = area;
            }
            sum
        };
        let centre = mean(&|[a, b, c]| (a + b + c) / 3.0);
        let spread = mean(&|corners| {
            let [a, b, c] = corners.map(|corner| corner - centre);
            let sum = a + b + c;
            (a * a + b * b + c * c + sum * sum) / 12.0
        });
        EmitterExtent {
            centre,
            spread: spread.element_sum(),
            normal: None,
        }
    }

    /// The first number chooses the face by area; its remainder and the second number choose the
    /// point, weights `1 − √a`, `√a·(1 − b)`, `√a·b`.
    fn sample(&self, [u, v]: [f64; 2]) -> SurfacePoint {
        let target = u * self.area();
        let face = self
            .areas
            .partition_point(|&area| area <= target)
            .min(self.faces.len() - 1);
        let before = if face == 0 { 0.0 } else { self.areas[face - 1] };
        let left = ((target - before) / (self.areas[face] - before)).clamp(0.0, 1.0);
        let root = left.sqrt();
        self.point(face, [root * (1.0 - v), root * v])
    }
}

/// Name of a face for messages: the line of the file where it begins, or its number.
fn face_name(lines: &[usize], index: usize) -> String {
    match lines.get(index) {
        Some(line) => format!("the face in line {line}"),
        None => format!("face {}", index + 1),
    }
}

/// The direction perpendicular to two others, or `None` where they are parallel up to
/// rounding.
pub(super) fn perpendicular(first: DVec3, second: DVec3) -> Option<Direction> {
    let across = Direction::of(first)?.cross(*Direction::of(second)?);
    // Each component is a difference of products of numbers off by 4u: an error of at most 10u,
    // so below 16·√3·u the direction of the product is noise.
    if across.length() <= 16.0 * f64::EPSILON {
        return None;
    }
    Direction::of(across)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertices() -> Vec<DVec3> {
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X * 2.0]
    }

    #[test]
    fn what_is_no_mesh_is_refused_by_name() {
        let refused =
            |faces: Vec<[usize; 3]>| Mesh::new(vertices(), faces).unwrap_err().to_string();
        assert!(refused(vec![]).contains("no faces"));
        assert!(refused(vec![[0, 1, 2], [0, 1, 4]]).contains("face 2 has no finite vertex"));
        let line = refused(vec![[0, 1, 3]]);
        assert!(
            line.contains("face 1") && line.contains("[2, 0, 0]"),
            "{line}"
        );
        assert!(refused(vec![[1, 1, 2]]).contains("no area"));
        let mut bad = vertices();
        bad[2].z = f64::NAN;
        let error = Mesh::new(bad, vec![[0, 1, 2]]).unwrap_err().to_string();
        assert!(error.starts_with("face 1 has no finite vertex"), "{error}");
    }

    #[test]
    fn a_triangle_is_hit_from_both_sides() {
        let mesh = Mesh::new(vertices(), vec![[0, 1, 2]]).unwrap();
        let hit = |z: f64| {
            let ray = Ray::new(DVec3::new(0.25, 0.5, z), DVec3::Z * -z).unwrap();
            mesh.hit(&ray, f64::INFINITY).unwrap()
        };
        let (above, below) = (hit(2.0), hit(-3.0));
        assert_eq!((above.t, above.side), (2.0, super::super::Side::Front));
        assert_eq!((below.t, below.side), (3.0, super::super::Side::Back));
        assert_eq!(above.point.normal, Direction::Z);
        assert_eq!(above.point.position, DVec3::new(0.25, 0.5, 0.0));
        assert_eq!(mesh.area(), 0.5);
    }
}

//! Shapes in world coordinates.

use crate::geometry::{Aabb, Boundary, Emitter, Luminous, Mesh, Rectangle, Shape, Sphere};
use crate::geometry::{Surface, Transform};
use glam::DVec3;

/// A shape in an exported scene. Equal ones are the same points of space.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Form {
    /// A ball.
    Sphere { centre: DVec3, radius: f64 },
    /// A ball that `to_world` stretches.
    Ellipsoid { sphere: Sphere, to_world: Transform },
    /// A box with a corner and the three edges that start there; their triple product is
    /// positive.
    Box { corner: DVec3, edges: [DVec3; 3] },
    /// A flat piece; its front is where `edges[0] × edges[1]` points.
    Rectangle { corner: DVec3, edges: [DVec3; 2] },
    /// Triangles, each three numbers of vertices, anticlockwise seen from the front.
    Mesh {
        vertices: Vec<DVec3>,
        faces: Vec<[usize; 3]>,
    },
}

/// A shape before a transform maps it to the world.
#[derive(Clone, Copy)]
pub(super) enum Base<'s> {
    Sphere(&'s Sphere),
    Box(&'s Aabb),
    Rectangle(&'s Rectangle),
    Mesh(&'s Mesh),
}

/// A shape of a scene, and the transform that places it, if there is one.
pub(super) type Placing<'s> = (Base<'s>, Option<&'s Transform>);

/// A surface that reflects or refracts.
pub(super) fn shape(shape: &Shape) -> Placing<'_> {
    match shape {
        Shape::Sphere(sphere) => (Base::Sphere(sphere), None),
        Shape::Box(cuboid) => (Base::Box(cuboid), None),
        Shape::Rectangle(rectangle) => (Base::Rectangle(rectangle), None),
        Shape::Mesh(mesh) => (Base::Mesh(mesh), None),
        Shape::PlacedSphere(it) => (Base::Sphere(it.shape()), Some(it.to_world())),
        Shape::PlacedBox(it) => (Base::Box(it.shape()), Some(it.to_world())),
        Shape::PlacedMesh(it) => (Base::Mesh(it.shape()), Some(it.to_world())),
    }
}

/// A surface that emits light.
pub(super) fn luminous(shape: &Luminous) -> Placing<'_> {
    let base = match shape {
        Luminous::Sphere(sphere) => Base::Sphere(sphere),
        Luminous::Rectangle(rectangle) => Base::Rectangle(rectangle),
        Luminous::Mesh(mesh) => Base::Mesh(mesh),
    };
    (base, None)
}

/// The boundary of a medium.
pub(super) fn boundary(boundary: &Boundary) -> Placing<'_> {
    match boundary {
        Boundary::Sphere(sphere) => (Base::Sphere(sphere), None),
        Boundary::Box(cuboid) => (Base::Box(cuboid), None),
        Boundary::Mesh(mesh) => (Base::Mesh(mesh.mesh()), None),
        Boundary::PlacedSphere(it) => (Base::Sphere(it.shape()), Some(it.to_world())),
        Boundary::PlacedBox(it) => (Base::Box(it.shape()), Some(it.to_world())),
        Boundary::PlacedMesh(it) => (Base::Mesh(it.shape().mesh()), Some(it.to_world())),
    }
}

impl Form {
    /// The shape in world coordinates.
    pub(super) fn of((base, to_world): Placing<'_>) -> Form {
        match (base, to_world) {
            (Base::Sphere(sphere), None) => Form::Sphere {
                centre: sphere.centre(),
                radius: sphere.radius(),
            },
            (Base::Sphere(sphere), Some(to_world)) => match even_scale(to_world) {
                Some(factor) => Form::Sphere {
                    centre: to_world.point(sphere.centre()),
                    radius: sphere.radius() * factor,
                },
                None => Form::Ellipsoid {
                    sphere: *sphere,
                    to_world: *to_world,
                },
            },
            (Base::Box(cuboid), to_world) => {
                Form::cuboid(cuboid, to_world.unwrap_or(&Transform::IDENTITY))
            }
            (Base::Rectangle(rectangle), _) => {
                let at = |u, v| rectangle.sample([u, v]).position;
                let corner = at(0.0, 0.0);
                let edges = [at(1.0, 0.0) - corner, at(0.0, 1.0) - corner];
                Form::Rectangle { corner, edges }
            }
            (Base::Mesh(mesh), to_world) => Form::mesh(mesh, to_world),
        }
    }

    /// A box placed in the world; a flat one is a rectangle.
    pub(super) fn cuboid(cuboid: &Aabb, to_world: &Transform) -> Form {
        let corner = to_world.point(cuboid.min);
        let size = cuboid.size();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut edges = axes.map(|axis| to_world.vector(axis * size));
        if let Some(flat) = (0..3).find(|&axis| size[axis] == 0.0) {
            let edges = [edges[(flat + 1) % 3], edges[(flat + 2) % 3]];
            return Form::Rectangle { corner, edges };
        }
        // A mirrored box is a box, its edges counted the other way round.
        if to_world.mirrors() {
            edges.swap(0, 1);
        }
        Form::Box { corner, edges }
    }

    fn mesh(mesh: &Mesh, to_world: Option<&Transform>) -> Form {
        let mut faces = mesh.faces().to_vec();
        // Mirrored, the front of a face stays in front.
        if to_world.is_some_and(Transform::mirrors) {
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        let place = |&vertex: &DVec3| to_world.map_or(vertex, |to_world| to_world.point(vertex));
        let vertices = mesh.vertices().iter().map(place).collect();
        Form::Mesh { vertices, faces }
    }

    /// Its corners: those of a box or rectangle, all vertices of a mesh; of a ball, those of a
    /// box around it.
    pub(super) fn corners(&self) -> Vec<DVec3> {
        match self {
            Form::Sphere { centre, radius } => {
                let cube = Aabb {
                    min: centre - *radius,
                    max: centre + *radius,
                };
                Form::cuboid(&cube, &Transform::IDENTITY).corners()
            }
            Form::Ellipsoid { sphere, to_world } => {
                Form::cuboid(&sphere.bounds(), to_world).corners()
            }
            Form::Box { corner, edges } => (0..8)
                .map(|which| {
                    let pick = |axis: usize| edges[axis] * f64::from(which >> axis & 1);
                    corner + pick(0) + pick(1) + pick(2)
                })
                .collect(),
            Form::Rectangle { .. } => self.faces().swap_remove(0),
            Form::Mesh { vertices, .. } => vertices.clone(),
        }
    }

    /// Its flat faces, anticlockwise seen from the front; none of a ball. Faces of a box go by axis, the one at the
    /// corner first.
    pub(super) fn faces(&self) -> Vec<Vec<DVec3>> {
        match self {
            Form::Sphere { .. } | Form::Ellipsoid { .. } => Vec::new(),
            Form::Rectangle { corner, edges } => {
                let [u, v] = *edges;
                vec![vec![*corner, corner + u, corner + u + v, corner + v]]
            }
            Form::Box { corner, edges } => {
                let face = |axis: usize, far: bool| {
                    let (u, v) = (edges[(axis + 1) % 3], edges[(axis + 2) % 3]);
                    let (u, v, corner) = if far {
                        (u, v, corner + edges[axis])
                    } else {
                        (v, u, *corner)
                    };
                    vec![corner, corner + u, corner + u + v, corner + v]
                };
                (0..3)
                    .flat_map(|axis| [face(axis, false), face(axis, true)])
                    .collect()
            }
            Form::Mesh { vertices, faces } => {
                let corners = |face: &[usize; 3]| face.map(|vertex| vertices[vertex]).to_vec();
                faces.iter().map(corners).collect()
            }
        }
    }

    /// The largest coordinate, in magnitude.
    pub(super) fn reach(&self) -> f64 {
        let corners = self.corners();
        let coordinates = corners.iter().map(|corner| corner.abs().max_element());
        coordinates.fold(0.0, f64::max)
    }
}

/// The factor of a map that keeps all angles; `None` if it stretches some directions more.
fn even_scale(to_world: &Transform) -> Option<f64> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| to_world.vector(axis));
    let lengths = axes.map(DVec3::length);
    // The columns of a turn are off by a dozen roundings at most, and their lengths with them.
    let even = |length: f64| (length - lengths[0]).abs() <= 32.0 * f64::EPSILON * lengths[0];
    lengths.into_iter().all(even).then_some(lengths[0])
}

/// The normal of a flat piece with these corners, length 1.
pub(super) fn normal_of(face: &[DVec3]) -> DVec3 {
    let last = face[face.len() - 1];
    (face[1] - face[0]).cross(last - face[0]).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Aabb {
        Aabb::new(DVec3::ZERO, DVec3::ONE).unwrap()
    }

    #[test]
    fn faces_of_a_box_look_outward_however_it_is_placed() {
        let turn = Transform::rotation(DVec3::new(1.0, 2.0, 3.0), 40.0).unwrap();
        for factors in [DVec3::ONE, DVec3::new(-2.0, 1.0, 0.5), DVec3::NEG_ONE] {
            let to_world = Transform::scale(factors).unwrap().then(&turn);
            let form = Form::cuboid(&unit(), &to_world);
            let Form::Box { edges, .. } = &form else {
                panic!("{form:?}")
            };
            assert!(edges[0].cross(edges[1]).dot(edges[2]) > 0.0);
            let centre = to_world.point(DVec3::splat(0.5));
            for face in form.faces() {
                assert!(normal_of(&face).dot(face[0] - centre) > 0.0);
            }
            let volume = edges[0].cross(edges[1]).dot(edges[2]);
            let expected = (factors.x * factors.y * factors.z).abs();
            assert!((volume - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn a_turned_ball_is_a_ball_and_a_stretched_one_is_not() {
        let ball = Sphere::new(DVec3::X, 2.0).unwrap();
        let turn = Transform::rotation(DVec3::ONE, 77.0).unwrap();
        let mirrored = Transform::scale(DVec3::new(-3.0, 3.0, 3.0)).unwrap();
        let Form::Sphere { radius, .. } =
            Form::of((Base::Sphere(&ball), Some(&mirrored.then(&turn))))
        else {
            panic!("no sphere")
        };
        assert!((radius - 6.0).abs() < 1e-14);
        let stretched = Transform::scale(DVec3::new(1.0, 1.0, 1.0 + 1e-12)).unwrap();
        let form = Form::of((Base::Sphere(&ball), Some(&stretched)));
        assert!(matches!(form, Form::Ellipsoid { .. }));
    }

    #[test]
    fn a_flat_box_is_a_rectangle() {
        let flat = Aabb::new(DVec3::ZERO, DVec3::new(1.0, 0.0, 2.0)).unwrap();
        let form = Form::cuboid(&flat, &Transform::IDENTITY);
        let Form::Rectangle { edges, .. } = form else {
            panic!("{form:?}")
        };
        assert_eq!(edges, [DVec3::Z * 2.0, DVec3::X]);
    }
}

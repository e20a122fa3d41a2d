//! Enums over the shapes of a scene.

use super::forward::forward;
use super::{
    Aabb, ClosedMesh, Crossing, Emitter, EmitterExtent, EmitterPdf, Hit, Mesh, Placed, Ray,
    Rectangle, Solid, Span, Sphere, Surface, SurfacePoint, Transform,
};
use glam::DVec3;
use std::sync::Arc;

/// Any surface. A mesh is shared by all its instances; a shape without a transform keeps its exact
/// coordinates, so that faces given at the same place coincide to the bit.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// A box along the axes.
    Box(Aabb),
    /// A rectangle or parallelogram.
    Rectangle(Rectangle),
    /// A mesh, open or closed.
    Mesh(Arc<Mesh>),
    /// A sphere moved, turned or stretched.
    PlacedSphere(Placed<Sphere>),
    /// A box moved, turned or stretched.
    PlacedBox(Placed<Aabb>),
    /// A mesh moved, turned or stretched.
    PlacedMesh(Placed<Arc<Mesh>>),
}

/// Any closed shape: the boundary of a medium.
#[derive(Clone, Debug)]
pub enum Boundary {
    /// A sphere.
    Sphere(Sphere),
    /// A box along the axes.
    Box(Aabb),
    /// A closed mesh.
    Mesh(ClosedMesh),
    /// A sphere moved, turned or stretched.
    PlacedSphere(Placed<Sphere>),
    /// A box moved, turned or stretched.
    PlacedBox(Placed<Aabb>),
    /// A closed mesh moved, turned or stretched.
    PlacedMesh(Placed<ClosedMesh>),
}

/// A shape that can emit light: one whose points can be chosen uniformly by area.
#[derive(Clone, Debug)]
pub enum Luminous {
    /// A sphere.
    Sphere(Sphere),
    /// A rectangle or parallelogram.
    Rectangle(Rectangle),
    /// A mesh.
    Mesh(Arc<Mesh>),
}

impl Surface for Shape {
    forward! { (Shape: Sphere | Box | Rectangle | Mesh | PlacedSphere | PlacedBox | PlacedMesh)
        fn bounds() -> Aabb;
        fn bounding_sphere() -> (DVec3, f64);
        fn hull() -> Vec<DVec3>;
        fn slack() -> f64;
        fn crossing(ray: &Ray, limit: f64) -> Option<Crossing>;
        fn hit_at(ray: &Ray, crossing: &Crossing) -> Hit;
        fn blocks(ray: &Ray, limit: f64) -> bool;
    }
}

impl Surface for Boundary {
    forward! { (Boundary: Sphere | Box | Mesh | PlacedSphere | PlacedBox | PlacedMesh)
        fn bounds() -> Aabb;
        fn slack() -> f64;
        fn crossing(ray: &Ray, limit: f64) -> Option<Crossing>;
        fn hit_at(ray: &Ray, crossing: &Crossing) -> Hit;
        fn blocks(ray: &Ray, limit: f64) -> bool;
    }
}

impl Solid for Boundary {
    forward! { (Boundary: Sphere | Box | Mesh | PlacedSphere | PlacedBox | PlacedMesh)
        fn append_spans(ray: &Ray, spans: &mut Vec<Span>);
    }
}

impl Boundary {
    /// The shape where `by` takes it.
    pub fn moved(self, by: &Transform) -> Boundary {
        match self {
            Boundary::Sphere(sphere) => Boundary::PlacedSphere(Placed::new(sphere, *by)),
            Boundary::Box(bounds) => Boundary::PlacedBox(Placed::new(bounds, *by)),
            Boundary::Mesh(mesh) => Boundary::PlacedMesh(Placed::new(mesh, *by)),
            Boundary::PlacedSphere(sphere) => Boundary::PlacedSphere(sphere.moved(by)),
            Boundary::PlacedBox(bounds) => Boundary::PlacedBox(bounds.moved(by)),
            Boundary::PlacedMesh(mesh) => Boundary::PlacedMesh(mesh.moved(by)),
        }
    }
}

impl Surface for Luminous {
    forward! { (Luminous: Sphere | Rectangle | Mesh)
        fn bounds() -> Aabb;
        fn hull() -> Vec<DVec3>;
        fn crossing(ray: &Ray, limit: f64) -> Option<Crossing>;
        fn hit_at(ray: &Ray, crossing: &Crossing) -> Hit;
        fn blocks(ray: &Ray, limit: f64) -> bool;
    }
}

impl Emitter for Luminous {
    forward! { (Luminous: Sphere | Rectangle | Mesh)
        fn area() -> f64;
        fn sample(uv: [f64; 2]) -> SurfacePoint;
        fn sample_towards(to: DVec3, uv: [f64; 2]) -> (SurfacePoint, EmitterPdf);
        fn pdf_towards(to: DVec3) -> EmitterPdf;
        fn extent() -> EmitterExtent;
    }
}

impl<S: Surface> Surface for Arc<S> {
    forward! { (*)
        fn bounds() -> Aabb;
        fn bounding_sphere() -> (DVec3, f64);
        fn crossing(ray: &Ray, limit: f64) -> Option<Crossing>;
        fn hit_at(ray: &Ray, crossing: &Crossing) -> Hit;
        fn blocks(ray: &Ray, limit: f64) -> bool;
    }
}

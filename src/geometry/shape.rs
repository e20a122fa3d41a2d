//! Enums over the shapes of a scene.

use super::{
    Aabb, ClosedMesh, Convex, Crossing, Emitter, EmitterExtent, EmitterPdf, Hit, Mesh, Placed, Ray,
    Rectangle, Solid, Span, Sphere, Surface, SurfacePoint,
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
    Mesh(Arc<ClosedMesh>),
    /// A sphere moved, turned or stretched.
    PlacedSphere(Placed<Sphere>),
    /// A box moved, turned or stretched.
    PlacedBox(Placed<Aabb>),
    /// A closed mesh moved, turned or stretched.
    PlacedMesh(Placed<Arc<ClosedMesh>>),
}

/// A closed shape that is convex by its kind.
#[derive(Clone, Copy, Debug)]
pub enum ConvexBoundary<'s> {
    /// A sphere.
    Sphere(&'s Sphere),
    /// A box along the axes.
    Box(&'s Aabb),
    /// A sphere moved, turned or stretched.
    PlacedSphere(&'s Placed<Sphere>),
    /// A box moved, turned or stretched.
    PlacedBox(&'s Placed<Aabb>),
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

/// Calls the same method on every variant.
macro_rules! each {
    ($self:expr, $kind:ident: $($variant:ident)|+, $shape:ident => $call:expr) => {
        match $self { $($kind::$variant($shape) => $call,)+ }
    };
}

impl Surface for Shape {
    fn bounds(&self) -> Aabb {
        each!(self, Shape: Sphere | Box | Rectangle | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.bounds())
    }

    fn bounding_sphere(&self) -> (DVec3, f64) {
        each!(self, Shape: Sphere | Box | Rectangle | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.bounding_sphere())
    }

    fn hull(&self) -> Vec<DVec3> {
        each!(self, Shape: Sphere | Box | Rectangle | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.hull())
    }

    fn slack(&self) -> f64 {
        each!(self, Shape: Sphere | Box | Rectangle | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.slack())
    }

    fn crossing(&self, ray: &Ray, limit: f64) -> Option<Crossing> {
        each!(self, Shape: Sphere | Box | Rectangle | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.crossing(ray, limit))
    }

    fn hit_at(&self, ray: &Ray, crossing: &Crossing) -> Hit {
        each!(self, Shape: Sphere | Box | Rectangle | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.hit_at(ray, crossing))
    }

    fn blocks(&self, ray: &Ray, limit: f64) -> bool {
        each!(self, Shape: Sphere | Box | Rectangle | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.blocks(ray, limit))
    }
}

impl Surface for Boundary {
    fn bounds(&self) -> Aabb {
        each!(self, Boundary: Sphere | Box | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.bounds())
    }

    fn slack(&self) -> f64 {
        each!(self, Boundary: Sphere | Box | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.slack())
    }

    fn crossing(&self, ray: &Ray, limit: f64) -> Option<Crossing> {
        each!(self, Boundary: Sphere | Box | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.crossing(ray, limit))
    }

    fn hit_at(&self, ray: &Ray, crossing: &Crossing) -> Hit {
        each!(self, Boundary: Sphere | Box | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.hit_at(ray, crossing))
    }

    fn blocks(&self, ray: &Ray, limit: f64) -> bool {
        each!(self, Boundary: Sphere | Box | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.blocks(ray, limit))
    }
}

impl Solid for Boundary {
    fn append_spans(&self, ray: &Ray, spans: &mut Vec<Span>) {
        each!(self, Boundary: Sphere | Box | Mesh | PlacedSphere | PlacedBox | PlacedMesh,
            shape => shape.append_spans(ray, spans));
    }
}

impl Boundary {
    /// The shape, if it is convex by its kind; a mesh may be anything.
    pub fn convex(&self) -> Option<ConvexBoundary<'_>> {
        match self {
            Boundary::Sphere(sphere) => Some(ConvexBoundary::Sphere(sphere)),
            Boundary::Box(bounds) => Some(ConvexBoundary::Box(bounds)),
            Boundary::PlacedSphere(sphere) => Some(ConvexBoundary::PlacedSphere(sphere)),
            Boundary::PlacedBox(bounds) => Some(ConvexBoundary::PlacedBox(bounds)),
            Boundary::Mesh(_) | Boundary::PlacedMesh(_) => None,
        }
    }
}

impl ConvexBoundary<'_> {
    /// The segment of `ray` inside, as [`Convex::span`].
    pub fn span(&self, ray: &Ray) -> Option<Span> {
        each!(self, ConvexBoundary: Sphere | Box | PlacedSphere | PlacedBox,
            shape => Convex::span(*shape, ray))
    }
}

impl Surface for Luminous {
    fn bounds(&self) -> Aabb {
        each!(self, Luminous: Sphere | Rectangle | Mesh, shape => shape.bounds())
    }

    fn hull(&self) -> Vec<DVec3> {
        each!(self, Luminous: Sphere | Rectangle | Mesh, shape => shape.hull())
    }

    fn crossing(&self, ray: &Ray, limit: f64) -> Option<Crossing> {
        each!(self, Luminous: Sphere | Rectangle | Mesh, shape => shape.crossing(ray, limit))
    }

    fn hit_at(&self, ray: &Ray, crossing: &Crossing) -> Hit {
        each!(self, Luminous: Sphere | Rectangle | Mesh, shape => shape.hit_at(ray, crossing))
    }

    fn blocks(&self, ray: &Ray, limit: f64) -> bool {
        each!(self, Luminous: Sphere | Rectangle | Mesh,
            shape => shape.blocks(ray, limit))
    }
}

impl Emitter for Luminous {
    fn area(&self) -> f64 {
        each!(self, Luminous: Sphere | Rectangle | Mesh, shape => shape.area())
    }

    fn sample(&self, uv: [f64; 2]) -> SurfacePoint {
        each!(self, Luminous: Sphere | Rectangle | Mesh, shape => shape.sample(uv))
    }

    fn sample_towards(&self, to: DVec3, uv: [f64; 2]) -> (SurfacePoint, EmitterPdf) {
        each!(self, Luminous: Sphere | Rectangle | Mesh, shape => shape.sample_towards(to, uv))
    }

    fn pdf_towards(&self, to: DVec3) -> EmitterPdf {
        each!(self, Luminous: Sphere | Rectangle | Mesh, shape => shape.pdf_towards(to))
    }

    fn extent(&self) -> EmitterExtent {
        each!(self, Luminous: Sphere | Rectangle | Mesh, shape => shape.extent())
    }
}

impl<S: Surface> Surface for Arc<S> {
    fn bounds(&self) -> Aabb {
        (**self).bounds()
    }

    fn bounding_sphere(&self) -> (DVec3, f64) {
        (**self).bounding_sphere()
    }

    fn crossing(&self, ray: &Ray, limit: f64) -> Option<Crossing> {
        (**self).crossing(ray, limit)
    }

    fn hit_at(&self, ray: &Ray, crossing: &Crossing) -> Hit {
        (**self).hit_at(ray, crossing)
    }

    fn blocks(&self, ray: &Ray, limit: f64) -> bool {
        (**self).blocks(ray, limit)
    }
}

impl<S: Solid> Solid for Arc<S> {
    fn append_spans(&self, ray: &Ray, spans: &mut Vec<Span>) {
        (**self).append_spans(ray, spans);
    }
}

impl<S: Emitter> Emitter for Arc<S> {
    fn area(&self) -> f64 {
        (**self).area()
    }

    fn sample(&self, uv: [f64; 2]) -> SurfacePoint {
        (**self).sample(uv)
    }

    fn sample_towards(&self, to: DVec3, uv: [f64; 2]) -> (SurfacePoint, EmitterPdf) {
        (**self).sample_towards(to, uv)
    }

    fn pdf_towards(&self, to: DVec3) -> EmitterPdf {
        (**self).pdf_towards(to)
    }

    fn extent(&self) -> EmitterExtent {
        (**self).extent()
    }
}

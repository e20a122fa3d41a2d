//! Surfaces that emit light: points sampled on them.

use super::{Direction, Surface, SurfacePoint};
use glam::DVec3;

/// A surface that can emit light: points sampled by area, or for light to one point.
pub trait Emitter: Surface {
    /// Area of one side, in world units squared.
    fn area(&self) -> f64;

    /// The point for two numbers in [0, 1). Uniform numbers give uniform points by area, with
    /// density [`pdf`](Emitter::pdf).
    fn sample(&self, uv: [f64; 2]) -> SurfacePoint;

    /// Density of [`sample`](Emitter::sample), per world unit squared; the same everywhere.
    fn pdf(&self) -> f64 {
        1.0 / self.area()
    }

    /// The point for two numbers in [0, 1) from which light goes to the world point `to`, with its
    /// density. Where the shape allows, uniform by solid angle.
    fn sample_towards(&self, to: DVec3, uv: [f64; 2]) -> (SurfacePoint, EmitterPdf) {
        (self.sample(uv), self.pdf_towards(to))
    }

    /// Density of [`sample_towards`](Emitter::sample_towards).
    #[expect(unused_variables, reason = "by area it is the same for all points")]
    fn pdf_towards(&self, to: DVec3) -> EmitterPdf {
        EmitterPdf::PerArea(self.pdf())
    }

    /// Centre and size.
    fn extent(&self) -> EmitterExtent;
}

/// A density that is the same for all points of an emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmitterPdf {
    /// Density per world unit squared.
    PerArea(f64),
    /// Density per steradian, seen from the point that is lit.
    PerSteradian(f64),
}

impl EmitterPdf {
    /// Density per steradian of a point at `distance`, whose normal has the cosine `cosine` to the
    /// line of sight.
    pub fn per_steradian(self, distance: f64, cosine: f64) -> f64 {
        match self {
            EmitterPdf::PerArea(pdf) => pdf * (distance * distance) / cosine.abs(),
            EmitterPdf::PerSteradian(pdf) => pdf,
        }
    }
}

/// Centre and size of an emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmitterExtent {
    /// Centroid of the surface, a world point.
    pub centre: DVec3,
    /// Mean over the surface of the squared distance from the centre, world units squared. So the
    /// mean squared distance of the surface from any point is this plus the squared distance of the
    /// centre.
    pub spread: f64,
    /// Normal of a flat surface.
    pub normal: Option<Direction>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Luminous, Mesh, Rectangle, Sphere};

    fn rectangle() -> Rectangle {
        let corner = DVec3::new(-1.0, 2.0, -0.5);
        Rectangle::new(corner, DVec3::X * 3.0, DVec3::Z * 2.0).unwrap()
    }

    /// By hand: a rectangle has a twelfth of its squared diagonal, a cube of edge 2 on each face the 1
    /// of its distance and a third for each edge, a sphere its squared radius.
    #[test]
    fn mean_squared_distances() {
        let flat = rectangle();
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let corners = corners.map(|uv| flat.sample(uv).position);
        let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        for extent in [flat.extent(), mesh.extent()] {
            assert!(extent.centre.distance(DVec3::new(0.5, 2.0, 0.5)) < 1e-15);
            assert!((extent.spread - 13.0 / 12.0).abs() < 1e-15);
        }
        let cube = Aabb {
            min: DVec3::splat(4.0),
            max: DVec3::splat(6.0),
        };
        let cube = Mesh::cuboid(&cube).unwrap().extent();
        assert!(cube.centre.distance(DVec3::splat(5.0)) < 1e-14);
        assert!((cube.spread - 5.0 / 3.0).abs() < 1e-14);
        let sphere = Sphere::new(DVec3::ONE, 3.0).unwrap();
        assert_eq!(sphere.extent().spread, 9.0);
    }

    /// Irradiance of unit radiance at points before, beside and close to emitters: by points sampled
    /// for there and by points sampled by area. The midpoints of 512² squares are off by less than the
    /// limit: close to the rectangle, at a twelfth of its edge, the integrand by area is smooth over 40
    /// of them.
    #[test]
    fn both_samplers_find_the_same_irradiance() {
        let n = 512;
        let emitters = [
            Luminous::Rectangle(rectangle()),
            Luminous::Sphere(Sphere::new(DVec3::new(0.0, 3.0, 0.0), 1.0).unwrap()),
        ];
        let places = [
            [0.0, 0.0, 0.0],
            [0.5, 1.75, 0.5],
            [3.5, 1.5, 1.0],
            [9.0, -20.0, 5.0],
        ];
        for (emitter, place) in emitters.iter().flat_map(|e| places.map(|place| (e, place))) {
            let place = DVec3::from_array(place);
            let irradiance = |sample: &dyn Fn([f64; 2]) -> (SurfacePoint, EmitterPdf)| {
                let mut sum = 0.0;
                for i in 0..n * n {
                    let uv = [i % n, i / n].map(|i| (f64::from(i) + 0.5) / f64::from(n));
                    let (point, pdf) = sample(uv);
                    let towards = point.position - place;
                    let direction = towards.normalize();
                    let cosine = direction.dot(*point.normal);
                    // The front of the rectangle, and of the sphere, is seen where this is negative.
                    if cosine < 0.0 {
                        let pdf = pdf.per_steradian(towards.length(), cosine);
                        sum += direction.y.max(0.0) / pdf;
                    }
                }
                sum / f64::from(n * n)
            };
            let towards = irradiance(&|uv| {
                let (point, pdf) = emitter.sample_towards(place, uv);
                assert_eq!(pdf, emitter.pdf_towards(place));
                (point, pdf)
            });
            let by_area =
                irradiance(&|uv| (emitter.sample(uv), EmitterPdf::PerArea(emitter.pdf())));
            assert!(
                (towards / by_area - 1.0).abs() < 1e-3,
                "{place}: {towards} and {by_area}"
            );
        }
    }
}

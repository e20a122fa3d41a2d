//! Edges of the shadows that media cast onto a ray.
//!
//! Towards a light the transmittance of other media is smooth between the points of a ray whose
//! connection passes an edge of a body. A rule of few points that straddled a narrow shadow would not
//! see it, so integrals along the line of sight are cut there.
//!
//! The geometry is in the plane through ray and light: it cuts a box in a polygon and a sphere in a
//! circle. The lines from the light through the corners of the one, and along the tangents of the
//! other, meet the ray at the edges.

use crate::geometry::{Aabb, Boundary, Direction, Placed, Ray, Sphere, Surface};
use glam::{DVec2, DVec3};

/// The direction or position of a light without extent.
#[derive(Clone, Copy, Debug)]
pub enum LightSource {
    /// World point.
    At(DVec3),
    /// Direction towards a light infinitely far away.
    Towards(Direction),
}

/// The plane through a ray and a light.
struct ShadowPlane {
    /// Origin of the ray, and of the coordinates in the plane.
    origin: DVec3,
    /// The ray, and the side of the light.
    axes: [Direction; 2],
    normal: Direction,
    source: PlaneSource,
}

/// The light in coordinates of the plane.
#[derive(Clone, Copy)]
enum PlaneSource {
    At(DVec2),
    Towards(DVec2),
}

/// Distances along `ray` at which the shadow of `boundary` in the light of `source` may begin, end or
/// have a kink, in no order. A mesh has those of the box around it.
pub fn shadow_edges(boundary: &Boundary, ray: &Ray, source: LightSource) -> Vec<f64> {
    let edges = match boundary {
        Boundary::Sphere(sphere) => of_sphere(sphere, ray, source),
        Boundary::Box(bounds) => of_box(bounds, ray, source),
        Boundary::Mesh(mesh) => of_box(&mesh.bounds(), ray, source),
        Boundary::PlacedSphere(placed) => placed_edges(placed, ray, source, of_sphere),
        Boundary::PlacedBox(placed) => placed_edges(placed, ray, source, of_box),
        Boundary::PlacedMesh(placed) => placed_edges(placed, ray, source, |mesh, ray, source| {
            of_box(&mesh.bounds(), ray, source)
        }),
    };
    edges.unwrap_or_default()
}

/// The edges of a placed shape, found in its own space: straight lines stay straight.
fn placed_edges<S: Surface>(
    placed: &Placed<S>,
    ray: &Ray,
    source: LightSource,
    edges: impl Fn(&S, &Ray, LightSource) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let to_object = placed.to_world().inverse();
    let (object_ray, scale) = placed.to_world().ray_to_object(ray)?;
    let source = match source {
        LightSource::At(position) => LightSource::At(to_object.point(position)),
        LightSource::Towards(direction) => {
            LightSource::Towards(Direction::of(to_object.vector(*direction))?)
        }
    };
    let edges = edges(placed.shape(), &object_ray, source)?;
    Some(edges.into_iter().map(|t| t / scale).collect())
}

fn of_box(bounds: &Aabb, ray: &Ray, source: LightSource) -> Option<Vec<f64>> {
    let plane = ShadowPlane::new(ray, source)?;
    let corners = bounds.corners();
    let edges = (0..8).flat_map(|from| {
        let ends = [1, 2, 4].map(|axis| from | axis);
        ends.into_iter()
            .filter(move |to| *to != from)
            .map(move |to| [from, to])
    });
    let crossings = edges.filter_map(|ends| plane.crossing(ends.map(|end| corners[end])));
    let shadows = crossings.filter_map(|point| plane.shadow(point));
    Some(shadows.collect())
}

fn of_sphere(sphere: &Sphere, ray: &Ray, source: LightSource) -> Option<Vec<f64>> {
    let plane = ShadowPlane::new(ray, source)?;
    let height = plane.normal.dot(sphere.centre() - plane.origin);
    let squared = (sphere.radius() - height) * (sphere.radius() + height);
    if squared <= 0.0 {
        return None;
    }
    let (centre, radius) = (plane.coordinates(sphere.centre()), squared.sqrt());
    // Where the two tangents touch the circle.
    let touching = match plane.source {
        PlaneSource::Towards(direction) => {
            [1.0, -1.0].map(|side| centre + side * radius * direction.perp())
        }
        PlaneSource::At(light) => {
            let towards = light - centre;
            let distance = towards.length();
            if distance <= radius {
                return None;
            }
            let towards = towards / distance;
            let along = radius * radius / distance;
            let aside = ((radius - along) * (radius + along)).max(0.0).sqrt();
            [1.0, -1.0].map(|side| centre + along * towards + side * aside * towards.perp())
        }
    };
    let shadows = touching.into_iter().filter_map(|point| plane.shadow(point));
    Some(shadows.collect())
}

impl ShadowPlane {
    /// `None` where the light lies on the line of the ray, whose connections all pass along it.
    fn new(ray: &Ray, source: LightSource) -> Option<ShadowPlane> {
        let along = ray.direction;
        let towards = match source {
            LightSource::At(position) => position - ray.origin,
            LightSource::Towards(direction) => *direction,
        };
        let aside = Direction::of(towards - along * towards.dot(*along))?;
        let local = DVec2::new(towards.dot(*along), towards.dot(*aside));
        Some(ShadowPlane {
            origin: ray.origin,
            axes: [along, aside],
            normal: Direction::unit(along.cross(*aside)),
            source: match source {
                LightSource::At(_) => PlaneSource::At(local),
                LightSource::Towards(_) => PlaneSource::Towards(local),
            },
        })
    }

    fn coordinates(&self, point: DVec3) -> DVec2 {
        let offset = point - self.origin;
        DVec2::new(offset.dot(*self.axes[0]), offset.dot(*self.axes[1]))
    }

    /// The point at which the line between two points crosses the plane.
    fn crossing(&self, [a, b]: [DVec3; 2]) -> Option<DVec2> {
        let [above, below] = [a, b].map(|point| self.normal.dot(point - self.origin));
        if (above > 0.0) == (below > 0.0) {
            return None;
        }
        Some(self.coordinates(a + (b - a) * (above / (above - below))))
    }

    /// Distance on the ray of the shadow of a point between ray and light.
    fn shadow(&self, point: DVec2) -> Option<f64> {
        let t = match self.source {
            PlaneSource::At(light) if 0.0 < point.y && point.y < light.y => {
                light.x + (point.x - light.x) * (light.y / (light.y - point.y))
            }
            PlaneSource::Towards(direction) if point.y > 0.0 => {
                point.x - point.y * (direction.x / direction.y)
            }
            _ => return None,
        };
        t.is_finite().then_some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Transform;

    fn ray() -> Ray {
        Ray::new(DVec3::ZERO, DVec3::X).unwrap()
    }

    fn sorted(mut edges: Vec<f64>) -> Vec<f64> {
        edges.sort_unstable_by(f64::total_cmp);
        edges.dedup();
        edges
    }

    /// A box half-way between ray and light throws a shadow of twice its width.
    #[test]
    fn a_box_before_a_point() {
        let bounds = Aabb::new(DVec3::new(4.0, 2.0, -1.0), DVec3::new(5.0, 2.0, 1.0)).unwrap();
        let light = LightSource::At(DVec3::new(4.5, 4.0, 0.0));
        let edges = sorted(shadow_edges(&Boundary::Box(bounds), &ray(), light));
        assert_eq!(edges, [3.5, 5.5]);
        // One behind the light, or behind the ray, throws none.
        for light in [1.0, -4.0] {
            let light = LightSource::At(DVec3::new(4.5, light, 0.0));
            assert!(shadow_edges(&Boundary::Box(bounds), &ray(), light).is_empty());
        }
        let beside = Ray::new(DVec3::Z * 3.0, DVec3::X).unwrap();
        let light = LightSource::At(DVec3::new(4.5, 4.0, 3.0));
        assert!(shadow_edges(&Boundary::Box(bounds), &beside, light).is_empty());
    }

    #[test]
    fn a_box_and_a_ball_before_a_far_light() {
        let bounds = Aabb::new(DVec3::new(4.0, 2.0, -1.0), DVec3::new(5.0, 3.0, 1.0)).unwrap();
        let light = LightSource::Towards(Direction::unit(DVec3::new(-0.6, 0.8, 0.0)));
        let edges = sorted(shadow_edges(&Boundary::Box(bounds), &ray(), light));
        for (found, expected) in edges.iter().zip([5.5, 6.25, 6.5, 7.25]) {
            assert!((found - expected).abs() < 1e-14, "{edges:?}");
        }
        // A ball of radius 1 is as wide as 2/sin on the ray.
        let ball = Sphere::new(DVec3::new(4.0, 2.0, 0.6), 1.0).unwrap();
        let edges = sorted(shadow_edges(&Boundary::Sphere(ball), &ray(), light));
        for (found, expected) in edges.iter().zip([4.5, 6.5]) {
            assert!((found - expected).abs() < 1e-14, "{edges:?}");
        }
    }

    /// Tangents of a circle from a point: seen from twice its radius, at 30° from its centre.
    #[test]
    fn a_ball_before_a_point() {
        let ball = Sphere::new(DVec3::new(2.0, 1.0, 0.0), 0.5).unwrap();
        let light = LightSource::At(DVec3::new(2.0, 2.0, 0.0));
        let edges = sorted(shadow_edges(&Boundary::Sphere(ball), &ray(), light));
        let half = 2.0 / 3.0_f64.sqrt();
        for (found, expected) in edges.iter().zip([2.0 - half, 2.0 + half]) {
            assert!((found - expected).abs() < 1e-14, "{edges:?}");
        }
        let placed = Placed::new(
            Sphere::new(DVec3::ZERO, 1.0).unwrap(),
            Transform::scale(DVec3::splat(0.5))
                .unwrap()
                .then(&Transform::translation(DVec3::new(2.0, 1.0, 0.0)).unwrap()),
        );
        let again = sorted(shadow_edges(&Boundary::PlacedSphere(placed), &ray(), light));
        for (found, expected) in again.iter().zip(&edges) {
            assert!((found - expected).abs() < 1e-14, "{again:?}");
        }
    }
}

//! Rectangles and parallelograms.

use super::crossing::RayFrame;
use super::hit::RELATIVE_CLEARANCE;
use super::mesh::perpendicular;
use super::spherical_rectangle::SphericalRectangle;
use super::{
    Aabb, Crossing, Direction, Emitter, EmitterExtent, EmitterPdf, Hit, InvalidParameter, Ray,
    Side, Surface, SurfacePoint, Transform, require_finite,
};
use glam::DVec3;

/// A rectangle spanned by two edges at a corner; a parallelogram if they are not perpendicular. Its
/// normal is along `edge_u × edge_v`. The material decides whether one or both sides interact with
/// light.
///
/// Two rectangles whose corners have the same bits have no gap between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    corner: DVec3,
    edge_u: DVec3,
    edge_v: DVec3,
    normal: Direction,
    /// Dual basis of the edges: the dot products with a vector are its coordinates along the two
    /// edges.
    duals: [DVec3; 2],
    /// Largest component of the duals, per world unit.
    steepest: f64,
    /// Sum of all components of the edges, without their signs.
    extent: f64,
    /// Lengths of the edges, if they are perpendicular.
    lengths: Option<[f64; 2]>,
    clearance: f64,
}

/// Distance of the centre, in diagonals, from which points are sampled by area. Before a point on the
/// normal at this distance their density per steradian varies by a factor of (1 + 1/4)^(3/2), 1.4, and
/// solid angles cost a tenth of all time in a room of fog. Tried were 0.7, 1 and 2: at 1, error squared times time
/// is within 1 % of the least in the rooms of the suite, at 2 it is 7 to 13 % larger.
const FAR: f64 = 1.0;

/// Cosine of two edges up to which they are perpendicular: eight roundings, of the product and of
/// edges that were rotated.
const PERPENDICULAR: f64 = 4.0 * f64::EPSILON;

impl Rectangle {
    /// The corner and the two edges that start there, world units.
    pub(crate) fn corner_and_edges(&self) -> [DVec3; 3] {
        [self.corner, self.edge_u, self.edge_v]
    }

    /// The rectangle with a corner and the two edges that start there, in world units.
    pub fn new(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> Result<Rectangle, InvalidParameter> {
        let opposite = corner + edge_u + edge_v;
        require_finite("corner", "the opposite corner of the rectangle", opposite)?;
        let no_area = || {
            let message = format!(
                "a rectangle with edges {edge_u} and {edge_v} has no area; give two edges that are not parallel"
            );
            InvalidParameter::new("edge_v", message)
        };
        let normal = perpendicular(edge_u, edge_v).ok_or_else(no_area)?;
        // Across the edges within the plane; the products are the area, up to its sign.
        let (across_u, across_v) = (edge_v.cross(*normal), normal.cross(edge_u));
        let duals = [
            across_u / across_u.dot(edge_u),
            across_v / across_v.dot(edge_v),
        ];
        let rectangle = Rectangle {
            corner,
            edge_u,
            edge_v,
            normal,
            duals,
            steepest: duals[0].abs().max(duals[1].abs()).max_element(),
            extent: (edge_u.abs() + edge_v.abs()).element_sum(),
            lengths: {
                let lengths = [edge_u.length(), edge_v.length()];
                let cosine = (edge_u / lengths[0]).dot(edge_v / lengths[1]);
                (cosine.abs() <= PERPENDICULAR).then_some(lengths)
            },
            clearance: 0.0,
        };
        // Also where the product leaves the range, or the edges vanish beside the corner.
        let [a, b, c, d] = rectangle.corners();
        let seen = perpendicular(b - a, d - a).and(perpendicular(b - c, d - c));
        let area = rectangle.area();
        if seen.is_none() || !(area > 0.0 && area.is_finite()) {
            return Err(no_area());
        }
        Ok(Rectangle {
            clearance: RELATIVE_CLEARANCE * rectangle.bounds().reach(),
            ..rectangle
        })
    }

    /// The rectangle moved by `transform`; its front stays in front.
    pub fn transformed(&self, transform: &Transform) -> Result<Rectangle, InvalidParameter> {
        let (mut u, mut v) = (self.edge_u, self.edge_v);
        if transform.mirrors() {
            (u, v) = (v, u);
        }
        Rectangle::new(
            transform.point(self.corner),
            transform.vector(u),
            transform.vector(v),
        )
    }

    /// Whether `point` lies exactly in the plane of the rectangle, and within its edges.
    pub fn holds(&self, point: DVec3) -> bool {
        let offset = point - self.corner;
        let within = |dual: DVec3| (0.0..=1.0).contains(&offset.dot(dual));
        offset.dot(*self.normal) == 0.0 && self.duals.into_iter().all(within)
    }

    /// Whether all `points` and all `lights`, in world units, lie on one side of the plane of the rectangle.
    /// Points within its clearance, 2^-44 of its largest coordinate, are on both sides; so are lights in the
    /// plane itself.
    pub(crate) fn has_on_one_side(&self, points: &[DVec3], lights: &[DVec3]) -> bool {
        let all_below = |normal: DVec3| {
            let height = |point: &DVec3| (*point - self.corner).dot(normal);
            points.iter().all(|point| height(point) <= self.clearance)
                && lights.iter().all(|light| height(light) <= 0.0)
        };
        all_below(*self.normal) || all_below(-*self.normal)
    }

    /// Normal, along `edge_u × edge_v`.
    pub fn normal(&self) -> Direction {
        self.normal
    }

    fn centre(&self) -> DVec3 {
        self.corner + (self.edge_u + self.edge_v) * 0.5
    }

    /// The rectangle seen from `point`, where points sampled by solid angle have less noise than by
    /// area: nearer than [`FAR`] diagonals. `None` elsewhere, in its plane, and of a parallelogram.
    fn seen_from(&self, point: DVec3) -> Option<SphericalRectangle> {
        let [width, height] = self.lengths?;
        let offset = self.corner - point;
        let far = FAR * FAR * (width * width + height * height);
        if (self.centre() - point).length_squared() > far {
            return None;
        }
        let [u, v] = self.duals.map(|dual| offset.dot(dual));
        SphericalRectangle::new(
            [u * width, v * height],
            [width, height],
            offset.dot(*self.normal),
        )
    }

    /// Density of points sampled by solid angle, where the rectangle is `seen`, or else by area.
    fn pdf_of(&self, seen: Option<SphericalRectangle>) -> EmitterPdf {
        match seen {
            Some(seen) => EmitterPdf::PerSteradian(1.0 / seen.solid_angle()),
            None => EmitterPdf::PerArea(self.pdf()),
        }
    }

    fn corners(&self) -> [DVec3; 4] {
        let Rectangle {
            corner,
            edge_u,
            edge_v,
            ..
        } = *self;
        [
            corner,
            corner + edge_u,
            corner + (edge_u + edge_v),
            corner + edge_v,
        ]
    }

    /// Four roundings for the point and as many for a corner, beside the crossing's 104u of the
    /// reach: below the quarter of [`super::hit`].
    fn point(&self, [u, v]: [f64; 2]) -> SurfacePoint {
        SurfacePoint {
            position: self.corner + (self.edge_u * u + self.edge_v * v),
            normal: self.normal,
            clearance: self.clearance,
        }
    }

    /// As two triangles with the diagonal in common, of which a line crosses at most one.
    fn by_triangles(&self, ray: &Ray, limit: f64) -> Option<Crossing> {
        let frame = RayFrame::new(ray);
        let [a, b, c, d] = self.corners();
        let (crossing, uv) = if let Some(crossing) = frame.crossing([a, b, c]) {
            let [_, at_b, at_c] = crossing.weights;
            (crossing, [at_b + at_c, at_c])
        } else {
            let crossing = frame.crossing([a, c, d])?;
            let [_, at_c, at_d] = crossing.weights;
            (crossing, [at_c, at_c + at_d])
        };
        let uv = uv.map(|part: f64| part.min(1.0));
        (crossing.t > 0.0 && crossing.t < limit)
            .then(|| Crossing::new(crossing.t, crossing.side, 0, uv))
    }
}

/// Relative rounding that a clear crossing is clear of.
const ROUNDING: f64 = 1.0 / (1_u64 << 47) as f64;

impl Surface for Rectangle {
    fn bounds(&self) -> Aabb {
        Aabb::around(self.corners()).expect("four corners")
    }

    fn hull(&self) -> Vec<DVec3> {
        self.corners().to_vec()
    }

    /// Where `ray` crosses, at a distance with `0 < t < limit`.
    ///
    /// By the plane first: most rays clearly miss or clearly hit, and the few near an edge, or
    /// nearly parallel to the plane, are left to the triangles, which leave no gap between
    /// rectangles with corners in common. *Clearly* means by more than rounding: with `S` the sum
    /// of all lengths involved, `w·n` is off by less than 8uS and so `t` by 16uS/|d·n|; a place
    /// in the plane by twice that, in parts of the edges times the largest component of the
    /// duals and √3. 2^-47 is 64u.
    fn crossing(&self, ray: &Ray, limit: f64) -> Option<Crossing> {
        let away = self.corner - ray.origin;
        let slope = ray.direction.cosine_to(self.normal);
        // Margins, times the cosine to the normal: so they need no division.
        let steep = slope.abs();
        let in_t = ROUNDING * (away.abs().element_sum() + self.extent);
        let in_uv = 2.0 * in_t * self.steepest;
        // NaN, as for a ray in the plane, goes to the triangles too.
        let is_safe = in_uv < 0.01 * steep;
        if !is_safe {
            return self.by_triangles(ray, limit);
        }
        let height = away.dot(*self.normal);
        // t times the cosine.
        let ahead = if slope < 0.0 { -height } else { height };
        if ahead < -in_t || ahead - limit * steep > in_t {
            return None;
        }
        let t = height / slope;
        let offset = ray.direction * t - away;
        let mut uv = [0.0; 2];
        for (part, dual) in uv.iter_mut().zip(self.duals) {
            *part = offset.dot(dual);
            if *part * steep < -in_uv || (*part - 1.0) * steep > in_uv {
                return None;
            }
        }
        let clear = |part: f64| part * steep > in_uv && (1.0 - part) * steep > in_uv;
        if !(uv.into_iter().all(clear) && t * steep > in_t && (limit - t) * steep > in_t) {
            return self.by_triangles(ray, limit);
        }
        let side = if slope < 0.0 { Side::Front } else { Side::Back };
        Some(Crossing::new(t, side, 0, uv))
    }

    fn hit_at(&self, _: &Ray, crossing: &Crossing) -> Hit {
        Hit::new(crossing, self.point(crossing.uv))
    }
}

impl Emitter for Rectangle {
    fn area(&self) -> f64 {
        self.edge_u.cross(self.edge_v).length()
    }

    fn sample(&self, uv: [f64; 2]) -> SurfacePoint {
        self.point(uv)
    }

    fn sample_towards(&self, to: DVec3, uv: [f64; 2]) -> (SurfacePoint, EmitterPdf) {
        let seen = self.seen_from(to);
        let uv = seen.map_or(uv, |seen| seen.sample(uv));
        (self.point(uv), self.pdf_of(seen))
    }

    fn pdf_towards(&self, to: DVec3) -> EmitterPdf {
        self.pdf_of(self.seen_from(to))
    }

    fn extent(&self) -> EmitterExtent {
        EmitterExtent {
            centre: self.centre(),
            spread: (self.edge_u.length_squared() + self.edge_v.length_squared()) / 12.0,
            normal: Some(self.normal),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_centre_and_normal() {
        let light =
            Rectangle::new(DVec3::new(-2.0, 5.0, -1.0), DVec3::X * 4.0, DVec3::Z * 2.0).unwrap();
        assert_eq!(light.normal(), Direction::NEG_Y);
        assert_eq!(light.area(), 8.0);
        assert_eq!(light.sample([0.5, 0.5]).position, DVec3::Y * 5.0);
        let ray = Ray::new(DVec3::new(1.0, 0.0, -0.5), DVec3::Y).unwrap();
        let hit = light.hit(&ray, f64::INFINITY).unwrap();
        assert_eq!(hit.t, 5.0);
        let crossing = light.crossing(&ray, f64::INFINITY).unwrap();
        assert_eq!(crossing.uv, [0.75, 0.25]);
        assert_eq!(hit.side, super::super::Side::Front);
        assert!(light.hit(&ray, 5.0).is_none());
    }

    #[test]
    fn sides_of_points() {
        let floor = Rectangle::new(-DVec3::X - DVec3::Z, DVec3::X * 2.0, DVec3::Z * 2.0).unwrap();
        let on = DVec3::new(0.3, 0.0, 7.0);
        let has_on_one_side = |points: &[DVec3]| floor.has_on_one_side(points, &[]);
        assert!(has_on_one_side(&[]));
        assert!(has_on_one_side(&[DVec3::Y, on, on - DVec3::Y * 1e-14]));
        assert!(has_on_one_side(&[DVec3::NEG_Y, on]));
        assert!(!has_on_one_side(&[DVec3::Y, on - DVec3::Y * 1e-9]));
        assert!(!has_on_one_side(&[DVec3::Y, DVec3::NEG_Y]));
        // However far another point is.
        assert!(!has_on_one_side(&[DVec3::Y * 1e9, on - DVec3::Y * 1e-9]));
        // A light just behind the floor does not shine through it.
        assert!(floor.has_on_one_side(&[DVec3::Y], &[on, DVec3::Y]));
        assert!(!floor.has_on_one_side(&[DVec3::Y], &[on - DVec3::Y * 1e-14]));
    }

    #[test]
    fn rectangles_without_area_are_refused() {
        let refused = |u, v| Rectangle::new(DVec3::ONE, u, v).is_err();
        assert!(refused(DVec3::ZERO, DVec3::X));
        assert!(refused(DVec3::X, DVec3::X * -3.0));
        assert!(refused(DVec3::X * f64::NAN, DVec3::Y));
        assert!(refused(DVec3::X * 1e-30, DVec3::Y));
        assert!(refused(DVec3::X * 1e200, DVec3::Y * 1e200));
    }
}

//! Intersections of lines with the bodies of media: balls, boxes along the axes, and all space.

use crate::geometry::Boundary;
use crate::scene::Body;
use glam::DVec3;

/// A convex body.
#[derive(Clone, Copy, Debug)]
pub enum Convex {
    /// All space.
    Everywhere,
    /// A ball.
    Ball { centre: DVec3, radius: f64 },
    /// A box along the axes.
    Cuboid { min: DVec3, max: DVec3 },
}

impl Convex {
    /// The shape of a medium.
    pub fn of(body: &Body) -> Result<Convex, String> {
        match &body.boundary {
            None => Ok(Convex::Everywhere),
            Some(Boundary::Sphere(sphere)) => Ok(Convex::Ball {
                centre: sphere.centre(),
                radius: sphere.radius(),
            }),
            Some(Boundary::Box(bounds)) => Ok(Convex::Cuboid {
                min: bounds.min,
                max: bounds.max,
            }),
            Some(_) => Err("a medium has a shape that is neither `sphere` nor `box`".to_owned()),
        }
    }

    /// From where to where the line from `origin` along the unit vector `direction` is inside, at
    /// distances that are not negative; `None` for a miss.
    pub fn span(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let [near, far] = match *self {
            Convex::Everywhere => [f64::NEG_INFINITY, f64::INFINITY],
            Convex::Ball { centre, radius } => {
                let to_centre = centre - origin;
                let nearest = to_centre.dot(direction);
                let beside = to_centre - direction * nearest;
                let squared = radius * radius - beside.length_squared();
                if squared <= 0.0 {
                    return None;
                }
                [nearest - squared.sqrt(), nearest + squared.sqrt()]
            }
            Convex::Cuboid { min, max } => {
                let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
                for axis in 0..3 {
                    if direction[axis] == 0.0 {
                        if origin[axis] < min[axis] || origin[axis] > max[axis] {
                            return None;
                        }
                        continue;
                    }
                    let at = |face: f64| (face - origin[axis]) / direction[axis];
                    let (one, other) = (at(min[axis]), at(max[axis]));
                    near = near.max(one.min(other));
                    far = far.min(one.max(other));
                }
                [near, far]
            }
        };
        let near = near.max(0.0);
        (near < far).then_some([near, far])
    }

    /// Length inside of the way from `point` along the unit vector `direction`, up to the distance
    /// `limit`.
    pub fn length(&self, point: DVec3, direction: DVec3, limit: f64) -> f64 {
        self.span(point, direction)
            .map_or(0.0, |[near, far]| (far.min(limit) - near).max(0.0))
    }
}

//! Point, spot and directional lights. Others are shapes that emit, and the environment.

use crate::geometry::{Direction, InvalidParameter, require};
use crate::math::{atan2, cos};
use glam::DVec3;

/// A light that rays hit with probability 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Emits from a point in every direction.
    Point(Point),
    /// Emits from a point into a cone.
    Spot(Spot),
    /// Emits from infinitely far away.
    Directional(Directional),
}

impl Light {
    /// World position; `None` for a light infinitely far away.
    pub fn position(&self) -> Option<DVec3> {
        match self {
            Light::Point(light) => Some(light.position),
            Light::Spot(light) => Some(light.position),
            Light::Directional(_) => None,
        }
    }

    /// Intensity or irradiance, by channel, where the light is brightest.
    pub fn strength(&self) -> DVec3 {
        let mut light = *self;
        *light.strength_mut()
    }

    /// The same, to be changed.
    pub fn strength_mut(&mut self) -> &mut DVec3 {
        match self {
            Light::Point(light) => &mut light.intensity,
            Light::Spot(light) => &mut light.intensity,
            Light::Directional(light) => &mut light.irradiance,
        }
    }

    /// Intensity towards `point` by channel, per steradian; irradiance for a light infinitely far
    /// away.
    pub(crate) fn strength_towards(&self, point: DVec3) -> DVec3 {
        let Light::Spot(light) = self else {
            return self.strength();
        };
        let towards = Direction::of(point - light.position);
        light.intensity * towards.map_or(0.0, |towards| light.falloff(towards))
    }
}

/// A point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// World position.
    pub position: DVec3,
    /// Radiant intensity by channel, power per steradian: the irradiance at distance `r` is
    /// `I/r²`.
    pub intensity: DVec3,
}

/// Light from infinitely far away, with the same direction everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Direction of travel.
    pub direction: Direction,
    /// Irradiance by channel on a plane perpendicular to the direction.
    pub irradiance: DVec3,
}

/// A point light that emits into a cone: full intensity within the inner angle from its axis, none
/// beyond the outer angle, and a linear falloff in the angle in between. Equal angles give a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// World position.
    pub position: DVec3,
    /// Intensity on the axis by channel, power per steradian.
    pub intensity: DVec3,
    axis: Direction,
    inner: f64,
    outer: f64,
    pub(crate) cos_outer: f64,
}

impl Spot {
    /// A spotlight at `position` along `towards` (any length but 0), with `intensity` on its axis;
    /// half-angles of the cone in degrees.
    pub fn new(
        position: DVec3,
        towards: DVec3,
        intensity: DVec3,
        [inner, outer]: [f64; 2],
    ) -> Result<Spot, InvalidParameter> {
        let axis = Direction::of(towards).ok_or_else(|| {
            let message = "the spotlight has no direction: its target is its position";
            InvalidParameter::new("target", message)
        })?;
        // Written so that NaN fails.
        let are_angles = 0.0 <= inner && inner <= outer && outer > 0.0 && outer <= 180.0;
        let message = format_args!(
            "a spotlight needs 0 <= inner_angle <= outer_angle <= 180 degrees and an outer_angle above 0, got {inner} and {outer}"
        );
        require(are_angles, "outer_angle", message)?;
        let (inner, outer) = (inner.to_radians(), outer.to_radians());
        Ok(Spot {
            position,
            intensity,
            axis,
            inner,
            outer,
            cos_outer: cos(outer),
        })
    }

    /// Direction of the axis.
    pub fn axis(&self) -> Direction {
        self.axis
    }

    /// Half-angle within which the intensity is full, radians.
    pub fn inner(&self) -> f64 {
        self.inner
    }

    /// Half-angle beyond which nothing is emitted, radians.
    pub fn outer(&self) -> f64 {
        self.outer
    }

    /// Intensity in `direction` relative to that on the axis: 1 within the inner cone, 0 from its
    /// outer edge on.
    pub(crate) fn falloff(&self, direction: Direction) -> f64 {
        let cosine = direction.cosine_to(self.axis);
        // The edge itself is dark, also where both angles are one: no 0/0 there.
        if cosine <= self.cos_outer {
            return 0.0;
        }
        // From sine and cosine: the arc cosine alone loses a narrow cone near its axis.
        let angle = atan2(direction.cross(*self.axis).length(), cosine);
        if angle <= self.inner {
            return 1.0;
        }
        ((self.outer - angle) / (self.outer - self.inner)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sin;

    fn at(degrees: f64) -> Direction {
        let angle = degrees.to_radians();
        Direction::unit(DVec3::new(sin(angle), 0.0, cos(angle)))
    }

    fn spot(inner: f64, outer: f64) -> Spot {
        Spot::new(DVec3::ZERO, DVec3::Z * 3.0, DVec3::ONE, [inner, outer]).unwrap()
    }

    #[test]
    fn full_inside_none_outside_linear_in_between() {
        let spot = spot(10.0, 30.0);
        assert_eq!(spot.falloff(Direction::Z), 1.0);
        assert_eq!(spot.falloff(at(9.9)), 1.0);
        // Angles to a few roundings, over a range of a third of a radian.
        assert!((spot.falloff(at(15.0)) - 0.75).abs() < 1e-14);
        assert!((spot.falloff(at(25.0)) - 0.25).abs() < 1e-14);
        assert_eq!(spot.falloff(at(30.1)), 0.0);
        assert_eq!(spot.falloff(Direction::NEG_Z), 0.0);
    }

    /// Hard case S9: equal angles are a step, and the edge is dark.
    #[test]
    fn s9_a_cone_with_a_sharp_edge_is_a_step() {
        let spot = spot(60.0, 60.0);
        let edge = Direction::unit(DVec3::new(
            (1.0 - spot.cos_outer * spot.cos_outer).sqrt(),
            0.0,
            spot.cos_outer,
        ));
        assert_eq!(spot.falloff(edge), 0.0);
        assert_eq!(spot.falloff(at(59.999_999)), 1.0);
        assert_eq!(spot.falloff(at(60.000_001)), 0.0);
    }

    #[test]
    fn a_cone_of_half_the_sphere_or_all_of_it() {
        assert_eq!(spot(90.0, 90.0).falloff(at(89.0)), 1.0);
        assert_eq!(spot(90.0, 90.0).falloff(at(91.0)), 0.0);
        assert_eq!(spot(180.0, 180.0).falloff(at(179.0)), 1.0);
    }

    #[test]
    fn bad_angles_and_directions_are_refused() {
        let new = |towards, angles| Spot::new(DVec3::ZERO, towards, DVec3::ONE, angles);
        let refused = |towards, angles| new(towards, angles).map_err(|error| error.name);
        assert_eq!(refused(DVec3::ZERO, [1.0, 2.0]), Err("target"));
        for angles in [
            [2.0, 1.0],
            [-1.0, 1.0],
            [0.0, 0.0],
            [0.0, 181.0],
            [f64::NAN, 1.0],
            [0.0, f64::NAN],
        ] {
            assert_eq!(refused(DVec3::Z, angles), Err("outer_angle"), "{angles:?}");
        }
    }
}

//! Orthonormal bases around a direction.

use super::Direction;
use glam::DVec3;

/// A right-handed orthonormal basis around a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First axis.
    pub x: Direction,
    /// Second axis.
    pub y: Direction,
    /// Third axis, `x × y`: the direction the frame was built around.
    pub z: Direction,
}

impl Frame {
    /// The frame around `z`, orthonormal to 8 roundings for every `z`; `−0.0` counts as below the
    /// equator.
    ///
    /// Source: Duff et al. 2017, "Building an orthonormal basis, revisited", JCGT 6(1).
    pub fn around(z: Direction) -> Frame {
        // The sign keeps the denominator at least 1 in magnitude on both hemispheres.
        let sign = 1.0_f64.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Frame {
            x: Direction::unit(DVec3::new(
                1.0 + sign * z.x * z.x * a,
                sign * b,
                -sign * z.x,
            )),
            y: Direction::unit(DVec3::new(b, sign + z.y * z.y * a, -z.y)),
            z,
        }
    }

    /// The direction with the coordinates `local` in this frame.
    pub fn to_world(&self, local: Direction) -> Direction {
        Direction::unit(self.x * local.x + self.y * local.y + self.z * local.z)
    }
}

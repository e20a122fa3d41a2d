//! Two directions at right angles to a third.

use glam::DVec3;

/// A right-handed orthonormal basis around a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First axis.
    pub x: DVec3,
    /// Second axis.
    pub y: DVec3,
    /// Third axis, `x × y`: the direction the frame was built around.
    pub z: DVec3,
}

impl Frame {
    /// The frame around a direction `z` of length 1, orthonormal to 8 roundings for every `z`;
    /// `−0.0` counts as below the equator.
    ///
    /// Source: Duff et al. 2017, "Building an orthonormal basis, revisited", JCGT 6(1).
    pub fn around(z: DVec3) -> Frame {
        // The sign keeps the denominator at least 1 in magnitude on both hemispheres.
        let sign = 1.0_f64.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Frame {
            x: DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: DVec3::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }

    /// The vector with the coordinates `local` in this frame.
    pub fn to_world(&self, local: DVec3) -> DVec3 {
        self.x * local.x + self.y * local.y + self.z * local.z
    }
}

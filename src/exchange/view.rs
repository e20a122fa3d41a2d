//! The camera, in the parameters of other renderers.

use crate::geometry::{Camera, Direction, Intrinsics, Ray};
use crate::math::atan2;
use glam::DVec3;

/// A camera as position, direction and angle.
pub(super) struct ExportView {
    /// Position of the camera.
    pub eye: DVec3,
    /// A point it looks at, as [`ahead`] of it.
    pub target: DVec3,
    /// The direction that points up in the image, perpendicular to the line of sight.
    pub up: DVec3,
    /// Full angle from the top to the bottom edge of an image in the middle, degrees; 0 for parallel rays.
    pub vertical_fov: f64,
    /// Height of the image of parallel rays, world units.
    pub orthographic_height: Option<f64>,
    /// Focal lengths and centre, where an angle does not say them: an image beside the axis, or pixels that are not
    /// square.
    pub intrinsics: Option<Intrinsics>,
}

impl ExportView {
    /// The view of `camera`, for an image of this size.
    pub(super) fn of(camera: &Camera, size: [usize; 2]) -> ExportView {
        let intrinsics = camera.intrinsics(size).filter(|_| !camera.is_centred());
        let intrinsics = intrinsics.map(|it| Intrinsics {
            focal_lengths: it.focal_lengths.map(rounded),
            centre: it.centre.map(rounded),
        });
        let half_fov = intrinsics.map(|it| atan2(0.5 * size[1] as f64, it.focal_lengths[1]));
        ExportView {
            eye: camera.eye,
            target: ahead(camera.eye, camera.axis),
            // Zeros without a sign.
            up: *camera.upright + DVec3::ZERO,
            orthographic_height: camera.orthographic_height(),
            vertical_fov: degrees(half_fov.map_or(camera.vertical_fov(), |half| 2.0 * half)),
            intrinsics,
        }
    }

    /// Full angle across the shorter side of an image, degrees.
    pub(super) fn shorter_fov(&self, width: usize, height: usize) -> f64 {
        if height <= width {
            return self.vertical_fov;
        }
        let half = (0.5 * self.vertical_fov).to_radians();
        let across = crate::math::tan(half) * width as f64 / height as f64;
        degrees(2.0 * atan2(across, 1.0))
    }
}

/// Whether rays begin at different points.
pub(super) fn is_parallel(sight: &[Ray]) -> bool {
    sight.iter().any(|ray| ray.origin != sight[0].origin)
}

/// A point of the ray from `origin` along `direction`, at the distance of the largest coordinate of
/// `origin` in magnitude, or 1 from the world's origin. Both points rounded to 32 bits, their
/// difference is off by a few roundings, whatever the unit of length.
pub(super) fn ahead(origin: DVec3, direction: Direction) -> DVec3 {
    let distance = match origin.abs().max_element() {
        0.0 => 1.0,
        reach => reach,
    };
    origin + direction * distance
}

/// Degrees, to fourteen digits: what conversions to radians and back have left of a round number is
/// round again.
pub(super) fn degrees(radians: f64) -> f64 {
    rounded(radians.to_degrees())
}

fn rounded(number: f64) -> f64 {
    let digits = format!("{number:.13e}");
    digits.parse().expect("a number is read back")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_is_read_back() {
        let eye = DVec3::new(0.0, 4.0, -11.5);
        let target = DVec3::new(0.0, 3.9, 5.0);
        let camera = Camera::new(eye, target, DVec3::Y, 37_f64.to_radians()).unwrap();
        let view = ExportView::of(&camera, [4, 3]);
        assert_eq!(view.eye, eye);
        // Unit vectors, a few roundings each.
        let forward = (target - eye).normalize();
        let expected = eye + 11.5 * forward;
        assert!((view.target - expected).length() < 16.0 * f64::EPSILON * eye.length());
        assert!(view.up.dot(forward).abs() < 8.0 * f64::EPSILON);
        assert!(view.up.y > 0.99);
        assert!((view.vertical_fov - 37.0).abs() < 1e-11);
        assert_eq!(view.shorter_fov(4, 3), view.vertical_fov);
        // Where 1 is less than a rounding of the eye to 32 bits, the target is no less another point.
        let far = Camera::new(1e12 * eye, 1e12 * target, DVec3::Y, 37_f64.to_radians()).unwrap();
        let far = ExportView::of(&far, [4, 3]);
        let rounded = far.target.as_vec3() - far.eye.as_vec3();
        assert!((rounded.as_dvec3().normalize() - forward).length() < 1e-6);
        // Half as wide as high: half the tangent.
        let half = crate::math::tan(0.5 * view.shorter_fov(1, 2).to_radians());
        let expected = 0.5 * crate::math::tan(18.5_f64.to_radians());
        assert!((half - expected).abs() < 1e-13);
        // An angle that rounding makes of nothing else.
        let narrow = Camera::new(eye, target, DVec3::Y, 1e-20_f64.to_radians()).unwrap();
        assert_eq!(ExportView::of(&narrow, [4, 3]).vertical_fov, 1e-20);
    }
}

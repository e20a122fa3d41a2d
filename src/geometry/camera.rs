//! The camera: pinhole or orthographic.

use super::{Direction, Ray};
use crate::math;
use glam::DVec3;
use thiserror::Error;

/// A camera without a lens: rays through the centres of pixels or any other point of the image. They
/// come together in the eye, or, of an orthographic camera, begin in the plane of the eye and are
/// parallel.
///
/// Right-handed: looking along +z with +y up, +x is to the *left* of the image. Pixels are
/// square; row 0 is the top row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    forward: Direction,
    upright: Direction,
    /// Half the height of the image plane, along the image's two axes: at distance 1, or at the eye
    /// of an orthographic camera.
    half_right: DVec3,
    half_up: DVec3,
    projection: Projection,
}

/// Where rays begin, and where they go.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Projection {
    /// From the eye, through the points of the image plane.
    Perspective,
    /// From the points of the image plane, forward.
    Orthographic,
}

/// Error in the vectors of a camera.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum CameraError {
    /// Eye and target coincide.
    #[error("the camera is at its target, so it has no direction")]
    NoDirection,
    /// `up` is zero or parallel to the viewing direction.
    #[error("`up` must not be zero or parallel to the viewing direction")]
    NoUpright,
}

impl Camera {
    /// A camera at `eye` looking at `target`. `vertical_fov` is the full angle from the top to
    /// the bottom edge of the image, in radians, in (0, π), which the caller checks.
    pub fn new(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        vertical_fov: f64,
    ) -> Result<Camera, CameraError> {
        let half = math::tan(0.5 * vertical_fov);
        Camera::towards(eye, target, up, half, Projection::Perspective)
    }

    /// An orthographic camera at `eye` looking at `target`: rays are parallel and begin in the plane
    /// through the eye. `height` is that of the image, world units, > 0 and finite, which the caller
    /// checks.
    pub fn orthographic(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        height: f64,
    ) -> Result<Camera, CameraError> {
        Camera::towards(eye, target, up, 0.5 * height, Projection::Orthographic)
    }

    fn towards(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        half: f64,
        projection: Projection,
    ) -> Result<Camera, CameraError> {
        let forward = Direction::of(target - eye).ok_or(CameraError::NoDirection)?;
        let up = Direction::of(up).ok_or(CameraError::NoUpright)?;
        let right = Direction::of(forward.cross(*up)).ok_or(CameraError::NoUpright)?;
        let upright = Direction::unit(right.cross(*forward));
        Ok(Camera {
            eye,
            forward,
            upright,
            half_right: right * half,
            half_up: upright * half,
            projection,
        })
    }

    /// Origin of the rays; of an orthographic camera that of the ray through the centre of the image.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// Whether rays are parallel.
    pub(crate) fn is_orthographic(&self) -> bool {
        self.projection == Projection::Orthographic
    }

    /// The height of the image of an orthographic camera, world units.
    pub fn orthographic_height(&self) -> Option<f64> {
        self.is_orthographic().then(|| 2.0 * self.half_up.length())
    }

    /// The full angle from the top to the bottom edge of the image, in radians; 0 of an orthographic
    /// camera.
    pub fn vertical_fov(&self) -> f64 {
        match self.projection {
            Projection::Perspective => 2.0 * math::atan2(self.half_up.length(), 1.0),
            Projection::Orthographic => 0.0,
        }
    }

    /// This camera with an image plane `factor` times as large.
    pub(crate) fn with_image_scaled(&self, factor: f64) -> Camera {
        Camera {
            half_right: self.half_right * factor,
            half_up: self.half_up * factor,
            ..*self
        }
    }

    /// This camera with another [`Camera::vertical_fov`], in (0, π); an orthographic one has none and
    /// stays as it is.
    pub fn with_vertical_fov(&self, vertical_fov: f64) -> Camera {
        if self.is_orthographic() {
            return *self;
        }
        let factor = math::tan(0.5 * vertical_fov) / self.half_up.length();
        self.with_image_scaled(factor)
    }

    /// This camera with its eye moved by `offset`, world units; it looks in the same direction.
    pub fn with_eye_moved(&self, offset: DVec3) -> Camera {
        Camera {
            eye: self.eye + offset,
            ..*self
        }
    }

    /// This camera with its image plane shifted, so that all that is seen lies further right and down
    /// in the image by these fractions of its height. The rays are those of other points of the same
    /// plane; [`Camera::forward`] then is the direction through the new centre, no longer
    /// perpendicular to the plane, and [`Camera::vertical_fov`] only nearly the angle. Of an
    /// orthographic camera the eye moves in its plane.
    pub fn with_image_moved(&self, [right, down]: [f64; 2]) -> Camera {
        if self.is_orthographic() {
            let centre = self.half_up * (2.0 * down) - self.half_right * (2.0 * right);
            return Camera {
                eye: self.eye + centre,
                ..*self
            };
        }
        let centre = *self.forward - self.half_right * (2.0 * right) + self.half_up * (2.0 * down);
        let length = centre.length();
        Camera {
            forward: Direction::unit(centre / length),
            half_right: self.half_right / length,
            half_up: self.half_up / length,
            ..*self
        }
    }

    /// Up direction of the image, perpendicular to [`Camera::forward`].
    pub fn upright(&self) -> Direction {
        self.upright
    }

    /// Direction to the centre of the image.
    pub fn forward(&self) -> Direction {
        self.forward
    }

    /// Vector to the right in the image plane, at distance 1 or that of an orthographic camera, as long
    /// as half the image's height.
    pub fn half_right(&self) -> DVec3 {
        self.half_right
    }

    /// Vector from the centre of that image plane to its upper edge.
    pub fn half_up(&self) -> DVec3 {
        self.half_up
    }

    /// The ray through a point of the image, in pixels from its upper left corner.
    pub fn ray_through(&self, [x, y]: [f64; 2], [width, height]: [usize; 2]) -> Ray {
        self.ray_at(2.0 * x - width as f64, 2.0 * y - height as f64, height)
    }

    /// The ray through the centre of pixel (`column`, `row`) of an image of
    /// `width` × `height` pixels.
    pub fn ray(&self, [column, row]: [usize; 2], [width, height]: [usize; 2]) -> Ray {
        // Twice the pixel offset from the image centre: integers, so the two halves of an
        // image mirror each other exactly.
        let across = (2 * column + 1) as f64 - width as f64;
        let down = (2 * row + 1) as f64 - height as f64;
        self.ray_at(across, down, height)
    }

    /// The ray at twice the distance in pixels from the image centre, to the right and down.
    fn ray_at(&self, across: f64, down: f64, height: usize) -> Ray {
        let (right, down) = (
            self.half_right * (across / height as f64),
            self.half_up * (down / height as f64),
        );
        match self.projection {
            Projection::Perspective => {
                let towards = *self.forward + right - down;
                Ray {
                    origin: self.eye,
                    direction: Direction::unit(towards / towards.length()),
                }
            }
            Projection::Orthographic => Ray {
                origin: self.eye + right - down,
                direction: self.forward,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn camera() -> Camera {
        Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, FRAC_PI_2).unwrap()
    }

    /// A pixel of the moved image is the pixel of the other that lies that far from it.
    #[test]
    fn a_moved_image_has_the_same_rays() {
        let moved = camera().with_image_moved([2.0 / 8.0, -1.0 / 8.0]);
        for [x, y] in [[2, 1], [5, 6], [7, 0]] {
            let same = moved.ray([x, y], [10, 8]).direction;
            let there = camera().ray([x - 2, y + 1], [10, 8]).direction;
            assert!((*same - *there).length() <= 4.0 * f64::EPSILON);
        }
    }

    #[test]
    fn orthographic_rays_are_parallel_and_fill_the_height() {
        let target = DVec3::new(1.0, 2.0, 9.0);
        let camera = Camera::orthographic(DVec3::new(1.0, 2.0, 3.0), target, DVec3::Y, 4.0);
        let camera = camera.unwrap();
        // Pixels of an image two rows high are 2 wide.
        for (pixel, origin) in [
            ([0, 0], DVec3::new(3.0, 3.0, 3.0)),
            ([1, 1], DVec3::new(1.0, 1.0, 3.0)),
            ([2, 1], DVec3::new(-1.0, 1.0, 3.0)),
        ] {
            let ray = camera.ray(pixel, [3, 2]);
            assert_eq!(ray.origin, origin);
            assert_eq!(*ray.direction, DVec3::Z);
        }
        assert_eq!(camera.orthographic_height(), Some(4.0));
        assert_eq!(camera.vertical_fov(), 0.0);
        assert_eq!(camera.with_vertical_fov(1.0), camera);
        assert_eq!(
            camera.with_image_scaled(0.5).orthographic_height(),
            Some(2.0)
        );
        let moved = camera.with_image_moved([0.25, -0.5]);
        assert_eq!(moved.ray([2, 0], [4, 4]), camera.ray([1, 2], [4, 4]));
        assert!(!self::camera().is_orthographic());
    }

    #[test]
    fn looking_along_z_the_x_axis_points_left_and_row_zero_is_the_top() {
        let top_left = camera().ray([0, 0], [4, 4]).direction;
        assert!(top_left.x > 0.0 && top_left.y > 0.0 && top_left.z > 0.0);
        let bottom_right = camera().ray([3, 3], [4, 4]).direction;
        assert_eq!(
            *bottom_right,
            DVec3::new(-top_left.x, -top_left.y, top_left.z)
        );
    }

    #[test]
    fn the_field_of_view_spans_the_height_whatever_the_width() {
        for width in [1, 3, 8] {
            // With a right angle, the image plane at distance 1 reaches from −1 to 1; in an
            // image two pixels high the centres lie at ±½.
            let ray = camera().ray([(width - 1) / 2, 0], [width, 2]);
            let slope = ray.direction.y / ray.direction.z;
            // tan, product, quotient of normalised components: a few roundings.
            assert!((slope - 0.5).abs() < 4.0 * f64::EPSILON);
        }
    }

    #[test]
    fn degenerate_cameras_are_refused() {
        let at = |target, up| Camera::new(DVec3::ONE, target, up, 1.0);
        assert_eq!(at(DVec3::ONE, DVec3::Y), Err(CameraError::NoDirection));
        assert_eq!(at(DVec3::ZERO, DVec3::ONE), Err(CameraError::NoUpright));
        assert_eq!(at(DVec3::ZERO, DVec3::ZERO), Err(CameraError::NoUpright));
    }
}

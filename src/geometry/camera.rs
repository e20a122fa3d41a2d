//! The camera: pinhole or orthographic.

use super::{Direction, InvalidParameter, Ray};
use crate::math;
use glam::DVec3;

/// A camera without a lens: rays through the centres of pixels or any other point of the image. They
/// come together in the eye; those of an orthographic camera are parallel and begin in the plane of
/// the eye.
///
/// Right-handed: looking along +z with +y up, +x is to the *left* of the image. Pixels are
/// square; row 0 is the top row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Origin of the rays; for an orthographic camera, of the ray through the centre of the image.
    pub eye: DVec3,
    /// Direction of the line of sight, perpendicular to the image. Depth is measured along it.
    pub axis: Direction,
    /// Direction to the centre of the image: the axis, unless the image lies beside it.
    pub forward: Direction,
    /// Up direction of the image, perpendicular to the axis.
    pub upright: Direction,
    /// Vector to the right in the image plane, whose centre is at distance 1, or at the eye of an orthographic camera,
    /// as long as half the image's height in pixels.
    pub half_right: DVec3,
    /// Vector from the centre of that image plane to its upper edge.
    pub half_up: DVec3,
    /// Rays begin in the points of the image plane and go forward, not from the eye through these.
    pub(crate) is_orthographic: bool,
}

/// Lengths of an image in its pixels: where its axis meets it, and how far away it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Focal lengths by widths and by heights of pixels, > 0.
    pub focal_lengths: [f64; 2],
    /// The point on the axis, from the upper left corner to the right and down.
    pub centre: [f64; 2],
}

/// How far the columns of a matrix may be from perpendicular axes of length 1, in their products.
///
/// A number that is written with four decimals is off by up to 5e-5. The components of a column add up to √3 at most,
/// so the product of two columns is off by up to 2 √3 · 5e-5 = 1.8e-4.
const NOT_RIGID: f64 = 2e-4;

impl Camera {
    /// A camera at `eye` looking at `target`. `vertical_fov` is the full angle from the top to
    /// the bottom edge of the image, in radians, in (0, π), which the caller checks.
    pub fn new(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        vertical_fov: f64,
    ) -> Result<Camera, InvalidParameter> {
        let half = math::tan(0.5 * vertical_fov);
        Camera::towards(eye, target, up, half, false)
    }

    /// An orthographic camera at `eye` looking at `target`: rays are parallel and begin in the plane
    /// through the eye. `height` is that of the image, world units, > 0 and finite, which the caller
    /// checks.
    pub fn orthographic(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        height: f64,
    ) -> Result<Camera, InvalidParameter> {
        Camera::towards(eye, target, up, 0.5 * height, true)
    }

    /// A camera from its matrix into the world, row by row, and its intrinsics, for an image of this `size`, in pixels.
    /// The columns of the matrix are the directions right and up in the image and backward, and the eye: the axes of
    /// OpenGL. The matrix maps this direction to the ray of the pixel (i, j):
    ///
    /// ```text
    /// ((i + ½ − cx) / fl_x, −(j + ½ − cy) / fl_y, −1)
    /// ```
    ///
    /// as in the `transforms.json` of NeRF (Mildenhall et al. 2020). The matrix is not made orthonormal.
    pub fn of_matrix(
        rows: [[f64; 4]; 4],
        intrinsics: Intrinsics,
        [width, height]: [usize; 2],
    ) -> Result<Camera, InvalidParameter> {
        let column = |at: usize| DVec3::new(rows[0][at], rows[1][at], rows[2][at]);
        let [right, up, backward, eye] = [0, 1, 2, 3].map(column);
        let is_product = |a: DVec3, b: DVec3, of: f64| (a.dot(b) - of).abs() <= NOT_RIGID;
        let is_rigid = [right, up, backward].iter().all(|&a| is_product(a, a, 1.0))
            && is_product(right, up, 0.0)
            && is_product(up, backward, 0.0)
            && is_product(backward, right, 0.0)
            && right.cross(up).dot(backward) > 0.0
            && rows[3] == [0.0, 0.0, 0.0, 1.0];
        let axis = Direction::of(-backward).filter(|_| is_rigid);
        let upright = |axis: Direction| Direction::of(up - *axis * up.dot(*axis));
        let frame = axis.and_then(|axis| Some((axis, upright(axis)?)));
        let (axis, upright) = frame.ok_or_else(|| {
            let message = "the first three columns of `matrix` are no right-handed axes of length 1, \
                           perpendicular to each other, or its last row is not [0, 0, 0, 1]";
            InvalidParameter::new("matrix", message)
        })?;
        let [width, height] = [width, height].map(|pixels| pixels as f64);
        let Intrinsics {
            focal_lengths: [across, along],
            centre: [x, y],
        } = intrinsics;
        let [half_right, half_up] = [right * (0.5 * height / across), up * (0.5 * height / along)];
        let beside = [width - 2.0 * x, height - 2.0 * y].map(|pixels| pixels / height);
        let centre = half_right * beside[0] - half_up * beside[1] - backward;
        let mut camera = Camera {
            eye,
            axis,
            forward: axis,
            upright,
            half_right,
            half_up,
            is_orthographic: false,
        };
        camera.look_at(centre);
        Ok(camera)
    }

    fn towards(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        half: f64,
        is_orthographic: bool,
    ) -> Result<Camera, InvalidParameter> {
        let forward = Direction::of(target - eye).ok_or_else(|| {
            let message = "the camera is at its target, so it has no direction";
            InvalidParameter::new("eye", message)
        })?;
        let right = Direction::of(up).and_then(|up| Direction::of(forward.cross(*up)));
        let right = right.ok_or_else(|| {
            let message = "`up` must not be zero or parallel to the viewing direction";
            InvalidParameter::new("up", message)
        })?;
        let upright = Direction::unit(right.cross(*forward));
        Ok(Camera {
            eye,
            axis: forward,
            forward,
            upright,
            half_right: right * half,
            half_up: upright * half,
            is_orthographic,
        })
    }

    /// The height of the image of an orthographic camera, world units.
    pub fn orthographic_height(&self) -> Option<f64> {
        self.is_orthographic.then(|| 2.0 * self.half_up.length())
    }

    /// Whether a field of view says where its rays go: its centre is on the axis, and its pixels are square, to a
    /// thousandth of a pixel in an image of a thousand.
    pub fn is_centred(&self) -> bool {
        let [right, up] = [self.half_right.length(), self.half_up.length()];
        (*self.forward - *self.axis).length() <= 1e-6 * up && (right - up).abs() <= 1e-6 * up
    }

    /// The intrinsics of an image of this size, in pixels; none where rays are parallel.
    pub fn intrinsics(&self, [width, height]: [usize; 2]) -> Option<Intrinsics> {
        if self.is_orthographic {
            return None;
        }
        let [right, up] = [self.half_right.length(), self.half_up.length()];
        let half = 0.5 * height as f64;
        let distance = half * self.forward.dot(*self.axis);
        let beside = [self.half_right / right, -self.half_up / up].map(|to| self.forward.dot(to));
        Some(Intrinsics {
            focal_lengths: [distance / right, distance / up],
            centre: [
                0.5 * width as f64 - half * beside[0] / right,
                half - half * beside[1] / up,
            ],
        })
    }

    /// The full angle from the top to the bottom edge of the image, in radians: nearly so where its centre
    /// lies beside the axis. An orthographic camera has 0.
    pub fn vertical_fov(&self) -> f64 {
        match self.is_orthographic {
            false => 2.0 * math::atan2(self.half_up.length(), 1.0),
            true => 0.0,
        }
    }

    /// This camera with an image plane `factor` times as large, about the axis.
    pub(crate) fn with_image_scaled(&self, factor: f64) -> Camera {
        let mut scaled = Camera {
            half_right: self.half_right * factor,
            half_up: self.half_up * factor,
            ..*self
        };
        if self.forward != self.axis {
            let ahead = *self.axis * self.axis.dot(*self.forward);
            scaled.look_at(ahead + (*self.forward - ahead) * factor);
        }
        scaled
    }

    /// Moves the centre of the image, in its plane, to `centre` as seen from the eye.
    fn look_at(&mut self, centre: DVec3) {
        let length = centre.length();
        self.forward = Direction::unit(centre / length);
        self.half_right /= length;
        self.half_up /= length;
    }

    /// This camera with another [`Camera::vertical_fov`], in (0, π); an orthographic one has none and
    /// stays as it is.
    pub fn with_vertical_fov(&self, vertical_fov: f64) -> Camera {
        if self.is_orthographic {
            return *self;
        }
        let factor = math::tan(0.5 * vertical_fov) / self.half_up.length();
        self.with_image_scaled(factor)
    }

    /// This camera with parallel rays in place of those from one point, or the reverse. It sees the same part of the
    /// plane at `depth` along the axis, world units, > 0.
    pub(crate) fn with_other_projection(&self, depth: f64) -> Camera {
        if self.is_orthographic {
            return Camera {
                half_right: self.half_right / depth,
                half_up: self.half_up / depth,
                is_orthographic: false,
                ..*self
            };
        }
        let distance = depth / self.axis.dot(*self.forward);
        Camera {
            eye: self.eye + *self.forward * distance - *self.axis * depth,
            forward: self.axis,
            half_right: self.half_right * distance,
            half_up: self.half_up * distance,
            is_orthographic: true,
            ..*self
        }
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
    /// plane. The eye of an orthographic camera moves in its plane.
    pub fn with_image_moved(&self, [right, down]: [f64; 2]) -> Camera {
        if self.is_orthographic {
            let centre = self.half_up * (2.0 * down) - self.half_right * (2.0 * right);
            return Camera {
                eye: self.eye + centre,
                ..*self
            };
        }
        let centre = *self.forward - self.half_right * (2.0 * right) + self.half_up * (2.0 * down);
        let mut moved = *self;
        moved.look_at(centre);
        moved
    }

    /// The ray through the centre of a pixel (column, row) of an image of this `size`, in pixels.
    pub fn ray(&self, pixel: [usize; 2], size: [usize; 2]) -> Ray {
        self.ray_through(pixel.map(|index| index as f64 + 0.5), size)
    }

    /// The ray through a point of an image of this size, in pixels from its upper left corner.
    pub fn ray_through(&self, [x, y]: [f64; 2], [width, height]: [usize; 2]) -> Ray {
        // Twice the offset from the image centre: integers for the centres of pixels, so the two halves of an
        // image mirror each other exactly.
        let (across, below) = (2.0 * x - width as f64, 2.0 * y - height as f64);
        let right = self.half_right * (across / height as f64);
        let down = self.half_up * (below / height as f64);
        if self.is_orthographic {
            return Ray {
                origin: self.eye + right - down,
                direction: self.forward,
            };
        }
        let towards = *self.forward + right - down;
        Ray {
            origin: self.eye,
            direction: Direction::unit(towards / towards.length()),
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

    /// Rays of both meet in the plane at that depth, also where the image lies beside the axis.
    #[test]
    fn the_other_projection_sees_the_same_plane() {
        let beside = camera().with_image_moved([0.2, -0.1]);
        for perspective in [camera(), beside] {
            let parallel = perspective.with_other_projection(3.0);
            assert!(parallel.is_orthographic && !perspective.is_orthographic);
            let back = parallel.with_other_projection(3.0);
            for pixel in [[0, 0], [4, 1], [9, 7]] {
                let [one, other, back] = [perspective, parallel, back].map(|camera| {
                    let ray = camera.ray(pixel, [10, 8]);
                    ray.origin + *ray.direction * (3.0 / ray.direction.dot(*camera.axis))
                });
                assert!((one - other).length() <= 32.0 * f64::EPSILON);
                // An image beside the axis has moved the eye.
                assert!((back - other).length() <= 32.0 * f64::EPSILON);
            }
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
        assert!(!self::camera().is_orthographic);
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
        let refused = |target, up| at(target, up).map_err(|error| error.name);
        assert_eq!(refused(DVec3::ONE, DVec3::Y), Err("eye"));
        assert_eq!(refused(DVec3::ZERO, DVec3::ONE), Err("up"));
        assert_eq!(refused(DVec3::ZERO, DVec3::ZERO), Err("up"));
    }
}

//! The camera: its position and its target.

use super::SceneResult;
use super::format::{Key, Kind, Range, Rule, Table};
use super::reader::Reader;
use crate::geometry::{Aabb, Camera, Intrinsics, length_of};
use crate::math;
use glam::DVec3;

/// The declaration of `[camera]`.
pub(super) const CAMERA: Table = Table::new("The camera: pinhole, or orthographic with `orthographic_height`. By default it sees the whole of a classified volume from the front; required in a radiative scene.").keys(&[
    Key::derived("eye", Kind::Vector, "in front of the volume, on the −z side (−y if `up` is along z), as close as possible with the whole volume in view; with `azimuth`, `elevation` or `zoom` where these say")
        .doc("Position of the camera, world units; required in a radiative scene."),
    Key::derived("target", Kind::Vector, "volume centre")
        .doc("The point in the middle of the image, world units; required in a radiative scene."),
    Key::or("up", Kind::Vector, "[0.0, 1.0, 0.0]")
        .doc("The direction that points up in the image, any length."),
    Key::or("vertical_fov", Kind::Number(Range::open(0.0, 180.0)), "45.0")
        .doc("Full angle between the top and bottom edge of the image, degrees."),
    Key::optional("orthographic_height", Kind::Number(Range::POSITIVE))
        .doc("Height of the image, world units, of a camera with parallel rays, which begin in the plane through the eye. If left out, rays come together in the eye."),
    Key::optional("matrix", Kind::Matrix(4))
        .doc("Map of the camera into the world, four rows, in place of `eye`, `target`, `up` and `vertical_fov`. Its columns are the directions right and up in the image and backward, of length 1, and the eye: the axes of OpenGL and of `transforms.json`."),
    Key::optional("fl_x", Kind::Number(FOCAL_LENGTH))
        .doc("Focal length in widths of a pixel: the ray of pixel (i, j) is ((i + 1/2 - cx)/fl_x, -(j + 1/2 - cy)/fl_y, -1) in the camera."),
    Key::optional("fl_y", Kind::Number(FOCAL_LENGTH))
        .doc("Focal length in heights of a pixel."),
    Key::optional("cx", Kind::Number(CENTRE))
        .doc("Place of the optical axis in the image, pixels from its left edge; half its width is the middle."),
    Key::optional("cy", Kind::Number(CENTRE))
        .doc("Place of the optical axis in the image, pixels from its upper edge; half its height is the middle."),
    Key::optional("azimuth", Kind::Number(Range::closed(-360.0, 360.0)))
        .doc("In place of `eye` and `target`, of a classified volume: angle of the eye about `up`, degrees, from in front of the volume towards the right of the image; 0 if left out."),
    Key::optional("elevation", Kind::Number(Range::open(-90.0, 90.0)))
        .doc("In place of `eye` and `target`, of a classified volume: angle of the eye above the horizon, degrees; 0 if left out."),
    Key::optional("zoom", Kind::Number(Range::closed(0.01, 100.0)))
        .doc("In place of `eye` and `target`, of a classified volume: its distance from the eye is divided by this number; at 1, which holds if left out, the whole box just fits into the image."),
]).rules(&[
    Rule::Apart([&["vertical_fov"], &["orthographic_height"]]),
    Rule::Together(&MATRIX),
    Rule::Apart([&["matrix"], &["eye", "target", "up", "vertical_fov", "orthographic_height", "azimuth", "elevation", "zoom"]]),
    Rule::Apart([&["eye", "target"], &AROUND_NAMES]),
    Rule::Apart([&["orthographic_height"], &["zoom"]]),
]);

const MATRIX: [&str; 5] = ["matrix", "fl_x", "fl_y", "cx", "cy"];

/// With an image that begins this many pixels beside the axis, directions keep their digits.
const CENTRE: Range = Range::closed(-1e9, 1e9);
const FOCAL_LENGTH: Range = Range::closed(1e-3, 1e9);

/// Keys that place the eye around a classified volume, which is seen whole.
const AROUND_NAMES: [&str; 3] = ["azimuth", "elevation", "zoom"];

/// Height of the image.
#[derive(Clone, Copy)]
enum ImageHeight {
    /// Seen from the eye, radians.
    Angle(f64),
    /// Height of the image with parallel rays, world units.
    Length(f64),
}

impl ImageHeight {
    fn read(reader: &Reader) -> SceneResult<ImageHeight> {
        Ok(match reader.optional("orthographic_height")? {
            Some(height) => ImageHeight::Length(height),
            None => ImageHeight::Angle(reader.get::<f64>("vertical_fov")?.to_radians()),
        })
    }

    /// The camera with such an image.
    fn seen(self, reader: &Reader, eye: DVec3, target: DVec3, up: DVec3) -> SceneResult<Camera> {
        reader.accepted(match self {
            ImageHeight::Angle(vertical_fov) => Camera::new(eye, target, up, vertical_fov),
            ImageHeight::Length(height) => Camera::orthographic(eye, target, up, height),
        })
    }
}

/// Reads `[camera]`, and the target; what the scene leaves out follows from what is looked at. `size` is that of the
/// image.
pub(super) fn framing(
    reader: &Reader,
    bounds: &Aabb,
    size: [usize; 2],
) -> SceneResult<(Camera, DVec3)> {
    if let Some(camera) = by_matrix(reader, size)? {
        return Ok((camera, bounds.centre()));
    }
    let image = ImageHeight::read(reader)?;
    let eye = reader.optional("eye")?;
    let target = reader.vector_or("target", || bounds.centre())?;
    // Last, though the eye may follow from it: the hash of a scene holds its keys in the order
    // in which they are read.
    let up = reader.get("up")?;
    let aspect = size[0] as f64 / size[1] as f64;
    let around = Around::read(reader)?;
    let eye = eye.unwrap_or_else(|| match around {
        None => eye_that_sees_all(bounds, up, image, aspect),
        Some(around) => around.eye(bounds, up, image, aspect),
    });
    reader.resolved("eye", eye);
    Ok((image.seen(reader, eye, target, up)?, target))
}

/// Reads `[camera]` of a scene in which nothing says what is looked at: eye and target must be given.
pub(super) fn given(reader: &Reader, size: [usize; 2]) -> SceneResult<Camera> {
    if let Some(camera) = by_matrix(reader, size)? {
        return Ok(camera);
    }
    let image = ImageHeight::read(reader)?;
    let point = |name: &'static str| {
        let missing = || reader.error(name, format!("missing key `{name}` in [camera]"));
        reader.optional(name)?.ok_or_else(missing)
    };
    let (eye, target) = (point("eye")?, point("target")?);
    image.seen(reader, eye, target, reader.get("up")?)
}

/// A place around what is looked at.
struct Around {
    /// About `up`, radians.
    azimuth: f64,
    /// Above the horizon, radians.
    elevation: f64,
    zoom: f64,
}

impl Around {
    fn read(reader: &Reader) -> SceneResult<Option<Around>> {
        let [azimuth, elevation, zoom] = AROUND_NAMES.map(|name| reader.optional::<f64>(name));
        let numbers = [azimuth?, elevation?, zoom?];
        let is_asked = numbers.iter().any(Option::is_some);
        Ok(is_asked.then(|| Around {
            azimuth: numbers[0].unwrap_or(0.0).to_radians(),
            elevation: numbers[1].unwrap_or(0.0).to_radians(),
            zoom: numbers[2].unwrap_or(1.0),
        }))
    }

    /// The eye from which all corners of the box lie in the image, at a margin of 5 %, or one of them at it; with
    /// parallel rays, two diagonals away.
    fn eye(&self, bounds: &Aabb, up: DVec3, image: ImageHeight, aspect: f64) -> DVec3 {
        let front = if up.x == 0.0 && up.y == 0.0 {
            DVec3::Y
        } else {
            DVec3::Z
        };
        // Where there is no such frame, as `up` is 0 or not finite, the camera is refused.
        let up = up.normalize_or(DVec3::Y);
        let front = (front - up * front.dot(up)).normalize_or(front);
        let right = front.cross(up);
        let level = right * math::sin(self.azimuth) - front * math::cos(self.azimuth);
        let to_eye = level * math::cos(self.elevation) + up * math::sin(self.elevation);
        let right = up.cross(to_eye).normalize_or(right);
        let upright = to_eye.cross(right);
        let half = bounds.size() * 0.5;
        let distance = match image {
            ImageHeight::Length(_) => 4.0 * length_of(half),
            ImageHeight::Angle(vertical_fov) => {
                let edge = 0.95 * math::tan(0.5 * vertical_fov);
                let needed = bounds.corners().map(|corner| {
                    let corner = corner - bounds.centre();
                    let [x, y] = [corner.dot(right).abs() / aspect, corner.dot(upright).abs()];
                    x.max(y) / edge + corner.dot(to_eye)
                });
                needed.into_iter().fold(0.0, f64::max) / self.zoom
            }
        };
        bounds.centre() + to_eye * distance
    }
}

/// The camera of `matrix` and its intrinsics, if they are given.
fn by_matrix(reader: &Reader, size: [usize; 2]) -> SceneResult<Option<Camera>> {
    let Some(rows) = reader.optional("matrix")? else {
        return Ok(None);
    };
    let intrinsics = Intrinsics {
        focal_lengths: [reader.get("fl_x")?, reader.get("fl_y")?],
        centre: [reader.get("cx")?, reader.get("cy")?],
    };
    let camera = Camera::of_matrix(rows, intrinsics, size).map_err(|error| {
        let help = "give the map from the camera to the world, row by row, with four decimals or more and without \
                    a scale: divide columns by their lengths, invert a map from the world to the camera, and of a \
                    camera of OpenCV negate the second and third column";
        reader.mistake("matrix", error.message, help)
    })?;
    Ok(Some(camera))
}

/// The eye before the middle of the box, on its −z side. Where `up` is along z, as in most scans, −z is below: it is on
/// the −y side then. The front face fills the image but for a margin of 5 %. Parallel rays see as much from anywhere: with
/// them the eye is as far before the box as the box is high or wide.
fn eye_that_sees_all(bounds: &Aabb, up: DVec3, image: ImageHeight, aspect: f64) -> DVec3 {
    let half = bounds.size() * 0.5;
    let (forward, half_depth, half_of_up) = if up.x == 0.0 && up.y == 0.0 {
        (DVec3::Y, half.y, half.z)
    } else {
        (DVec3::Z, half.z, half.y)
    };
    let half_height = half_of_up.max(half.x / aspect);
    let to_front = match image {
        ImageHeight::Angle(vertical_fov) => half_height / (0.95 * math::tan(0.5 * vertical_fov)),
        ImageHeight::Length(_) => 2.0 * half_height,
    };
    bounds.centre() - forward * (half_depth + to_front)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From wherever a scene looks at its volume, all corners are in the image, and the outermost at its margin.
    #[test]
    fn an_eye_around_the_volume_sees_all_and_no_more() {
        let min = DVec3::new(-3.0, 5.0, 7.0);
        for size in [[1.0, 1.0, 1.0], [4.0, 0.5, 2.0], [2.0, 2.0, 0.01]] {
            let max = min + DVec3::from_array(size);
            let bounds = Aabb { min, max };
            for (up, azimuth, elevation) in [
                (DVec3::Y, 0.0, 0.0),
                (DVec3::Y, 30.0_f64, 20.0_f64),
                (DVec3::Z, -150.0, -80.0),
                (DVec3::new(1.0, 2.0, 0.5), 75.0, 45.0),
            ] {
                for aspect in [0.5, 1.0, 2.0] {
                    let around = Around {
                        azimuth: azimuth.to_radians(),
                        elevation: elevation.to_radians(),
                        zoom: 1.0,
                    };
                    let fov = 0.7;
                    let eye = around.eye(&bounds, up, ImageHeight::Angle(fov), aspect);
                    let camera = Camera::new(eye, bounds.centre(), up, fov).unwrap();
                    let above = (-*camera.forward).dot(up) / length_of(up);
                    assert!((above - math::sin(elevation.to_radians())).abs() < 1e-12);
                    let edge = math::tan(0.5 * fov);
                    let widest = bounds.corners().map(|corner| {
                        let seen = corner - eye;
                        let depth = edge * seen.dot(*camera.forward);
                        assert!(depth > 0.0);
                        let right = camera.forward.cross(*camera.upright);
                        let across = seen.dot(right).abs() / (depth * aspect);
                        across.max(seen.dot(*camera.upright).abs() / depth)
                    });
                    let widest = widest.into_iter().fold(0.0, f64::max);
                    assert!((widest - 0.95).abs() < 1e-9, "{size:?} {up}: {widest}");
                }
            }
        }
    }

    /// The camera that a scene gets if it says nothing shows all corners of the volume, and does
    /// not stand farther away than that needs.
    #[test]
    fn the_default_eye_sees_all_and_no_more() {
        for size in [
            [1.0, 1.0, 1.0],
            [4.0, 0.5, 2.0],
            [0.1, 3.0, 9.0],
            [2.0, 2.0, 0.01],
        ] {
            for aspect in [0.25, 1.0, 16.0 / 9.0] {
                for degrees in [10.0_f64, 45.0, 120.0] {
                    for up in [DVec3::Y, DVec3::Z, DVec3::new(0.0, 0.0, -3.0)] {
                        let fov = degrees.to_radians();
                        let min = DVec3::new(-3.0, 5.0, 7.0);
                        let bounds = Aabb {
                            min,
                            max: min + DVec3::from_array(size),
                        };
                        let image = ImageHeight::Angle(fov);
                        let eye = eye_that_sees_all(&bounds, up, image, aspect);
                        let camera = Camera::new(eye, bounds.centre(), up, fov).unwrap();
                        let (up, forward) = (*camera.upright, *camera.forward);
                        let right = forward.cross(up);
                        let edge = math::tan(0.5 * fov);
                        let mut widest = 0.0_f64;
                        for corner in bounds.corners() {
                            let seen = corner - eye;
                            let depth = seen.dot(forward);
                            assert!(depth > 0.0);
                            let across = seen.dot(right).abs() / (depth * edge * aspect);
                            let up = seen.dot(up).abs() / (depth * edge);
                            widest = widest.max(across).max(up);
                        }
                        // 1 is the edge of the image; a margin of 5 % is kept.
                        assert!(
                            (widest - 0.95).abs() < 1e-9,
                            "{size:?} {aspect} {degrees} {up}: {widest}"
                        );
                    }
                }
            }
        }
    }
}

//! Depth of another renderer's image, and the cause of one that is wrong.

use crate::compare::depth::DepthDifference;
use crate::film::Depth;
use crate::render;
use crate::scene::{Panel, Scene};

/// Opacity below which a depth is not compared: rounded to 8 bits, as buffers hold it, the weights of its mean are off
/// by a fifth.
const FAINTEST: f32 = 0.01;

/// Comparison of the depths of an image with others.
pub(super) struct DepthComparison<'c> {
    /// Scene of the image.
    pub scene: &'c Scene,
    /// Right opacity, where it is known.
    pub opacity: Option<&'c [f32]>,
    /// Columns of the image.
    pub width: usize,
    /// Longest step of its volumes.
    pub step: f64,
}

impl DepthComparison<'_> {
    /// Right depths, of the pixels that are compared.
    pub fn right(&self, depth: Depth) -> Result<Vec<f32>, String> {
        Ok(self.seen(render::depth(self.scene, depth)?))
    }

    /// Difference of `test` from `right`.
    pub fn of(&self, right: &[f32], test: &[f32]) -> DepthDifference {
        DepthDifference::of(right, test, self.width, self.step)
    }

    fn seen(&self, mut depths: Vec<f32>) -> Vec<f32> {
        for (depth, &opacity) in depths.iter_mut().zip(self.opacity.unwrap_or_default()) {
            if opacity < FAINTEST {
                *depth = f32::INFINITY;
            }
        }
        depths
    }

    /// True if nothing of the difference between the two is left.
    fn explains(&self, right: &[f32], test: &[f32]) -> bool {
        let found = self.of(right, test);
        found.shows_depth() && found.outside == 0
    }
}

/// Distances must be spread this much, as the farthest over the nearest, for two planes to be found from them.
const LEAST_SPREAD: f64 = 1.02;

/// The nature of `test`, a wrong depth in place of the `right` one, which is `asked` for, if nothing but that is wrong: another depth of the
/// scene, or a number that follows from it.
pub(super) fn cause(
    compared: &DepthComparison<'_>,
    asked: Depth,
    (right, test): (&[f32], &[f32]),
) -> Option<String> {
    let others = Depth::ALL.into_iter().map(|(_, other)| other);
    let others = others.filter(|&other| other != asked).filter_map(|other| {
        let found = compared.of(&compared.right(other).ok()?, test);
        (found.shows_depth() && found.agrees()).then_some((found.mean, other))
    });
    if let Some((_, other)) = others.min_by(|(a, _), (b, _)| a.total_cmp(b)) {
        return Some(format!(
            "the {other} depth, and the case asks for the {asked} one"
        ));
    }
    let entries = entries(compared.scene, asked.along_view)?;
    let within = right.iter().zip(&entries).map(|(at, entry)| at - entry);
    if compared.explains(&within.collect::<Vec<_>>(), test) {
        let said = "the distance from where the ray enters the volume: count from the eye";
        return Some(said.to_owned());
    }
    let first = render::first_opacity(compared.scene, asked.along_view).ok()?;
    if compared.explains(&compared.seen(first), test) {
        return Some(format!(
            "the distance of the first sample of any opacity, and the case asks for the {asked} depth"
        ));
    }
    let along_view = Depth {
        along_view: true,
        ..asked
    };
    let right_along_view = compared.right(along_view).ok()?;
    let buffers = [Buffer::Perspective, Buffer::Linear].into_iter();
    let mut buffers = buffers.filter_map(|kind| Planes::of(kind, &right_along_view, test));
    let planes =
        buffers.find(|planes| compared.explains(&right_along_view, &planes.distances(test)));
    planes
        .map(|planes| planes.in_words())
        .or_else(|| changed_unit_or_origin(compared, right, test))
}

/// The right depth times a number, or with one added, whichever is nearer: in other units, or from another place.
fn changed_unit_or_origin(
    compared: &DepthComparison<'_>,
    right: &[f32],
    test: &[f32],
) -> Option<String> {
    let both = right.iter().zip(test);
    let both = both.filter(|(right, test)| right.is_finite() && test.is_finite());
    let (mut count, mut sums) = (0.0, [0.0; 4]);
    for (&z, &value) in both {
        let (z, value) = (f64::from(z), f64::from(value));
        count += 1.0;
        for (sum, term) in sums.iter_mut().zip([z * z, z * value, z, value]) {
            *sum += term;
        }
    }
    let [squares, products, depths, values] = sums;
    let (factor, offset) = (products / squares, (values - depths) / count);
    let restored = |restore: &dyn Fn(f64) -> f64| -> Vec<f32> {
        let restore = |&value: &f32| restore(f64::from(value)) as f32;
        test.iter().map(restore).collect()
    };
    let changes = [
        (
            restored(&|value| value / factor),
            format!("{factor:.4} times the right depth: write distances in world units"),
        ),
        (
            restored(&|value| value - offset),
            format!("the right depth {offset:+.4}: count from the eye").replace('-', "−"),
        ),
    ];
    let explaining = changes.into_iter().filter_map(|(restored, words)| {
        let found = compared.of(right, &restored);
        (found.shows_depth() && found.outside == 0).then_some((found.mean, words))
    });
    let nearest = explaining.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    Some(nearest.1)
}

/// Distance at which the ray of each pixel enters the volume, along it or along the view.
fn entries(scene: &Scene, along_view: bool) -> Option<Vec<f32>> {
    let [Panel { width, height, .. }] = scene.panels[..] else {
        return None;
    };
    let volume = scene.panels[0].classified()?;
    if volume.volume_count() > 1 {
        return None;
    }
    let (extent, camera) = (volume.extent(), &volume.camera);
    let entry = |index: usize| {
        let ray = camera.ray([index % width, index / width], [width, height]);
        let cosine = ray.direction.dot(*camera.axis());
        let scale = if along_view { cosine } else { 1.0 };
        extent.span(&ray).map_or(0.0, |span| scale * span.near) as f32
    };
    Some((0..width * height).map(entry).collect())
}

/// Values of a depth buffer.
#[derive(Clone, Copy)]
enum Buffer {
    /// `a + b / z`, as a perspective projection makes it.
    Perspective,
    /// `a + b z`.
    Linear,
}

/// The planes between which a depth buffer goes from its least value to 1.
struct Planes {
    kind: Buffer,
    a: f64,
    b: f64,
    /// Values are below 0, as in the clip space of OpenGL, which goes from −1 to 1.
    is_clip_space: bool,
}

impl Planes {
    /// The planes nearest to `test`, given distances `right` along the view: by least squares.
    fn of(kind: Buffer, right: &[f32], test: &[f32]) -> Option<Planes> {
        let pairs = right.iter().zip(test);
        let pairs = pairs.map(|(&z, &value)| (f64::from(z), f64::from(value)));
        let pairs: Vec<_> = pairs.filter(|(z, _)| z.is_finite()).collect();
        let far = pairs.iter().map(|(z, _)| *z).fold(0.0, f64::max);
        let near = pairs.iter().map(|(z, _)| *z).fold(far, f64::min);
        let lowest = match kind {
            Buffer::Perspective => -1.0,
            Buffer::Linear => 0.0,
        };
        let are_values = pairs
            .iter()
            .all(|(_, value)| (lowest..=1.0).contains(value));
        let is_clip_space = pairs.iter().any(|(_, value)| *value < 0.0);
        if !(are_values && near > 0.0 && far > LEAST_SPREAD * near) {
            return None;
        }
        let of = |z: f64| match kind {
            Buffer::Perspective => z.recip(),
            Buffer::Linear => z,
        };
        let count = pairs.len() as f64;
        let x_mean = pairs.iter().map(|(z, _)| of(*z)).sum::<f64>() / count;
        let y_mean = pairs.iter().map(|(_, value)| value).sum::<f64>() / count;
        let (mut xx, mut xy) = (0.0, 0.0);
        for (z, value) in pairs {
            let x = of(z) - x_mean;
            xx += x * x;
            xy += x * (value - y_mean);
        }
        let b = xy / xx;
        let planes = Planes {
            kind,
            a: y_mean - b * x_mean,
            b,
            is_clip_space,
        };
        let near = planes.distance(if is_clip_space { -1.0 } else { 0.0 });
        let far = planes.distance(1.0);
        (b.is_finite() && near >= 0.0 && far > near).then_some(planes)
    }

    fn distance(&self, value: f64) -> f64 {
        match self.kind {
            Buffer::Perspective => self.b / (value - self.a),
            Buffer::Linear => (value - self.a) / self.b,
        }
    }

    fn distances(&self, test: &[f32]) -> Vec<f32> {
        let of = |value: &f32| self.distance(f64::from(*value)) as f32;
        test.iter().map(of).collect()
    }

    fn in_words(&self) -> String {
        let [clip, near, far] = [-1.0, 0.0, 1.0].map(|value| self.distance(value));
        let to_far = format!("and 1 at the far one, about {far:.3}");
        let buffer = match self.kind {
            Buffer::Linear => {
                format!("a share of the way, 0 at the near plane, about {near:.3}, {to_far}")
            }
            Buffer::Perspective if self.is_clip_space => {
                format!("the depth of clip space, −1 at the near plane, about {clip:.3}, {to_far}")
            }
            Buffer::Perspective => format!(
                "the value of a depth buffer, 0 at the near plane, about {near:.3}, {to_far}, or of clip space, −1 at \
                 about {clip:.3}"
            ),
        };
        format!("{buffer}: write distances in world units")
    }
}

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

/// A factor and an offset are printed with so many digits: less is none.
const NOTHING: f64 = 5e-5;

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
    let fits = [
        (Law::Perspective, &right_along_view[..]),
        (Law::Linear, &right_along_view[..]),
        (Law::Linear, right),
    ];
    let mut fits = fits
        .into_iter()
        .filter_map(|(law, right)| Some((Fit::of(law, right, test)?, right)));
    let found = fits.find(|(fit, right)| compared.explains(right, &fit.distances(test)))?;
    Some(found.0.in_words())
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

/// How values follow from distances.
#[derive(Clone, Copy)]
enum Law {
    /// `a + b / z`, as a perspective projection makes it.
    Perspective,
    /// `a + b z`.
    Linear,
}

/// The law nearest to the values of an image.
struct Fit {
    law: Law,
    a: f64,
    b: f64,
    /// The least and the largest value.
    values: [f64; 2],
}

impl Fit {
    /// The fit to `test`, given distances `right`: by least squares.
    fn of(law: Law, right: &[f32], test: &[f32]) -> Option<Fit> {
        let pairs = right.iter().zip(test);
        let pairs = pairs.filter(|(z, value)| z.is_finite() && value.is_finite());
        let pairs: Vec<[f64; 2]> = pairs.map(|(&z, &value)| [z.into(), value.into()]).collect();
        let range = |axis: usize| {
            let all = pairs.iter().map(|pair| pair[axis]);
            all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
                [at.min(low), at.max(high)]
            })
        };
        let [[near, far], values] = [0, 1].map(range);
        let of = |z: f64| match law {
            Law::Perspective => z.recip(),
            Law::Linear => z,
        };
        let count = pairs.len() as f64;
        let x_mean = pairs.iter().map(|[z, _]| of(*z)).sum::<f64>() / count;
        let y_mean = pairs.iter().map(|[_, value]| value).sum::<f64>() / count;
        let (mut xx, mut xy) = (0.0, 0.0);
        for [z, value] in pairs {
            let x = of(z) - x_mean;
            xx += x * x;
            xy += x * (value - y_mean);
        }
        let b = xy / xx;
        let fit = Fit {
            law,
            a: y_mean - b * x_mean,
            b,
            values,
        };
        let is_known = near > 0.0 && far > LEAST_SPREAD * near && b.is_finite();
        let is_possible = match law {
            Law::Perspective => fit.is_buffer(),
            Law::Linear => b > 0.0,
        };
        (is_known && is_possible).then_some(fit)
    }

    /// The value of the near plane: clip space goes below 0.
    fn lowest(&self) -> f64 {
        match self.law {
            Law::Perspective if self.values[0] < 0.0 => -1.0,
            _ => 0.0,
        }
    }

    /// True if the values go from those of the near plane to 1 at the far one, as depth buffers do.
    fn is_buffer(&self) -> bool {
        let [least, most] = self.values;
        let [near, far] = [self.lowest(), 1.0].map(|value| self.distance(value));
        near >= 0.0 && far > near && least >= self.lowest() && most <= 1.0
    }

    fn distance(&self, value: f64) -> f64 {
        match self.law {
            Law::Perspective => self.b / (value - self.a),
            Law::Linear => (value - self.a) / self.b,
        }
    }

    fn distances(&self, test: &[f32]) -> Vec<f32> {
        let of = |value: &f32| self.distance(f64::from(*value)) as f32;
        test.iter().map(of).collect()
    }

    fn in_words(&self) -> String {
        let (a, b) = (self.a, self.b);
        let [clip, near, far] = [-1.0, 0.0, 1.0].map(|value| self.distance(value));
        let to_far = format!("and 1 at the far one, about {far:.3}");
        let what = match self.law {
            Law::Linear if self.is_buffer() => {
                format!("a share of the way, 0 at the near plane, about {near:.3}, {to_far}")
            }
            Law::Linear if a.abs() < NOTHING * b => format!("{b:.4} times the right depth"),
            Law::Linear if (b - 1.0).abs() < NOTHING => {
                let depth = format!("the right depth {a:+.4}: count from the eye");
                return depth.replace('-', "−");
            }
            Law::Linear => format!("{b:.4} times the right depth, {a:+.4}").replace('-', "−"),
            Law::Perspective if self.lowest() < 0.0 => {
                format!("the depth of clip space, −1 at the near plane, about {clip:.3}, {to_far}")
            }
            Law::Perspective => format!(
                "the value of a depth buffer, 0 at the near plane, about {near:.3}, {to_far}, or of clip space, −1 at \
                 about {clip:.3}"
            ),
        };
        format!("{what}: write distances in world units")
    }
}

//! Depth of another renderer's image, and the cause of one that is wrong.

use super::measured::{add, line as weighted_line};
use crate::compare::depth::DepthDifference;
use crate::film::Depth;
use crate::render;
use crate::scene::Scene;

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

/// Distances must be spread this much, as the farthest over the nearest, for a line through them to be known.
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
    let laws = [
        (right, false),
        (&right_along_view[..], false),
        (&right_along_view[..], true),
    ];
    let lines = laws.into_iter().enumerate();
    let lines = lines.filter_map(|(law, (right, is_inverse))| {
        Some((law, line(compared, right, test, is_inverse)?))
    });
    let (law, (_, [a, b])) = lines.min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0))?;
    let said = match law {
        0 => format!("{b:.4} times the right depth, {a:+.4}"),
        1 => format!("{b:.4} times the distance along the view, {a:+.4}"),
        _ => format!(
            "the value of a depth buffer, {a:.4} {b:+.4} / z of the distance z along the view"
        ),
    };
    Some(format!(
        "{said}: write distances from the eye, in world units"
    ))
}

/// The line `a + b x` through the values of `test`, where x is the depth in `right` or its inverse, by least squares, with
/// the mean distance of the depths that follow from it; if these explain all values.
fn line(
    compared: &DepthComparison<'_>,
    right: &[f32],
    test: &[f32],
    is_inverse: bool,
) -> Option<(f64, [f64; 2])> {
    let of = |z: f64| if is_inverse { z.recip() } else { z };
    let pairs = right
        .iter()
        .zip(test)
        .map(|(&z, &value)| [z, value].map(f64::from));
    let known = pairs.filter(|[z, value]| z.is_finite() && value.is_finite());
    let [mut near, mut far] = [f64::INFINITY, 0.0];
    let mut sums = [0.0; 5];
    for [z, value] in known {
        (near, far) = (near.min(z), f64::max(far, z));
        add(&mut sums, 1.0, [of(z), value]);
    }
    let [b, a] = weighted_line(sums);
    let distance = |value: &f32| of((f64::from(*value) - a) / b) as f32;
    let distances: Vec<f32> = test.iter().map(distance).collect();
    let is_known = near > 0.0 && far > LEAST_SPREAD * near && (b > 0.0 || is_inverse);
    let found = compared.of(right, &distances);
    let explains = found.shows_depth() && found.outside == 0;
    (is_known && explains).then_some((found.mean, [a, b]))
}

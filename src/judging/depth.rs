//! Depth of another renderer's image, and the cause of one that is wrong.

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
        let mut depths = render::depth(self.scene, depth)?;
        for (depth, &opacity) in depths.iter_mut().zip(self.opacity.unwrap_or_default()) {
            if opacity < FAINTEST {
                *depth = f32::INFINITY;
            }
        }
        Ok(depths)
    }

    /// Difference of `test` from `right`.
    pub fn of(&self, right: &[f32], test: &[f32]) -> DepthDifference {
        DepthDifference::of(right, test, self.width, self.step)
    }
}

/// Names the other definition of depth that `test` matches in place of the one `asked` for, if any.
pub(super) fn cause(compared: &DepthComparison<'_>, asked: Depth, test: &[f32]) -> Option<String> {
    let others = Depth::ALL.into_iter().map(|(_, other)| other);
    let others = others.filter(|&other| other != asked).filter_map(|other| {
        let found = compared.of(&compared.right(other).ok()?, test);
        (found.shows_depth() && found.agrees()).then_some((found.mean, other))
    });
    let (_, other) = others.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    Some(format!(
        "the {other} depth, but the case asks for the {asked} one"
    ))
}

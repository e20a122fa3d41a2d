//! Depth of images: distances of what pixels show.
//!
//! Renderers place a sample at the beginning, in the middle or at the end of its step, so that depth may be half a
//! step off. A half float rounds by 2⁻¹¹: the gate allows 0.1 % on top. At an edge of what is seen, where the depths of
//! neighbouring pixels are farther apart than that, a ray may fall on either side: any depth between those of the
//! neighbours agrees there.

use super::around;
use super::deterministic::OUTLIERS;
use super::gate::Metric;

/// Where depth is compared.
pub(crate) const OUTLIERS_OF_DEPTH: Metric = (
    "outlier_depths",
    "Pixels whose depth is off by more than half a step and 0.1 %; where depth is compared.",
);

/// Relative tolerance of a depth.
const RELATIVE: f64 = 1e-3;

/// Neighbours whose depths are this many tolerances apart lie at an edge: two that are right may be two apart.
const AT_AN_EDGE: f64 = 4.0;

/// Comparison of the depths of two images of one size.
#[derive(Default)]
pub(crate) struct DepthDifference {
    /// Pixels outside the tolerance.
    pub outside: usize,
    /// Pixels that have a depth.
    pub seen: usize,
    /// Pixels at edges that agree without a depth in the image.
    pub without: usize,
    /// Mean distance from the right depth, of pixels that have both.
    pub mean: f64,
    /// The worst of them: its index, its depth and the right one.
    pub worst: Option<(usize, f32, f32)>,
}

impl DepthDifference {
    /// Compares `test` with `right`, rows of `width` pixels, whose samples are `step` apart. Pixels without a
    /// depth are not compared, but at edges: programs write 0, the far plane or infinity there.
    pub fn of(right: &[f32], test: &[f32], width: usize, step: f64) -> DepthDifference {
        let mut found = DepthDifference::default();
        let height = right.len() / width;
        let (mut most, mut sum, mut both) = (0.0, 0.0, 0_usize);
        for (index, &at) in right.iter().enumerate().filter(|(_, at)| at.is_finite()) {
            found.seen += 1;
            let (mut near, mut far, mut ends) = (at, at, false);
            for other in around(index, [width, height], 1) {
                let depth = right[other];
                ends |= !depth.is_finite();
                if depth.is_finite() {
                    (near, far) = (near.min(depth), far.max(depth));
                }
            }
            let tolerance = 0.5 * step + RELATIVE * f64::from(at);
            let is_edge = ends || f64::from(far) - f64::from(near) > AT_AN_EDGE * tolerance;
            let [low, high] = if is_edge { [near, far] } else { [at, at] };
            let depth = f64::from(test[index]);
            if depth.is_finite() {
                sum += (depth - f64::from(at)).abs();
                both += 1;
            }
            let off = (f64::from(low) - depth).max(depth - f64::from(high));
            // NaN is off, too.
            if off <= tolerance {
                continue;
            }
            if ends && (!depth.is_finite() || depth <= 0.0) {
                found.without += 1;
            } else {
                found.outside += 1;
                let excess = if off.is_nan() {
                    f64::INFINITY
                } else {
                    off / tolerance
                };
                if found.worst.is_none() || excess > most {
                    (most, found.worst) = (excess, Some((index, test[index], at)));
                }
            }
        }
        found.mean = sum / both.max(1) as f64;
        found
    }

    /// True if no more pixels are off than rays that graze an edge.
    pub fn agrees(&self) -> bool {
        self.outside as f64 <= OUTLIERS * self.seen as f64
    }

    /// True if most pixels have a depth in the image, too.
    pub(crate) fn shows_depth(&self) -> bool {
        2 * self.without < self.seen
    }

    /// The difference as a sentence, of an image of this `width`.
    pub fn in_words(&self, width: usize) -> String {
        let worst = self.worst.map(|(index, depth, right)| {
            let [column, row] = [index % width, index / width];
            format!(". The worst is ({column}, {row}), at {depth:.4} in place of {right:.4}")
        });
        format!(
            "the depth of {} of {} pixels that have one ({:.3} %) is off by more than half a step and 0.1 %{}",
            self.outside,
            self.seen,
            100.0 * self.outside as f64 / self.seen.max(1) as f64,
            worst.unwrap_or_default()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two planes at 2 and 3, side by side, and nothing beside them; steps of 0.1.
    fn planes() -> Vec<f32> {
        let of = |x: usize| match x {
            0..4 => 2.0,
            4..8 => 3.0,
            _ => f32::INFINITY,
        };
        (0..12 * 12).map(|index| of(index % 12)).collect()
    }

    fn outside(edit: impl Fn(usize, f32) -> f32) -> usize {
        let test = planes();
        let test: Vec<f32> = test
            .iter()
            .enumerate()
            .map(|(i, &at)| edit(i % 12, at))
            .collect();
        DepthDifference::of(&planes(), &test, 12, 0.1).outside
    }

    #[test]
    fn half_a_step_agrees_and_a_whole_one_does_not() {
        assert_eq!(outside(|_, at| at + 0.05), 0);
        assert_eq!(outside(|_, at| at - 0.05), 0);
        // All but the columns at the edges, where the other plane is nearer or farther.
        assert_eq!(outside(|_, at| at + 0.1), 12 * 7);
    }

    #[test]
    fn an_edge_may_fall_on_either_side() {
        assert_eq!(outside(|x, at| if x == 3 { 3.0 } else { at }), 0);
        assert_eq!(outside(|x, at| if x == 7 { 0.0 } else { at }), 0);
        assert_eq!(outside(|x, at| if x == 2 { 3.0 } else { at }), 12);
        assert_eq!(outside(|x, at| if x == 5 { f32::NAN } else { at }), 12);
        assert_eq!(outside(|x, at| if x == 9 { 7.0 } else { at }), 0);
    }
}

//! The deterministic gate: linear radiance of two renderings without noise.
//!
//! A pixel agrees if every channel does: `|test − golden| ≤ 1e-3 + 1 % of golden`. All but
//! 0.02 % of the pixels must agree, none may be far off, and the differences must not add up.
//! Opacity, where both images have it, is judged likewise (`opacity.rs`).
//! Structural and mean-pooled metrics are no substitute: of sixteen seeded faults they caught
//! between one and twelve, this rule all.

use super::gate::{Conditions, Description, Gate, MEAN_DIFFERENCES, Metric, metrics};
use super::judgement::Judgement;
use super::opacity;
use super::outliers::Outliers;
use crate::film::{CHANNELS, Film};
use crate::math::Sum;

/// Absolute tolerance of a channel.
pub(crate) const ABSOLUTE: f64 = 1e-3;
/// Relative tolerance of a channel.
pub(crate) const RELATIVE: f64 = 0.01;
/// Share of pixels that may lie outside: rays that graze a voxel face and fall, by a rounding,
/// on its other side.
pub(crate) const OUTLIERS: f64 = 2e-4;
/// The same share of a renderer in single precision. Over a hundred
/// steps a node coordinate of a hundred gathers roundings of some 4·10⁻⁵; of thirty visible samples
/// of a ray, each with three coordinates, one is on the other side of a face in six rays of a
/// thousand, and shows in a sixth of them. A sample at the back face is on its other side as rarely.
const OUTLIERS_OF_SINGLE_PRECISION: f64 = 1e-3;
/// No pixel may be further off than this many tolerances. One sample moved to the neighbouring
/// voxel changes a pixel by at most its own opacity, about a fifth in the scenes of the suite.
pub(crate) const HARD_CAP: f64 = 20.0;
/// The same in single precision: the nearest node may be an opaque one, or not.
const HARD_CAP_OF_SINGLE_PRECISION: f64 = 100.0;
/// The mean of a channel may be off by this share of the tolerance of a pixel of that value.
/// Roundings have both signs and average out; what is left at a tenth is systematic.
pub(super) const BIAS: f64 = 0.1;

/// Pixels that an image that agrees with this one in all but [`OUTLIERS`] cannot bring within the limit.
pub(crate) const FAR_SHARE: Metric = (
    "far_share",
    "Pixels that are off by more than twice what they may be, as a fraction of all pixels.",
);

/// Where opacity is compared.
pub(crate) const OUTLIERS_OF_OPACITY: Metric = (
    "outlier_opacities",
    "Pixels whose opacity is off by more than the tolerance; where opacity is compared.",
);

pub(super) const DESCRIPTION: Description = Description {
    name: "deterministic",
    rule: "Neither image has noise. A pixel agrees if each channel is within 0.001 plus 1 % of the \
         golden: that is one tolerance. At most 0.02 % of the pixels may disagree (rays that graze \
         an edge), none by more than 20 tolerances, and the mean of a channel may be off by a tenth \
         of a tolerance. Opacity, where \
         both images have it, is one more channel; 1 or 0 everywhere counts only in cases that ask for opacity.",
    metrics: &metrics! {
        "outlier_pixels" => "Pixels that are off by more than the tolerance.";
        "outlier_share" => "The same as a fraction of all pixels; at most 0.0002 are allowed.";
        FAR_SHARE;
        "max_abs_error" => "Largest difference of any channel, in radiance.";
        "worst_in_tolerances" =>
            "Difference of the worst pixel in tolerances; above 1 the pixel disagrees, above 20 the image fails.";
        "worst_column" => "Column of the worst pixel, from the left, from 0.";
        "worst_row" => "Row of the worst pixel, from the top, from 0.";
        MEAN_DIFFERENCES[0];
        MEAN_DIFFERENCES[1];
        MEAN_DIFFERENCES[2];
        OUTLIERS_OF_OPACITY;
        "mean_difference_opacity" => "Mean of test minus golden: above 0, the volume is too opaque.";
    },
    default_for: Some("two linear images without variance"),
};

/// Tolerance of a channel that is `golden` in the right image.
pub fn tolerance(golden: f64) -> f64 {
    ABSOLUTE + RELATIVE * golden.abs()
}

/// Tolerance of the mean of a channel over an image, where it is `golden` in the right one.
pub(crate) fn tolerance_of_mean(golden: f64) -> f64 {
    BIAS * tolerance(golden)
}

/// Difference of a pixel in tolerances: that of its worst channel.
pub(crate) fn in_tolerances(golden: [f32; 3], test: [f32; 3]) -> f64 {
    let channels = golden.into_iter().zip(test);
    channels.fold(0.0, |worst: f64, (golden, test)| {
        let [golden, test] = [golden, test].map(f64::from);
        worst.max((test - golden).abs() / tolerance(golden))
    })
}

/// The pixels of `test`, in tolerances of `golden`.
pub(crate) fn outliers(golden: &Film, test: &Film) -> Outliers {
    let pixels = golden.radiance().iter().zip(test.radiance());
    Outliers::of(pixels.map(|(golden, test)| in_tolerances(*golden, *test)))
}

/// Judges `test` by `reference`, both of one size and finite. Opacity counts, if it is the same everywhere, only where it
/// is asked for.
///
/// A quantised image is judged by the nearest of those that round to it. A correct renderer is within its own small
/// errors of the reference, so the mean needs no allowance for roundings that do not average out, as in an image of
/// one colour.
pub(super) fn judge(reference: &Film, test: &Film, conditions: &Conditions<'_>) -> Judgement {
    let (outliers, cap) = match conditions.in_single_precision {
        true => (OUTLIERS_OF_SINGLE_PRECISION, HARD_CAP_OF_SINGLE_PRECISION),
        false => (OUTLIERS, HARD_CAP),
    };
    let allowed = match test.quantisation() {
        Some(of) if of.blended => "one and a half codes + 0.001 + 1 %",
        Some(_) => "half a code + 0.001 + 1 %",
        None => "0.001 + 1 %",
    };
    let colours = ColourDifference::between(reference, &test.nearest_to(reference));
    let opacity = opacity::difference(reference, test, conditions.opacity, tolerance);
    let fault = (colours.of_pixels(allowed, outliers, cap))
        .or_else(|| colours.of_means())
        .or_else(|| {
            (opacity.as_ref()?).in_words(reference.width(), outliers, cap, tolerance_of_mean)
        });
    let mut metrics = colours.metrics();
    if let Some(found) = opacity {
        metrics.push((OUTLIERS_OF_OPACITY.0, found.pixels.outside as f64));
        metrics.push(("mean_difference_opacity", found.mean));
    }
    let passed = fault.is_none();
    let reason = fault.unwrap_or_else(|| colours.in_words(allowed));
    Judgement::new(Gate::Deterministic, passed, reason, &metrics)
}

/// Differences of the colours of two films.
struct ColourDifference {
    /// In tolerances.
    pixels: Outliers,
    /// Largest difference of a channel, in radiance.
    largest: f64,
    /// Column and row of the worst pixel.
    worst_at: [usize; 2],
    /// Mean of the golden, by channel.
    means: [f64; 3],
    /// Mean of test minus golden, by channel.
    bias: [f64; 3],
}

impl ColourDifference {
    fn between(golden: &Film, test: &Film) -> ColourDifference {
        let pairs = || golden.radiance().iter().zip(test.radiance());
        let pixels = outliers(golden, test);
        let mean = |of: fn(f64, f64) -> f64| -> [f64; 3] {
            std::array::from_fn(|c| {
                let sum: Sum = pairs().map(|(a, b)| of(a[c].into(), b[c].into())).collect();
                sum.value() / pixels.count as f64
            })
        };
        let differences =
            pairs().flat_map(|(a, b)| [0, 1, 2].map(|c| (f64::from(b[c]) - f64::from(a[c])).abs()));
        let (worst, width) = (pixels.worst.0, golden.width());
        ColourDifference {
            largest: differences.fold(0.0, f64::max),
            worst_at: [worst % width, worst / width],
            means: mean(|golden, _| golden),
            bias: mean(|golden, test| test - golden),
            pixels,
        }
    }

    /// Sentence on the pixels, if too many or one of them are off by more than is `allowed`.
    fn of_pixels(&self, allowed: &str, outliers: f64, cap: f64) -> Option<String> {
        let Outliers { outside, count, .. } = self.pixels;
        let share = self.pixels.share();
        let ([column, row], worst) = (self.worst_at, self.pixels.worst.1);
        if share > outliers {
            Some(format!(
                "{outside} of {count} pixels ({:.3} %) differ by more than {allowed}; at most {:.2} % \
                 may. The worst is ({column}, {row}), {worst:.1} times the tolerance",
                100.0 * share,
                100.0 * outliers
            ))
        } else if worst > cap {
            Some(format!(
                "pixel ({column}, {row}) is off by {worst:.1} times the tolerance of {allowed}; no \
                 pixel may be off by more than {cap}"
            ))
        } else {
            None
        }
    }

    /// Sentence on the channel whose mean is farthest off, if it is by more than is allowed.
    fn of_means(&self) -> Option<String> {
        let excess = |c: &usize| (self.bias[*c] / tolerance_of_mean(self.means[*c])).abs();
        let channel = (0..3).max_by(|a, b| excess(a).total_cmp(&excess(b)))?;
        let bias = self.bias[channel];
        (excess(&channel) > 1.0).then(|| {
            format!(
                "the pixels are close, but {} is too {} on the whole: its mean is off by {bias:.3e}, {:.1} times what is allowed",
                CHANNELS[channel],
                if bias > 0.0 { "bright" } else { "dark" },
                excess(&channel)
            )
        })
    }

    /// Sentence where all is well.
    fn in_words(&self, allowed: &str) -> String {
        format!(
            "{} of {} pixels differ by more than {allowed}; the largest difference is {:.3e}",
            self.pixels.outside, self.pixels.count, self.largest
        )
    }

    fn metrics(&self) -> Vec<(&'static str, f64)> {
        let mut metrics = vec![
            ("outlier_pixels", self.pixels.outside as f64),
            ("outlier_share", self.pixels.share()),
            (FAR_SHARE.0, self.pixels.far_share()),
            ("max_abs_error", self.largest),
            ("worst_in_tolerances", self.pixels.worst.1),
            ("worst_column", self.worst_at[0] as f64),
            ("worst_row", self.worst_at[1] as f64),
        ];
        metrics.extend((0..3).map(|c| (MEAN_DIFFERENCES[c].0, self.bias[c])));
        metrics
    }
}

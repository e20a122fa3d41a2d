//! The deterministic gate: linear radiance of two renderings without noise.
//!
//! A pixel agrees if every channel does: `|test − golden| ≤ 1e-3 + 1 % of golden`. All but
//! 0.02 % of the pixels must agree, none may be far off, and the differences must not add up.
//! Opacity is not judged: renderers differ in what they write there.
//! Structural and mean-pooled metrics are no substitute: of sixteen seeded faults they caught
//! between one and twelve, this rule all.

use super::{Gate, Judgement};
use crate::film::Film;
use crate::math::Sum;

/// Absolute part of the tolerance of a channel.
pub const ABSOLUTE: f64 = 1e-3;
/// Relative part.
pub const RELATIVE: f64 = 0.01;
/// Share of pixels that may lie outside: rays that graze a voxel face and fall, by a rounding,
/// on its other side.
const OUTLIERS: f64 = 2e-4;
/// No pixel may be further off than this many tolerances. One sample moved to the neighbouring
/// voxel changes a pixel by at most its own opacity, about a fifth in the scenes of the suite.
const HARD_CAP: f64 = 20.0;
/// The mean of a channel may be off by this share of the tolerance of a pixel of that value.
/// Roundings have both signs and average out; what is left at a tenth is systematic.
const BIAS: f64 = 0.1;

fn tolerance(golden: f64) -> f64 {
    ABSOLUTE + RELATIVE * golden.abs()
}

/// Judges `test` by `reference`; both of one size and finite.
pub(super) fn judge(reference: &Film, test: &Film) -> Judgement {
    let count = reference.radiance().len();
    let mut outside = 0_usize;
    let mut largest = 0.0_f64;
    let mut worst = (0, 0.0_f64);
    let mut sums = [Sum::default(); 3];
    let mut differences = [Sum::default(); 3];
    for (index, (golden, test)) in reference.radiance().iter().zip(test.radiance()).enumerate() {
        let mut excess = 0.0_f64;
        for c in 0..3 {
            let (golden, test) = (f64::from(golden[c]), f64::from(test[c]));
            let difference = test - golden;
            excess = excess.max(difference.abs() / tolerance(golden));
            largest = largest.max(difference.abs());
            sums[c].add(golden);
            differences[c].add(difference);
        }
        outside += usize::from(excess > 1.0);
        if excess > worst.1 {
            worst = (index, excess);
        }
    }
    let mean = |sum: Sum| sum.value() / count as f64;
    let bias: [f64; 3] =
        std::array::from_fn(|c| mean(differences[c]) / (BIAS * tolerance(mean(sums[c]))));
    let worst_bias = (0..3)
        .max_by(|&a, &b| bias[a].abs().total_cmp(&bias[b].abs()))
        .unwrap_or(0);
    let share = outside as f64 / count as f64;
    let [column, row] = [worst.0 % reference.width(), worst.0 / reference.width()];

    let (passed, reason) = if share > OUTLIERS {
        let reason = format!(
            "{outside} of {count} pixels ({:.3} %) are off by more than 0.001 + 1 %; at most \
             0.02 % may be. The worst is ({column}, {row}), {:.1} times the tolerance",
            100.0 * share,
            worst.1
        );
        (false, reason)
    } else if worst.1 > HARD_CAP {
        let reason = format!(
            "pixel ({column}, {row}) is off by {:.1} times the tolerance of 0.001 + 1 %; no \
             pixel may be off by more than {HARD_CAP}",
            worst.1
        );
        (false, reason)
    } else if bias[worst_bias].abs() > 1.0 {
        let reason = format!(
            "every pixel is close, but {} is too {} on the whole: its mean is off by {:.3e}, \
             {:.1} times what is allowed",
            ["red", "green", "blue"][worst_bias],
            if bias[worst_bias] > 0.0 {
                "bright"
            } else {
                "dark"
            },
            mean(differences[worst_bias]),
            bias[worst_bias].abs()
        );
        (false, reason)
    } else {
        let reason = format!(
            "{outside} of {count} pixels are outside 0.001 + 1 %; the largest difference is \
             {largest:.3e}"
        );
        (true, reason)
    };
    let metrics = [
        ("outlier_pixels", outside as f64),
        ("outlier_share", share),
        ("max_abs_error", largest),
        ("worst_in_tolerances", worst.1),
        ("worst_column", column as f64),
        ("worst_row", row as f64),
        ("mean_difference_red", mean(differences[0])),
        ("mean_difference_green", mean(differences[1])),
        ("mean_difference_blue", mean(differences[2])),
    ];
    Judgement::new(Gate::Deterministic, passed, reason, &metrics)
}

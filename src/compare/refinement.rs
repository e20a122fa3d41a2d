//! The gate for images that have a limit: those of a ray caster with smaller and smaller steps.
//!
//! The continuous integral along a ray has no step, and a renderer that samples the ray is right if
//! its images converge to it. A renderer makes images with steps `h`, `h/2`, `h/4`, …; of three
//! images in a row, with differences `D₁` and `D₂`, the order of the rule is `p = log₂(‖D₁‖/‖D₂‖)`,
//! and the limit `L = I₃ + (I₃ − I₂)/(2^p − 1)` (Richardson's extrapolation).
//!
//! A pixel agrees if the truth lies in the interval about `I₃` that the grid convergence index gives,
//! `1.25 |I₃ − I₂|/(2^p − 1)`, widened by one tolerance of the deterministic gate. Errors of pixels are
//! irregular in the step, where a ray leaves the volume in the middle of one; means over an image are
//! not: they are extrapolated, and must agree much better.
//!
//! The gate allows two things besides, which are no fault of the rule. Values may be off by half an entry of a table: the
//! caller renders what that changes. Rays may end where less than 1/255 of the light would still come through.
//!
//! The last step of a ray is cut off, and a rule of first order makes an error there that no order bounds. So with such a
//! rule a pixel may also be off by as much as images of first order are at the smallest step, which the caller renders.
//! A single image gives no order; it may deviate as much as images of those rules at its step.
//!
//! Sources: Richardson 1911, *Phil. Trans. A* 210, 307–357; Roache 1994, "Perspective: a method for
//! uniform reporting of grid refinement studies", *J. Fluids Eng.* 116, 405–413.

use super::advice::Undecided;
use super::around;
use super::deterministic::{BIAS, FAR_SHARE, OUTLIERS, outliers, tolerance};
use super::gate::{Description, Gate, MEAN_DIFFERENCES, metrics};
use super::incomparable;
use super::judgement::Judgement;
use super::outliers::Outliers;
use crate::film::{CHANNELS, Film};
use crate::math::{Sum, exp2, log2};

/// Safety factor of the grid convergence index, where the order is observed (Roache 1994).
const SAFETY: f64 = 1.25;

/// Root mean square difference of two images, in tolerances, below which the step no longer
/// matters: at first order as much is left to the limit, a third of what a pixel may be off by.
const STILL: f64 = 0.3;

/// Orders between which an observed one is used for extrapolation. Below a half, images do not
/// converge: even steps at random places, with errors as the root of the step, do better. No rule
/// that ray casters use has more than two, and where a higher one is observed by chance, it would
/// make the interval too small.
const ORDERS: [f64; 2] = [0.5, 2.0];

/// Order below which a rule is taken to be of first order, and not of second. The error of such a rule
/// may be a sawtooth in the step: a last step counted as a whole one is off by the part of it that lies
/// beyond the back face, anything between nothing and a step, whatever it was at twice the step. What
/// three images differ by does not bound that in every pixel; the images of such rules at the smallest
/// step do. Means over the image are not allowed it: of a sawtooth in many pixels they converge.
const HALFWAY: f64 = 1.5;

/// The extrapolated mean of a channel may be off by this share of its own correction, beside what the
/// deterministic gate allows. The order of the means may be off by a half. The factor 1/(2^p − 1) is then off by up to
/// 1 − (2^1 − 1)/(2^1.5 − 1) = 45 % at p = 1, and by less at p = 2.
const OF_THE_CORRECTION: f64 = 0.5;

/// Transmittance at which a renderer for displays of 8 bits may end a ray: what is behind, at most
/// this share of the brightest radiance, is no level of the display.
const LAST_LEVEL: f64 = 1.0 / 255.0;

/// Widest interval, relative to the mean of the truth, that decides: otherwise a renderer with
/// another integrand would pass, too.
const WIDEST: f64 = 0.02;

pub(super) const DESCRIPTION: Description = Description {
    name: "refinement",
    rule: "The golden is the continuous integral, without steps. Images with steps h, h/2 and h/4 must \
         converge to it: the order follows from their differences, the limit from the order. A pixel \
         agrees if the golden is within 1.25 times the estimated error of the finest image, plus 0.001, \
         plus 1 % of the golden; at most 0.02 % of the pixels may disagree. The extrapolated mean of a \
         channel may be off by a tenth of 0.001 + 1 % and by half of its correction. A single image must \
         be within what samples at the beginning or at the end of each step would be off by.",
    metrics: &metrics! {
        "observed_order" =>
            "Order of convergence: 1 where half the step halves the error, 2 where it quarters it.";
        "error_at_step" =>
            "Root mean square error of the image at the step asked for, relative to that of the golden's radiance.";
        "error_at_finest_step" => "The same of the image with the smallest step.";
        "error_of_limit" => "The same of the limit to which the images are extrapolated.";
        "error_allowed" =>
            "Mean of what a pixel may be off by because of the step, relative to the mean of the golden; above 0.02 nothing is decided.";
        "pixels_off_limit" => "Pixels whose interval does not hold the golden.";
        "share_off_limit" => "The same as a fraction of all pixels; at most 0.0002 are allowed.";
        FAR_SHARE;
        "worst_off_limit" => "The distance of the worst pixel from the golden, in what it may be off by.";
        "worst_column" => "Column of the worst pixel, from the left, from 0.";
        "worst_row" => "Row of the worst pixel, from the top, from 0.";
        MEAN_DIFFERENCES[0];
        MEAN_DIFFERENCES[1];
        MEAN_DIFFERENCES[2];
    },
    default_for: None,
};

/// Judges `images`, with steps h, h/2, h/4 and so on, by the limit of the last three and by
/// `first_order`: images that rules of first order give at the smallest step. The golden has no steps; `looked_up` are
/// its images from values that are off as much as by look-up in a table, up and down. Codes of 8 bits hide what steps
/// change: none of the images is quantised.
///
/// # Panics
///
/// With fewer than three images.
pub(crate) fn judge_refinement(
    golden: &Film,
    looked_up: &[Film],
    first_order: &dyn Fn() -> Vec<Film>,
    images: &[Film],
) -> Judgement {
    let [.., coarse, middle, fine] = images else {
        panic!("a sequence has three images");
    };
    for image in images {
        if let Some(difference) = incomparable::films(Gate::Refinement, golden, image) {
            return difference;
        }
    }
    let changes = [[coarse, middle], [middle, fine]].map(|[a, b]| in_rms_tolerances(golden, a, b));
    let observed = log2(changes[0] / changes[1]);
    let [least, most] = ORDERS;
    let agrees = || outliers(golden, &fine.nearest_to(golden)).share() <= OUTLIERS;
    let is_still = changes[1] <= STILL || observed < least && agrees();
    // Images that no longer change, or agree though they do, are left as they are.
    let order = if is_still { 1.0 } else { observed };
    let order = order.clamp(least, most);
    let factor = 1.0 / (exp2(order) - 1.0);
    let limit = if is_still {
        fine.clone()
    } else {
        extrapolated(middle, fine, factor)
    };

    let errors = [&images[0], fine, &limit].map(|image| relative_error(golden, image));
    let [at_step, at_finest, left] = errors;
    let mut metrics = vec![
        ("error_at_step", at_step),
        ("error_at_finest_step", at_finest),
        ("error_of_limit", left),
    ];
    if !is_still {
        metrics.push(("observed_order", observed));
    }

    let mut step_errors = step_errors(golden, [coarse, middle, fine], order, factor);
    if !is_still && order < HALFWAY {
        let of_first_order = LargestErrors::of(golden, &first_order());
        enlarge(&mut step_errors, &of_first_order.pixels);
    }
    let [finest, before] = [fine, middle].map(means);
    let share = if is_still { SAFETY } else { OF_THE_CORRECTION };
    let mean_errors = std::array::from_fn(|c| share * (factor * (finest[c] - before[c]).abs()));
    let changes_in_words = match is_still {
        true => "smaller steps change nothing".to_owned(),
        false => order_in_words(observed),
    };
    let steps = format!(
        "{:.2} % off at the step asked for; {changes_in_words}; extrapolated, {:.3} % off",
        100.0 * at_step,
        100.0 * left
    );
    if !is_still && observed < least {
        let reason = format!(
            "the images do not converge: they change by {:.2} tolerances between the last two steps but \
             one, and by {:.2} between the last two: are samples at random places, values rounded, faint samples dropped, or \
             opacities not corrected for the step? {steps}",
            changes[0], changes[1]
        );
        return Judgement::new(Gate::Refinement, false, reason, &metrics);
    }
    let judged = Judged {
        golden,
        image: fine,
        mean_of: &limit,
        step_errors,
        mean_errors,
        table: LargestErrors::of(golden, looked_up),
    };
    judged.judgement(metrics, &steps)
}

/// Errors that steps leave in the finest image: those between two images, where they converge with this `order`.
fn step_errors(
    golden: &Film,
    [coarse, middle, fine]: [&Film; 3],
    order: f64,
    factor: f64,
) -> Vec<[f64; 3]> {
    // The error of a pixel may be small by chance at one step, and seldom is at two.
    let mut errors = distances(middle, fine, SAFETY * factor);
    let of_coarse = distances(coarse, middle, SAFETY * factor * exp2(-order));
    enlarge(&mut errors, &of_coarse);
    largest_around(golden, &errors)
}

/// Raises each error to the other one, if that is larger.
fn enlarge(errors: &mut [[f64; 3]], others: &[[f64; 3]]) {
    for (errors, others) in errors.iter_mut().zip(others) {
        *errors = std::array::from_fn(|c| errors[c].max(others[c]));
    }
}

/// The largest errors of several images.
struct LargestErrors {
    /// Errors by pixel and channel, in radiance.
    pixels: Vec<[f64; 3]>,
    /// Errors of the means of the channels, in radiance.
    means: [f64; 3],
}

impl LargestErrors {
    fn of(golden: &Film, images: &[Film]) -> LargestErrors {
        let mut errors = LargestErrors {
            pixels: vec![[0.0; 3]; golden.radiance().len()],
            means: [0.0; 3],
        };
        let right = means(golden);
        for image in images {
            enlarge(&mut errors.pixels, &distances(golden, image, 1.0));
            let off = means(image);
            errors.means = std::array::from_fn(|c| errors.means[c].max((off[c] - right[c]).abs()));
        }
        errors
    }
}

/// Distances of the pixels of two images, times `factor`.
fn distances(a: &Film, b: &Film, factor: f64) -> Vec<[f64; 3]> {
    let pixels = a.radiance().iter().zip(b.radiance());
    let distance = |a: f32, b: f32| factor * (f64::from(a) - f64::from(b)).abs();
    pixels
        .map(|(a, b)| std::array::from_fn(|c| distance(a[c], b[c])))
        .collect()
}

/// Judges one image by `first_order`: images that rules of first order give at the same step.
pub(crate) fn judge_one_step(
    golden: &Film,
    looked_up: &[Film],
    first_order: &[Film],
    image: &Film,
) -> Judgement {
    let others = first_order.iter().chain([image]);
    for other in others {
        if let Some(difference) = incomparable::films(Gate::Refinement, golden, other) {
            return difference;
        }
    }
    let by_rules = LargestErrors::of(golden, first_order);
    let error = relative_error(golden, &image.nearest_to(golden));
    let steps = format!(
        "one image: {:.2} % off at its step, judged by what a rule of first order may be off by there; \
         images with half and a quarter of the step would say more",
        100.0 * error
    );
    let judged = Judged {
        golden,
        image,
        mean_of: image,
        step_errors: largest_around(golden, &by_rules.pixels),
        mean_errors: by_rules.means,
        table: LargestErrors::of(golden, looked_up),
    };
    judged.judgement(vec![("error_at_step", error)], &steps)
}

/// An image, and the error allowed for its step.
struct Judged<'f> {
    golden: &'f Film,
    image: &'f Film,
    /// The image whose means are judged.
    mean_of: &'f Film,
    /// Errors by pixel and channel, in radiance.
    step_errors: Vec<[f64; 3]>,
    /// Errors of the means of the channels, in radiance.
    mean_errors: [f64; 3],
    /// Errors by look-up in a table.
    table: LargestErrors,
}

impl Judged<'_> {
    fn judgement(&self, mut metrics: Vec<(&str, f64)>, steps: &str) -> Judgement {
        let golden = self.golden;
        let behind = behind_last_level(golden);
        // The nearest image that rounds to a quantised one.
        let nearest = self.image.nearest_to(golden);
        let pixels = golden.radiance().iter().zip(nearest.radiance());
        let pixels = Outliers::of(pixels.enumerate().map(|(index, (right, test))| {
            (0..3).fold(0.0_f64, |most, c| {
                let (right, test) = (f64::from(right[c]), f64::from(test[c]));
                let table = self.table.pixels[index][c];
                let allowed = tolerance(right) + self.step_errors[index][c] + table;
                let allowed = allowed + behind[index];
                most.max((test - right).abs() / allowed)
            })
        }));
        let (count, outside, share) = (pixels.count, pixels.outside, pixels.share());
        let (at, worst) = pixels.worst;
        let [column, row] = [at % golden.width(), at / golden.width()];
        let [right, test] = [&self.cut_off(), self.mean_of].map(means);
        let quantisation = self.image.quantisation();
        let half_code = |mean: f64| quantisation.map_or(0.0, |it| it.half_code(mean));
        let behind = behind.iter().sum::<f64>() / count as f64;
        let off: [f64; 3] = std::array::from_fn(|c| test[c] - right[c]);
        let bias: [f64; 3] = std::array::from_fn(|c| {
            let allowed = BIAS * tolerance(right[c]) + self.mean_errors[c] + self.table.means[c];
            off[c].abs() / (allowed + behind + half_code(right[c]))
        });
        let widest = self.relative_width();
        metrics.extend([
            ("error_allowed", widest),
            ("pixels_off_limit", outside as f64),
            ("share_off_limit", share),
            (FAR_SHARE.0, pixels.far_share()),
            ("worst_off_limit", worst),
            ("worst_column", column as f64),
            ("worst_row", row as f64),
        ]);
        metrics.extend((0..3).map(|c| (MEAN_DIFFERENCES[c].0, off[c])));
        let most = (0..3)
            .max_by(|&a, &b| bias[a].total_cmp(&bias[b]))
            .unwrap_or(0);
        if share > OUTLIERS {
            let reason = format!(
                "{outside} of {count} pixels ({:.3} %) are off by more than their step explains, the worst, \
                 ({column}, {row}), by {worst:.1} times that; {steps}",
                100.0 * share
            );
            return Judgement::new(Gate::Refinement, false, reason, &metrics);
        }
        if bias[most] > 1.0 {
            let reason = format!(
                "the mean of {} is off by {:+.2} % where the step is taken out, {:.1} times what it may be; \
                 {steps}",
                CHANNELS[most],
                100.0 * off[most] / right[most].max(f64::MIN_POSITIVE),
                bias[most]
            );
            return Judgement::new(Gate::Refinement, false, reason, &metrics);
        }
        let mut judgement = Judgement::new(Gate::Refinement, true, steps.to_owned(), &metrics);
        if widest > WIDEST {
            let undecided = Undecided::Step(widest);
            judgement.reason.push_str(&format!("; {undecided}"));
            judgement.undecided = Some(undecided);
        }
        judgement
    }

    /// The golden, cut off where the image is.
    fn cut_off(&self) -> Film {
        let largest = self.image.quantisation().map(|it| it.largest() as f32);
        let pixels = self.golden.radiance().iter();
        let pixels =
            pixels.map(|pixel| pixel.map(|value| largest.map_or(value, |it| value.min(it))));
        Film::new(self.golden.width(), self.golden.height(), pixels.collect())
    }

    /// Mean of the allowed errors over that of the golden.
    fn relative_width(&self) -> f64 {
        let mut sums = [Sum::default(); 2];
        for (right, errors) in self.golden.radiance().iter().zip(&self.step_errors) {
            for c in 0..3 {
                sums[0].add(errors[c]);
                sums[1].add(f64::from(right[c]).abs());
            }
        }
        let [errors, right] = sums.map(|sum| sum.value());
        if errors == 0.0 { 0.0 } else { errors / right }
    }
}

/// Root mean square of the difference of two images, in tolerances of the golden.
fn in_rms_tolerances(golden: &Film, a: &Film, b: &Film) -> f64 {
    let values = [golden, a, b].map(|film| film.radiance().as_flattened().iter());
    let [golden, a, b] = values.map(|values| values.copied().map(f64::from));
    let ratios = golden
        .zip(a.zip(b))
        .map(|(right, (a, b))| (a - b) / tolerance(right));
    let squares: Vec<f64> = ratios.map(|ratio| ratio * ratio).collect();
    (squares.iter().copied().collect::<Sum>().value() / squares.len() as f64).sqrt()
}

/// Root of the sum of the squared differences, over that of the squares of the golden; in units of
/// 1 if the golden is black.
fn relative_error(golden: &Film, image: &Film) -> f64 {
    let mut sums = [Sum::default(); 2];
    let golden = golden.radiance().as_flattened();
    for (&right, &test) in golden.iter().zip(image.radiance().as_flattened()) {
        let (right, test) = (f64::from(right), f64::from(test));
        sums[0].add((test - right) * (test - right));
        sums[1].add(right * right);
    }
    let [off, right] = sums.map(|sum| sum.value());
    let unit = if right > 0.0 { right } else { 1.0 };
    (off / unit).sqrt()
}

/// `fine + factor (fine − before)`, not below 0.
fn extrapolated(before: &Film, fine: &Film, factor: f64) -> Film {
    let pixels = before.radiance().iter().zip(fine.radiance());
    let pixels = pixels.map(|(before, fine)| {
        std::array::from_fn(|c| {
            let (before, fine) = (f64::from(before[c]), f64::from(fine[c]));
            (fine + factor * (fine - before)).max(0.0) as f32
        })
    });
    Film::new(fine.width(), fine.height(), pixels.collect())
}

/// The largest of each channel in a pixel and its eight neighbours: where a ray leaves the volume just
/// at the end of a step, its error is small by chance.
fn largest_around(image: &Film, errors: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let size = [image.width(), image.height()];
    let largest = |index: usize| {
        around(index, size, 1).fold([0.0_f64; 3], |largest, near| {
            std::array::from_fn(|c| largest[c].max(errors[near][c]))
        })
    };
    (0..errors.len()).map(largest).collect()
}

/// Means of the channels.
fn means(image: &Film) -> [f64; 3] {
    let mut sums = [Sum::default(); 3];
    for pixel in image.radiance() {
        for c in 0..3 {
            sums[c].add(pixel[c].into());
        }
    }
    sums.map(|sum| sum.value() / image.radiance().len() as f64)
}

/// Light behind the last level of a display, at most, in pixels that are so opaque: a renderer
/// that ends rays there may lack it.
fn behind_last_level(golden: &Film) -> Vec<f64> {
    let most = LAST_LEVEL * golden.brightest();
    let behind = |index: usize| {
        let [.., opacity] = golden.pixel(index);
        let is_opaque = golden.opacity().is_some() && f64::from(opacity) > 1.0 - LAST_LEVEL;
        if is_opaque { most } else { 0.0 }
    };
    (0..golden.radiance().len()).map(behind).collect()
}

fn order_in_words(order: f64) -> String {
    match order {
        0.75..1.5 => "first order".to_owned(),
        1.5..2.5 => "second order".to_owned(),
        _ => format!("order {order:.1}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{exp, powu};

    const SIZE: usize = 24;

    fn film(value: impl Fn(f64, usize) -> f64) -> Film {
        let pixel = |index: usize| {
            let x = index as f64 / (SIZE * SIZE) as f64;
            std::array::from_fn(|c| value(x, c) as f32)
        };
        Film::new(SIZE, SIZE, (0..SIZE * SIZE).map(pixel).collect())
    }

    fn truth(x: f64, c: usize) -> f64 {
        0.2 + 0.5 * exp(-x) / (c + 1) as f64
    }

    /// Images of a rule whose error at step h is `error(x, h)`, relative, judged.
    fn sequence(error: impl Fn(f64, f64) -> f64) -> Judgement {
        let images: Vec<Film> = [1.0, 0.5, 0.25]
            .iter()
            .map(|&h| film(|x, c| truth(x, c) * (1.0 + error(x, h))))
            .collect();
        judge_refinement(&film(truth), &[], &Vec::new, &images)
    }

    #[test]
    fn rules_that_converge_pass_with_their_order() {
        for (order, words) in [(1_u32, "first order"), (2, "second order")] {
            let judgement = sequence(|x, h| 0.05 * (1.0 + x) * powu(h, order));
            assert!(judgement.passed, "{}", judgement.reason);
            assert!(judgement.reason.contains(words), "{}", judgement.reason);
            let observed = judgement.metrics["observed_order"];
            assert!((observed - f64::from(order)).abs() < 1e-4);
            // The limit of a plain power is exact, but for the rounding of pixels to 32 bits.
            assert!(judgement.metrics["error_of_limit"] < 1e-5);
        }
        let exact = sequence(|_, _| 0.0);
        assert!(exact.passed && exact.reason.contains("change nothing"));
    }

    /// An error that jumps from pixel to pixel, as that of a last step does.
    #[test]
    fn irregular_errors_pass() {
        let judgement = sequence(|x, h| 0.04 * h * (x * 577.0 / h).fract());
        assert!(judgement.passed, "{}", judgement.reason);
        assert_eq!(judgement.undecided, None);
    }

    #[test]
    fn another_limit_fails() {
        for bias in [0.02, -0.02, 0.01] {
            let judgement = sequence(|_, h| 0.01 * h * h + bias);
            assert!(!judgement.passed, "{bias}: {}", judgement.reason);
        }
        // In one pixel of a hundred.
        let judgement = sequence(|x, h| 0.01 * h + 0.1 * f64::from(x < 0.01));
        assert!(!judgement.passed, "{}", judgement.reason);
    }

    #[test]
    fn images_that_do_not_converge_fail() {
        let judgement = sequence(|x, h| 0.02 * (x * 577.0 / h).fract());
        assert!(!judgement.passed);
        assert!(judgement.reason.contains("do not converge"));
        // Each sample loses the same, and each step twice as many.
        let judgement = sequence(|_, h| 0.02 * h - 0.02 / h);
        assert!(!judgement.passed);
        assert!(judgement.reason.contains("do not converge"));
    }

    #[test]
    fn a_step_that_is_much_too_long_decides_nothing() {
        let judgement = sequence(|_, h| 0.3 * h);
        assert!(judgement.passed);
        assert!(matches!(judgement.undecided, Some(Undecided::Step(_))));
    }

    #[test]
    fn one_image_is_judged_by_first_order() {
        let golden = film(truth);
        let rules = [0.98, 1.02].map(|factor| film(|x, c| factor * truth(x, c)));
        let with =
            |factor: f64| judge_one_step(&golden, &[], &rules, &film(|x, c| factor * truth(x, c)));
        for factor in [0.985, 1.0, 1.018] {
            let judgement = with(factor);
            assert!(judgement.passed, "{factor}: {}", judgement.reason);
            assert!(judgement.reason.contains("one image"));
        }
        assert!(!with(1.04).passed);
        assert!(!with(0.96).passed);
    }
}

//! What a report says in words.

use crate::suite::{CaseResult, Likeness, Summary, Verdict};

/// The result of the suite in a sentence.
pub(super) fn headline(results: &[CaseResult], likely: &[Likeness]) -> String {
    let of = results.len();
    let summary = Summary::of(results);
    if of == 0 {
        return "Nothing was compared.".to_owned();
    }
    let undecided: Vec<_> = [
        (summary.inconclusive, "inconclusive"),
        (summary.missing, "missing"),
        (summary.error, "in error"),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, word)| format!("{count} {word}"))
    .collect();
    let rest = match undecided.is_empty() {
        true => String::new(),
        false => format!(" Not judged: {}.", undecided.join(", ")),
    };
    if summary.fail > 0 {
        let verb = if summary.fail == 1 { "fails" } else { "fail" };
        let cases = if of == 1 { "case" } else { "cases" };
        let guess = match likely.first() {
            None => ": it looks like no mistake that is known".to_owned(),
            Some(Likeness {
                mistake,
                explains,
                of,
                ..
            }) if explains == of => {
                format!(": it looks like “{mistake}”")
            }
            Some(Likeness {
                mistake,
                explains: 1,
                ..
            }) => {
                format!("; one of them looks like “{mistake}”")
            }
            Some(Likeness {
                mistake, explains, ..
            }) => {
                format!("; {explains} of them look like “{mistake}”")
            }
        };
        return format!("{} of {of} {cases} {verb}{guess}.{rest}", summary.fail);
    }
    match (summary.pass, of) {
        (0, _) => format!("No case could be judged.{rest}"),
        (1, 1) => "The case passes.".to_owned(),
        (pass, of) if pass == of => format!("All {of} cases pass."),
        (pass, of) => format!("No case fails, but only {pass} of {of} pass.{rest}"),
    }
}

/// A mark that tells verdicts apart without colour.
pub(super) fn symbol(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "✓",
        Verdict::Fail => "✗",
        Verdict::Inconclusive => "?",
        Verdict::Missing => "○",
        Verdict::Error => "!",
    }
}

/// How a gate judges. By name, as in JSON.
pub(super) fn gate(name: &str) -> &'static str {
    match name {
        "exact" => "Every bit of every pixel must be the same.",
        "deterministic" => {
            "Neither image has noise. A pixel agrees if each channel is within 0.001 plus 1 % of \
             the golden: that is one tolerance. At most 0.02 % of the pixels may disagree (rays \
             that graze an edge), none by more than 20 tolerances, and the mean of a channel may \
             be off by a tenth of a tolerance."
        }
        "perceptual" => {
            "The image has 8 bits, so only what an eye would see is judged: FLIP is 0 where \
             nothing differs and 1 where everything does."
        }
        "stochastic" => {
            "The pixels are means of random samples, so differences are measured in standard \
             errors: what noise alone explains. Noise stays below 3 standard errors nearly \
             always; the limits are set so that an honest renderer meets a false alarm once in a \
             million suites."
        }
        "analytic" => {
            "The answer is known beforehand, and how far from it a number may be follows from how \
             many roundings or samples it takes."
        }
        _ => "",
    }
}

/// What a number of a gate says. By name, as in JSON.
pub(super) fn number(name: &str) -> &'static str {
    match name {
        "error_of_tolerance" => {
            "Error against the answer that is known beforehand, as a share of what it may be: 0 is \
             exact, 1 the edge."
        }
        "outlier_pixels" => "Pixels that are off by more than the tolerance.",
        "outlier_share" => "The same as a share of all pixels; at most 0.0002 may be.",
        "max_abs_error" => "Largest difference of any channel, in radiance.",
        "worst_in_tolerances" => {
            "How many tolerances the worst pixel is off; above 1 it disagrees, above 20 the image \
             fails."
        }
        "worst_column" => "Column of the worst pixel, from the left, from 0.",
        "worst_row" => "Row of the worst pixel, from the top, from 0.",
        "mean_difference_red" => "Mean of test minus golden: above 0, red is too bright.",
        "mean_difference_green" => "Mean of test minus golden: above 0, green is too bright.",
        "mean_difference_blue" => "Mean of test minus golden: above 0, blue is too bright.",
        "moved_pixels" => "Pixels of which any bit of the colour differs.",
        "moved_opacities" => "Pixels of which any bit of the opacity differs.",
        "same_bits" => "1 if every bit is that of the reference's own quick rendering, else 0.",
        "flip_mean" => "Mean of FLIP; at most 0.06 passes.",
        "flip_weighted_p99" => {
            "FLIP that all but the worst hundredth of the error stays below; at most 0.065 passes."
        }
        "flip_max" => "FLIP of the worst pixel.",
        "blocks" => "Blocks of 8 × 8 pixels, times three channels, that were asked.",
        "rejected_blocks" => "Blocks and channels that differ beyond noise; 0 passes.",
        "worst_block_z" => {
            "Test minus golden of the worst block, in standard errors: above 0 it is too bright."
        }
        "worst_block_column" => "First column of the worst block.",
        "worst_block_row" => "First row of the worst block.",
        "mean_z_red" => "Mean of red over the image, test minus golden, in standard errors.",
        "mean_z_green" => "Mean of green over the image, test minus golden, in standard errors.",
        "mean_z_blue" => "Mean of blue over the image, test minus golden, in standard errors.",
        "smallest_visible_bias" => {
            "Detectable bias of the mean, as a share of the brightness of the image: a larger one is \
             rejected."
        }
        "smallest_visible_block_bias" => {
            "Detectable bias of nine blocks in ten, as a share of the brightness of the block: a larger \
             one is rejected."
        }
        "times_the_samples_that_would_decide" => {
            "Factor on the samples per pixel at which the required bias becomes detectable."
        }
        "samples_that_would_decide" => {
            "Samples per pixel, of all renderings together, at which it becomes detectable."
        }
        "far_pixels" => {
            "Single pixels off by more than 5 standard errors, in the channel with most; many mean \
             fireflies, or differences that cancel within blocks."
        }
        "contrary_pixels" => {
            "Pixels and channels that differ although neither image has any noise there."
        }
        "amount_of_noise" => {
            "Size of the differences against the noise that the images state, squared: 1 is \
             honest, far below 1 is an image that was smoothed or shares random numbers, far above \
             1 differs beyond noise."
        }
        "chi_square_probability" => {
            "How likely honest noise is to give an amount as odd as this; near 0 it is not noise."
        }
        "copied_pixels" => {
            "Pixels with noise that are exactly the golden's; two honest renderings share none."
        }
        "correlation_across" => {
            "How alike the differences of neighbours in a row are: 0 is honest; above 0.05 whole \
             regions are off, or the image was filtered or denoised, or its pixels share random \
             numbers."
        }
        "correlation_down" => "The same of neighbours in a column.",
        "non_finite_pixels" => "Pixels that hold NaN or infinity; none may.",
        _ => "",
    }
}

/// A number with four digits; whole ones as they are.
pub(super) fn digits(value: f64) -> String {
    if value == value.trunc() && value.abs() < 1e9 {
        return format!("{value:.0}").replace('-', "−");
    }
    let size = value.abs();
    let text = match size {
        _ if !(1e-3..1e6).contains(&size) => format!("{value:.3e}"),
        _ if size < 0.01 => format!("{value:.6}"),
        _ if size < 0.1 => format!("{value:.5}"),
        _ if size < 1.0 => format!("{value:.4}"),
        _ if size < 100.0 => format!("{value:.3}"),
        _ => format!("{value:.1}"),
    };
    text.replace('-', "−")
}

/// Bytes kept of a long output: of its beginning, and of its end, where the error usually is.
const OUTPUT_HEAD: usize = 4_000;
const OUTPUT_TAIL: usize = 16_000;

/// The output of a program, without its middle if it is long; says so there.
pub(super) fn shortened(output: &str) -> String {
    if output.len() <= OUTPUT_HEAD + OUTPUT_TAIL {
        return output.to_owned();
    }
    // At most three bytes on from the middle of a character.
    let boundary = |from: usize| {
        (from..)
            .find(|&at| output.is_char_boundary(at))
            .unwrap_or(from)
    };
    let head = &output[..boundary(OUTPUT_HEAD)];
    let tail = &output[boundary(output.len() - OUTPUT_TAIL)..];
    let cut = output.len() - head.len() - tail.len();
    format!("{head}\n\n[… {cut} bytes are left out here …]\n\n{tail}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::perceptual::{MOST_MEAN, MOST_P99};

    #[test]
    fn limits_are_those_of_the_gates() {
        assert!(number("flip_mean").contains(&format!("at most {MOST_MEAN} ")));
        assert!(number("flip_weighted_p99").contains(&format!("at most {MOST_P99} ")));
    }

    #[test]
    fn numbers_have_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-12.0, "−12"),
            (0.123_456, "0.1235"),
            (0.012_345_6, "0.01235"),
            (0.001_234_56, "0.001235"),
            (3.456_78, "3.457"),
            (1234.56, "1234.6"),
            (-1.234_56e-7, "−1.235e−7"),
            (1e9, "1.000e9"),
        ] {
            assert_eq!(digits(value), text);
        }
    }

    #[test]
    fn long_output_loses_its_middle() {
        assert_eq!(shortened("short"), "short");
        let long = "ö".repeat(20_000) + "the end";
        let kept = shortened(&long);
        assert!(kept.len() < 20_100 && kept.ends_with("the end") && kept.starts_with("öö"));
        assert!(kept.contains("bytes are left out here"), "{kept}");
    }
}

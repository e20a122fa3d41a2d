//! Precision of a test image of 8 bits: its recognition, and what it hides from a gate.

use super::Undecided;
use super::gate::{Gate, Metric};
use super::judgement::Judgement;
use crate::film::{Film, Quantisation};
use std::collections::BTreeMap;

/// The metric of images that are cut off at a largest code.
pub(super) const CUT_OFF: Metric = (
    "share_cut_off",
    "Share of the pixels that the 8 bits of the test image cut off, or may cut off where there is noise: \
     above 0.5 nothing is decided.",
);

/// Share of pixels cut off from which an image that passes decides nothing: most of it was not seen.
const MOST_CUT_OFF: f64 = 0.5;

/// `test` with its quantisation, if all its values are codes of 8 bits and those of `golden` are not: of an
/// image of few colours nothing can be said.
pub fn recognised(golden: &Film, test: Film, exposure: f64) -> Film {
    if test.quantisation().is_some() || !golden.is_comparable(&test) {
        return test;
    }
    let Some(found) = Quantisation::recognised(&test, exposure) else {
        return test;
    };
    let of_golden = Quantisation::recognised(golden, exposure);
    if of_golden.is_some_and(|it| it.encoding == found.encoding) {
        return test;
    }
    test.quantised(found)
}

impl Judgement {
    /// With the share of the pixels that the precision of `test` cuts off; undecided where those are most.
    pub(crate) fn with_precision_of(mut self, golden: &Film, test: &Film) -> Judgement {
        let Some(quantisation) = test.quantisation() else {
            return self;
        };
        if !golden.is_comparable(test) {
            return self;
        }
        let pixels = golden.radiance();
        let cut = pixels.iter().filter(|pixel| quantisation.cuts_off(**pixel));
        let share = cut.count() as f64 / pixels.len() as f64;
        // Where there is noise, the gate has counted them.
        let share = *self.metrics.entry(CUT_OFF.0.to_owned()).or_insert(share);
        if self.passed && self.undecided.is_none() && share > MOST_CUT_OFF {
            let undecided = Undecided::CutOff(share);
            self.reason.push_str(&format!("; {undecided}"));
            self.undecided = Some(undecided);
        }
        self
    }
}

/// Sentence on what the precision of `test`, an image judged by `gate` with these metrics, hides.
pub(crate) fn precision_in_words(
    gate: Gate,
    metrics: &BTreeMap<String, f64>,
    test: &Film,
) -> Option<String> {
    let quantisation = test.quantisation()?;
    let allowed = match gate {
        Gate::Deterministic | Gate::Refinement => "half a code + 0.001 + 1 %",
        _ => "half a code",
    };
    let mut text = format!("{quantisation}: differences below {allowed} are not seen");
    let share = metrics.get(CUT_OFF.0).copied().unwrap_or(0.0);
    if share > 0.0 {
        let (percent, largest) = (100.0 * share, quantisation.largest());
        text.push_str(&format!(
            "; {percent:.1} % of the pixels are cut off at {}, and not judged above that",
            (1e4 * largest).round() / 1e4
        ));
    }
    Some(text)
}

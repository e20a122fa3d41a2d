//! Comparison of two images.
//!
//! First, images that cannot be compared are rejected: different sizes, pixels that are not finite.
//! Then a gate: [exact](Exact), [deterministic](Deterministic), [perceptual](Perceptual) or
//! [stochastic](Stochastic), each in its own file with its limits and their reasons.

mod advice;
pub(crate) mod coarse;
pub mod depth;
pub mod deterministic;
mod difference_scale;
mod exact;
pub mod flip;
mod gate;
mod image_gate;
mod incomparable;
mod judgement;
mod margin;
pub(crate) mod opacity;
pub mod perceptual;
mod picture;
mod places;
mod precision;
mod promise;
mod refinement;
mod sensitivity;
pub mod significance;
pub mod stochastic;
pub(crate) mod unexplained;

pub use advice::{Advice, Undecided};
pub use deterministic::Deterministic;
pub use difference_scale::{BlockMap, DifferenceScale};
pub use exact::Exact;
pub use gate::Gate;
pub(crate) use gate::Metric;
pub use image_gate::{Conditions, ImageGate};
pub use judgement::{Detectable, Judgement, NumberChange};
pub use margin::Margin;
pub(crate) use margin::STANDARD_ERRORS;
pub use perceptual::Perceptual;
pub use picture::{Picture, PictureError};
pub(crate) use places::left;
pub use places::measured;
pub use precision::recognised;
pub(crate) use precision::{is_of_precision, precision_in_words};
pub use promise::Promise;
pub(crate) use refinement::{Limit, Refinement, judge_one_step, judge_refinement};
pub use sensitivity::Sensitivity;
pub(crate) use sensitivity::change_in_words;
pub use stochastic::Stochastic;

use crate::film::Film;
use depth::OUTLIERS_OF_DEPTH;
pub(crate) use incomparable::NON_FINITE;
use incomparable::{REFERENCE, TEST};
use precision::CUT_OFF;

/// Every gate for a pair of images. If several are the default for a pair, the first is used.
pub const GATES: [&dyn ImageGate; 4] = [&Exact, &Deterministic, &Perceptual, &Stochastic];

/// The gate called `name`.
///
/// # Errors
///
/// A message that lists the gates, if there is none of that name.
pub fn gate_named(name: &str) -> Result<&'static dyn ImageGate, String> {
    let found = GATES.into_iter().find(|gate| gate.name() == name);
    found.ok_or_else(|| {
        let names = GATES.map(Gate::name).join(", ");
        format!("unknown gate {name:?}; the gates are: {names}")
    })
}

/// The default gate for a pair, with the reason as the end of a sentence; empty if it is obvious.
pub(crate) fn default_gate(
    reference: &Picture,
    test: &Picture,
) -> (&'static dyn ImageGate, &'static str) {
    let mut claims = GATES
        .into_iter()
        .filter_map(|gate| Some((gate, gate.default_reason(reference, test)?)));
    claims.next().unwrap_or((&Deterministic, ""))
}

/// The pixels of an image of `width` × `height` that are at most `reach` rows and columns from one, with that one.
pub(crate) fn around(
    index: usize,
    [width, height]: [usize; 2],
    reach: usize,
) -> impl Iterator<Item = usize> {
    let near = |at: usize, count| at.saturating_sub(reach)..(at + reach + 1).min(count);
    let (rows, columns) = (near(index / width, height), near(index % width, width));
    rows.flat_map(move |row| columns.clone().map(move |column| column + width * row))
}

/// Images of one size, with finite pixels and variances: the gates compare no others.
pub(crate) fn are_comparable(reference: &Film, test: &Film) -> bool {
    incomparable::films(&Stochastic, reference, test).is_none()
}

/// Meaning of a metric of any gate.
pub fn metric_meaning(name: &str) -> Option<&'static str> {
    let images = GATES.into_iter().flat_map(Gate::metrics);
    let mut metrics = images.chain(Refinement.metrics());
    let found = metrics.find(|(known, _)| *known == name);
    let common = [&NON_FINITE, &CUT_OFF, &OUTLIERS_OF_DEPTH]
        .into_iter()
        .find(|(known, _)| *known == name);
    found.or(common).map(|&(_, meaning)| meaning)
}

/// Compares `test` with `reference`: first checks sizes and that all pixels are finite, then applies
/// the gate. Changes of the images on reading are part of the reason.
///
/// # Errors
///
/// If the gate cannot judge images of this kind: only the perceptual gate judges 8-bit images.
pub fn judge(
    gate: &'static dyn ImageGate,
    reference: &Picture,
    test: &Picture,
    conditions: &Conditions<'_>,
) -> Result<Judgement, PictureError> {
    let judgement = match incomparable::pictures(gate, reference, test) {
        Some(difference) => difference,
        None => gate.judge(reference, test, conditions)?,
    };
    let judgement = match (reference, test) {
        (Picture::Radiance(golden), Picture::Radiance(test)) => {
            judgement.with_precision_of(golden, test)
        }
        _ => judgement,
    };
    let named = [(REFERENCE, reference), (TEST, test)];
    Ok(named
        .into_iter()
        .fold(judgement, |judgement, (name, picture)| {
            match picture.radiance() {
                Some(film) => judgement.with_changes_of(name, film),
                None => judgement,
            }
        }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_gate_is_found_by_its_name_and_says_what_it_does() {
        for gate in GATES {
            assert_eq!(gate_named(gate.name()).unwrap().name(), gate.name());
            assert!(gate.rule().ends_with('.'), "{}", gate.name());
            for &(metric, meaning) in gate.metrics() {
                assert_eq!(metric_meaning(metric), Some(meaning), "{metric}");
            }
        }
        let message = gate_named("ssim").unwrap_err();
        assert!(message.contains("exact, deterministic, perceptual, stochastic"));
    }
}

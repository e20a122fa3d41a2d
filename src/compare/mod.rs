//! Comparison of two images.
//!
//! First, images that cannot be compared are rejected: different sizes, pixels that are not finite.
//! Then a [gate](Gate), each in its own file with its limits and their reasons.

mod advice;
pub(crate) mod coarse;
pub mod depth;
pub mod deterministic;
mod difference_scale;
mod exact;
pub mod flip;
mod gate;
mod incomparable;
mod judgement;
mod margin;
pub(crate) mod opacity;
mod outliers;
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
pub use difference_scale::{BlockMap, DifferenceScale};
pub(crate) use gate::Metric;
pub use gate::{Conditions, Description, Gate};
pub use judgement::{Detectable, Judgement, NumberChange};
pub use margin::Margin;
pub(crate) use margin::STANDARD_ERRORS;
pub use picture::{Picture, PictureError};
pub(crate) use places::left;
pub use places::measured;
pub(crate) use precision::precision_in_words;
pub use precision::recognised;
pub use promise::Promise;
pub(crate) use refinement::{judge_one_step, judge_refinement};
pub use sensitivity::Sensitivity;
pub(crate) use sensitivity::change_in_words;

use crate::film::Film;
use depth::OUTLIERS_OF_DEPTH;
pub(crate) use incomparable::NON_FINITE;
use incomparable::{REFERENCE, TEST};
use precision::CUT_OFF;

impl Gate {
    /// Its name, its rule and its metrics, for reports and help.
    pub fn description(self) -> &'static Description {
        match self {
            Gate::Exact => &exact::DESCRIPTION,
            Gate::Deterministic => &deterministic::DESCRIPTION,
            Gate::Perceptual => &perceptual::DESCRIPTION,
            Gate::Stochastic => &stochastic::DESCRIPTION,
            Gate::Refinement => &refinement::DESCRIPTION,
        }
    }

    /// Its name, as in JSON and after `--gate`.
    pub fn name(self) -> &'static str {
        self.description().name
    }
}

impl DifferenceScale {
    /// The unit in which `gate` shows the difference of two images of one size.
    pub(crate) fn of(gate: Gate, golden: &Film, test: &Film) -> DifferenceScale {
        match gate {
            Gate::Deterministic | Gate::Refinement => DifferenceScale::Tolerance {
                absolute: deterministic::ABSOLUTE,
                relative: deterministic::RELATIVE,
            },
            Gate::Stochastic => stochastic::block_map(golden, test)
                .map_or(DifferenceScale::Radiance, DifferenceScale::StandardErrors),
            Gate::Exact | Gate::Perceptual => DifferenceScale::Radiance,
        }
    }
}

/// Every gate for a pair of images.
pub const GATES: [Gate; 4] = [
    Gate::Exact,
    Gate::Deterministic,
    Gate::Perceptual,
    Gate::Stochastic,
];

/// The gate called `name`.
///
/// # Errors
///
/// A message that lists the gates, if there is none of that name.
pub fn gate_named(name: &str) -> Result<Gate, String> {
    let found = GATES.into_iter().find(|gate| gate.name() == name);
    found.ok_or_else(|| {
        let names = GATES.map(Gate::name).join(", ");
        format!("unknown gate {name:?}; the gates are: {names}")
    })
}

/// The default gate for a pair, with the reason as the end of a sentence; empty if it is obvious.
pub(crate) fn default_gate(reference: &Picture, test: &Picture) -> (Gate, &'static str) {
    let [Some(reference), Some(test)] = [reference, test].map(Picture::radiance) else {
        return (Gate::Perceptual, "");
    };
    match [reference, test].iter().any(|film| film.noise().is_some()) {
        true => (Gate::Stochastic, ", since an image includes its variance"),
        false => (Gate::Deterministic, ""),
    }
}

/// True if `test` passes as `reference` by the [default gate](default_gate) of the pair.
pub(crate) fn passes(reference: &Picture, test: &Picture, conditions: &Conditions<'_>) -> bool {
    let (gate, _) = default_gate(reference, test);
    judge(gate, reference, test, conditions).is_ok_and(|judgement| judgement.passed)
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
    incomparable::films(Gate::Stochastic, reference, test).is_none()
}

/// Meaning of a metric of any gate.
pub fn metric_meaning(name: &str) -> Option<&'static str> {
    let gates = GATES.into_iter().chain([Gate::Refinement]);
    let metrics = gates.flat_map(|gate| gate.description().metrics);
    let mut all = metrics.chain([&NON_FINITE, &CUT_OFF, &OUTLIERS_OF_DEPTH]);
    let (_, meaning) = all.find(|(known, _)| *known == name)?;
    Some(meaning)
}

/// Compares `test` with `reference`: first checks sizes and that all pixels are finite, then applies
/// the gate. Changes of the images on reading are part of the reason. A pair has no steps: it is judged by the
/// deterministic gate in place of that of refinement.
///
/// # Errors
///
/// If the gate cannot judge images of this kind: only the perceptual gate judges 8-bit images.
pub fn judge(
    gate: Gate,
    reference: &Picture,
    test: &Picture,
    conditions: &Conditions<'_>,
) -> Result<Judgement, PictureError> {
    let pair = [reference, test];
    let films = || -> Result<_, PictureError> {
        let [reference, test] = pair.map(|picture| picture.radiance_for(gate));
        Ok((reference?, test?))
    };
    let mut judgement = match (incomparable::pictures(gate, reference, test), gate) {
        (Some(difference), _) => difference,
        (None, Gate::Exact) => films().map(|(reference, test)| exact::judge(reference, test))?,
        (None, Gate::Deterministic | Gate::Refinement) => {
            let (reference, test) = films()?;
            deterministic::judge(reference, test, conditions)
        }
        (None, Gate::Perceptual) => {
            let [reference, test] = pair.map(|picture| picture.srgb(conditions.exposure));
            perceptual::judge(&reference?, &test?)
        }
        (None, Gate::Stochastic) => {
            let (reference, test) = films()?;
            let level = stochastic::FALSE_ALARM / conditions.cases.max(1) as f64;
            let Conditions { promise, .. } = *conditions;
            stochastic::judge_with(reference, test, level, promise, conditions.sensitivities)?
        }
    };
    if let [Some(golden), Some(test)] = pair.map(Picture::radiance) {
        judgement = judgement.with_precision_of(golden, test);
    }
    for (name, picture) in [(REFERENCE, reference), (TEST, test)] {
        if let Some(film) = picture.radiance() {
            judgement = judgement.with_changes_of(name, film);
        }
    }
    Ok(judgement)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_gate_is_found_by_its_name_and_says_what_it_does() {
        for gate in GATES {
            assert_eq!(gate_named(gate.name()), Ok(gate));
            assert!(gate.description().rule.ends_with('.'), "{}", gate.name());
            for &(metric, meaning) in gate.description().metrics {
                assert_eq!(metric_meaning(metric), Some(meaning), "{metric}");
            }
        }
        let message = gate_named("ssim").unwrap_err();
        assert!(message.contains("exact, deterministic, perceptual, stochastic"));
    }
}

//! The outcome of a comparison.

use super::advice::Undecided;
use super::gate::Gate;
use crate::film::Film;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Outcome of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// True if the images agree under the gate.
    pub passed: bool,
    /// The rule applied.
    pub gate: Gate,
    /// Numbers by name, all finite; [`Gate::description`] says what they mean.
    pub metrics: BTreeMap<String, f64>,
    /// The reason, with the deciding number.
    pub reason: String,
    /// For a pass that could not have detected the required
    /// [bias](super::Conditions::promise): the verdict is *inconclusive*, and this would
    /// decide.
    pub undecided: Option<Undecided>,
    /// Changes of parameters of the scene that fit the difference, the most significant first; for
    /// images that differ, where [sensitivities](super::Conditions::sensitivities) are known.
    pub changes: Vec<NumberChange>,
    /// Changes of these parameters that would have been seen.
    pub detectable: Vec<Detectable>,
}

/// The smallest change of a parameter of the scene that two images, of the noise that they have, would
/// show with probability one half.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Detectable {
    /// Name of the parameter: `density`.
    pub name: String,
    /// The change in words.
    pub words: String,
    /// Size of the change, in the unit of the parameter; for most parameters a share of it.
    pub change: f64,
}

/// A change of a parameter of the scene, estimated from the difference of two images.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NumberChange {
    /// Name of the parameter: `density`.
    pub name: String,
    /// The change in words, with its error.
    pub words: String,
    /// Change of the test image against the reference, in the unit of the parameter; for most parameters
    /// a share of it.
    pub change: f64,
    /// Standard error.
    pub error: f64,
    /// Score of this change alone, in standard errors.
    pub score: f64,
    /// The one with the largest score, of those that can change so.
    pub fits_best: bool,
}

impl Judgement {
    pub(super) fn new(
        gate: Gate,
        passed: bool,
        reason: String,
        metrics: &[(&str, f64)],
    ) -> Judgement {
        let is_finite = |(_, value): &&(&str, f64)| value.is_finite();
        let named = |&(name, value): &(&str, f64)| (name.to_owned(), value);
        Judgement {
            passed,
            gate,
            metrics: metrics.iter().filter(is_finite).map(named).collect(),
            reason,
            undecided: None,
            changes: Vec::new(),
            detectable: Vec::new(),
        }
    }

    /// With the changes that `film`, the image called `name`, underwent on reading.
    pub(crate) fn with_changes_of(mut self, name: &str, film: &Film) -> Judgement {
        for change in film.changes_on_reading() {
            self.reason.push_str(&format!("; the {name} {change}"));
        }
        self
    }
}

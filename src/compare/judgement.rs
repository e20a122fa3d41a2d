//! The outcome of a comparison.

use super::advice::Undecided;
use super::gate::Gate;
use std::collections::BTreeMap;

/// Outcome of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Whether the images agree under the gate.
    pub passed: bool,
    /// The rule applied.
    pub gate: &'static dyn Gate,
    /// Numbers by name, all finite; [`Gate::metrics`] says what they mean.
    pub metrics: BTreeMap<String, f64>,
    /// The reason, with the deciding number.
    pub reason: String,
    /// For a pass that could not have detected the required
    /// [bias](super::Conditions::visible_bias): the verdict is *inconclusive*, and this would
    /// decide.
    pub undecided: Option<Undecided>,
}

impl Judgement {
    pub(super) fn new(
        gate: &'static dyn Gate,
        passed: bool,
        reason: String,
        metrics: &[(&str, f64)],
    ) -> Judgement {
        let metrics = metrics
            .iter()
            .map(|&(name, value)| (name.to_owned(), value))
            .collect();
        Judgement {
            passed,
            gate,
            metrics,
            reason,
            undecided: None,
        }
    }
}

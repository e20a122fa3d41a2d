//! Tests for changed numbers of the scene.

use super::comparison::Comparison;
use super::scores::Scores;
use super::{Metrics, finite};
use crate::compare::judgement::{Detectable, NumberChange};
use crate::compare::sensitivity::Sensitivity;

/// Findings on the numbers of a scene.
#[derive(Default)]
pub(super) struct NumberFindings {
    /// Reason to reject: the changes that the difference looks like.
    pub fault: Option<String>,
    /// Changes that fit, for a rejected image.
    pub changes: Vec<NumberChange>,
    pub detectable: Vec<Detectable>,
}

/// Tests for an error in each number of which a sensitivity is known, all together at `level`.
pub(super) fn judge_numbers(
    comparison: &Comparison<'_>,
    sensitivities: &[Sensitivity],
    level: f64,
    metrics: &mut Metrics,
) -> NumberFindings {
    if sensitivities.is_empty() || comparison.numbers().contains(&None) {
        return NumberFindings::default();
    }
    let mut findings = NumberFindings::default();
    let Some(scores) = Scores::new(comparison, sensitivities) else {
        return findings;
    };
    let tests = scores.count() as f64;
    let (_, largest) = scores.largest();
    metrics.push(("scores", tests));
    metrics.push(("largest_score", finite(largest)));
    findings.detectable = scores.detectable(level / tests);
    if scores.is_rejected(level / tests) {
        let best = scores.best();
        findings.fault = Some(scores.in_words(&best));
        findings.changes = scores.changes(&best);
    }
    findings
}

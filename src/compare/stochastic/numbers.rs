//! Tests for changed numbers of the scene, in large blocks and in small ones.

use super::blocks::{BLOCK, FINE_BLOCK};
use super::comparison::Comparison;
use super::scores::Scores;
use super::values::value_sensitivities;
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

/// Tests for an error in each number of which a sensitivity is known, and in those of the values of an
/// image, all together at `level`; a block and the mean of the image are rejected beyond these deviations.
pub(super) fn judge_numbers(
    comparison: &Comparison<'_>,
    sensitivities: &[Sensitivity],
    level: f64,
    deviations: [f64; 2],
    metrics: &mut Metrics,
) -> NumberFindings {
    if sensitivities.is_empty() || comparison.numbers().contains(&None) {
        return NumberFindings::default();
    }
    let of_values = value_sensitivities(comparison);
    let sensitivities: Vec<&Sensitivity> = sensitivities.iter().chain(&of_values).collect();
    let mut all = Vec::from_iter(Scores::new(comparison, BLOCK, &sensitivities));
    let pixels = comparison.films[0].radiance().len();
    if sensitivities
        .iter()
        .any(|it| it.derivative.radiance().len() == pixels)
    {
        all.extend(Scores::new(&comparison.fine(), FINE_BLOCK, &sensitivities));
    }
    let mut findings = NumberFindings::default();
    // The one with the largest score comes first.
    all.sort_by(|a, b| {
        let [a, b] = [a, b].map(|scores| scores.largest().1.abs());
        b.total_cmp(&a)
    });
    let Some(scores) = all.first() else {
        return findings;
    };
    let tests: usize = all.iter().map(Scores::count).sum();
    let (_, largest) = scores.largest();
    metrics.push(("scores", tests as f64));
    metrics.push(("largest_score", finite(largest)));
    for scores in &all {
        let detectable = scores.detectable(level / tests as f64, deviations);
        findings.detectable.extend(detectable);
    }
    if !scores.is_rejected(level / tests as f64) {
        return findings;
    }
    let best = scores.best();
    findings.fault = Some(scores.in_words(&best));
    findings.changes = scores.changes(Some(&best));
    for others in &all[1..] {
        findings.changes.extend(others.changes(None));
    }
    findings
}

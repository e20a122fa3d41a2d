//! Score tests: correlation of the difference with the derivative of the image by each parameter of
//! the scene.
//!
//! The derivative D of the image by a parameter says where a small error of that parameter shows. The sum
//! `S = Σ D·d/v` over blocks and channels, of the differences d whose variances are v, is of all sums
//! of differences the one that sees such an error best (Rao 1948, Proceedings of the Cambridge
//! Philosophical Society 44, 50–57). It is no test of the noise of D: that is independent of d.
//!
//! # False alarms
//!
//! The differences of blocks are independent and have mean 0 where nothing is wrong, but they are
//! not normal, and some carry most of a sum. For any independent `s_b` of mean 0 and finite variance
//!
//! ```text
//! P(|Σ s_b| ≥ t·√V) ≤ 2·exp(−t²/2),   V = ⅓ Σ s_b² + ⅔ Σ E s_b²
//! ```
//!
//! (for V below a bound, Delyon 2009, Electronic Journal of Probability 14, theorem 4; t takes the
//! place of standard errors). A difference that is there would enlarge `Σ s_b²` itself, so that its
//! squares are those of what the best fit leaves, each divided by the share of the fit that other
//! blocks have, as MacKinnon & White 1985 (Journal of Econometrics 29, 305–325) estimate variances. With these the
//! bound is no theorem any more; simulated suites hold it to its promise (`tests/library/scores.rs`). The channels of a block share their random numbers in ways that no image
//! states, so `E s_b²` is the most that it can be: the square of the sum of their standard errors. As
//! everywhere in this gate, variances have two answers, and the larger sum counts.
//!
//! # Sizes
//!
//! The change that fits best is `S/G` with `G = Σ D²/v`. The noise of D makes its square too large on
//! the average by its variance, which is taken off; without that, sizes would come out too small.
//! The parameter with the largest score is named. What it leaves, and which others do as well, the
//! [search for a cause](crate::naming) tells, with scenes rendered anew.

use super::comparison::Comparison;
use super::{Metrics, finite};
use crate::compare::judgement::{Detectable, NumberChange};
use crate::compare::sensitivity::Sensitivity;
use crate::compare::significance::deviation;
use crate::math;
use std::cmp::Ordering;

/// Smallest error of a difference, as a share of the radiance: rounding and the last of an infinite
/// series are of this size, whatever the noise.
const FLOOR: f64 = 1e-3;

/// Findings on the parameters of a scene.
#[derive(Default)]
pub(super) struct NumberFindings {
    /// Reason to reject: the changes that the difference looks like.
    pub fault: Option<String>,
    /// Changes that fit, for a rejected image.
    pub changes: Vec<NumberChange>,
    pub detectable: Vec<Detectable>,
}

/// Tests for an error in each parameter of which a sensitivity is known, all together at `level`.
pub(super) fn judge_numbers(
    comparison: &Comparison<'_>,
    sensitivities: &[Sensitivity],
    level: f64,
    metrics: &mut Metrics,
) -> NumberFindings {
    let mut findings = NumberFindings::default();
    if sensitivities.is_empty() || comparison.numbers().contains(&None) {
        return findings;
    }
    let Some(scores) = Scores::new(comparison, sensitivities) else {
        return findings;
    };
    let tests = scores.tested.len() as f64;
    let (_, largest) = scores.largest();
    metrics.push(("scores", tests));
    metrics.push(("largest_score", finite(largest)));
    findings.detectable = scores.detectable(level / tests);
    if largest.abs() >= critical(level / tests) {
        let best = scores.best();
        findings.fault = Some(scores.in_words(&best));
        findings.changes = scores.changes(&best);
    }
    findings
}

/// Scores of one comparison.
struct Scores<'s> {
    sensitivities: Vec<&'s Sensitivity>,
    /// Scores by parameter.
    tested: Vec<Tested>,
    cells: Vec<Cell>,
}

/// A channel of a block.
struct Cell {
    /// Sum of the differences over the block.
    difference: f64,
    /// Part of it that rounding can explain.
    rounding: f64,
    weight: f64,
    /// Variance of the difference, by both estimates.
    variances: [f64; 2],
    /// Derivative by each parameter, and its variance.
    derivatives: Vec<[f64; 2]>,
}

impl Cell {
    /// The part of the information on parameter `k`.
    fn information(&self, k: usize) -> f64 {
        let [derivative, noise] = self.derivatives[k];
        self.weight * (derivative * derivative - noise)
    }
}

struct Tested {
    score: f64,
    /// Part of it that rounding can explain.
    hidden: f64,
    /// Σ D²/v, the noise of D taken out.
    information: f64,
    /// V above.
    variance: f64,
    /// Mean of V where nothing is wrong.
    expected_variance: f64,
}

impl Tested {
    /// Score of parameter `k`.
    fn new(cells: &[Cell], k: usize) -> Tested {
        let information: f64 = cells.iter().map(|cell| cell.information(k)).sum();
        let blocks = || cells.chunks(3);
        let pull = |cell: &Cell| cell.weight * cell.derivatives[k][0];
        let of_block =
            |block: &[Cell]| -> f64 { block.iter().map(|cell| pull(cell) * cell.difference).sum() };
        let score: f64 = blocks().map(of_block).sum();
        // Roundings may all have the sign of the derivative: those of pixels without noise are the same
        // wherever the value is, such as in a sky.
        let hidden: f64 = cells
            .iter()
            .map(|cell| pull(cell).abs() * cell.rounding)
            .sum();
        let expected = [0, 1].map(|answer| -> f64 {
            let most = |block: &[Cell]| -> f64 {
                let errors = block
                    .iter()
                    .map(|cell| pull(cell).abs() * cell.variances[answer].sqrt());
                errors.sum()
            };
            blocks().map(|block| most(block) * most(block)).sum()
        });
        let expected_variance = expected[0].max(expected[1]);
        // What the change that fits best leaves of each block; divided by what the block itself has
        // not contributed to that fit.
        let change = score / information;
        let left = blocks().map(|block| {
            let own: f64 = block.iter().map(|cell| cell.information(k)).sum();
            let others = 1.0 - (own / information).clamp(0.0, 1.0);
            let left = of_block(block) - change * own;
            if left == 0.0 {
                0.0
            } else {
                (left / others)
                    .abs()
                    .min(of_block(block).abs().max(left.abs()))
            }
        });
        let squares: f64 = left.map(|left| left * left).sum();
        Tested {
            score,
            hidden,
            information,
            variance: squares / 3.0 + 2.0 * expected_variance / 3.0,
            expected_variance,
        }
    }

    /// Difference beyond rounding, in standard errors.
    fn deviation(&self) -> f64 {
        let beyond = (self.score.abs() - self.hidden).max(0.0);
        deviation(beyond.copysign(self.score), self.variance)
    }
}

/// A change of a parameter that fits.
struct Fitted {
    /// Index of the parameter.
    number: usize,
    /// Change in its unit.
    change: f64,
    /// Standard error of the change.
    error: f64,
}

impl<'s> Scores<'s> {
    /// Scores of the sensitivities in blocks; `None` without any.
    fn new(comparison: &Comparison<'_>, all: &'s [Sensitivity]) -> Option<Scores<'s>> {
        let blocks = &comparison.blocks;
        let fits = |it: &&Sensitivity| it.derivative.radiance().len() == blocks.len();
        let mut sensitivities: Vec<&Sensitivity> = all.iter().filter(fits).collect();
        let mut cells = cells(comparison, &sensitivities);
        // A derivative that is mostly noise says nothing: its square must be known to a quarter.
        let is_known = |k: usize| {
            let information: f64 = cells.iter().map(|cell| cell.information(k)).sum();
            let variance = of_blocks(&cells, |cell| {
                let [derivative, noise] = cell.derivatives[k];
                cell.weight * (2.0 * noise * noise + 4.0 * derivative * derivative * noise).sqrt()
            });
            information > 4.0 * variance.sqrt()
        };
        let known: Vec<bool> = (0..sensitivities.len()).map(is_known).collect();
        if !known.contains(&true) {
            return None;
        }
        sensitivities = those_that(&known, sensitivities);
        for cell in &mut cells {
            cell.derivatives = those_that(&known, std::mem::take(&mut cell.derivatives));
        }
        let tested = (0..sensitivities.len()).map(|k| Tested::new(&cells, k));
        Some(Scores {
            tested: tested.collect(),
            sensitivities,
            cells,
        })
    }

    /// The parameter with the largest score, and that score in standard errors.
    fn largest(&self) -> (usize, f64) {
        let deviations = self.tested.iter().map(Tested::deviation).enumerate();
        deviations
            .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
            .expect("there is a test")
    }

    /// The score of parameter `k` without its sign, in standard errors.
    fn size(&self, k: usize) -> f64 {
        self.tested[k].deviation().abs()
    }

    /// The smallest change of each parameter that its score would reject with probability one half.
    fn detectable(&self, level: f64) -> Vec<Detectable> {
        let of_number = |(sensitivity, tested): (&&Sensitivity, &Tested)| {
            let visible = critical(level) * tested.expected_variance.sqrt() + tested.hidden;
            let change = visible / tested.information;
            change.is_finite().then(|| Detectable {
                name: sensitivity.name.clone(),
                words: sensitivity.size_in_words(change),
                change,
            })
        };
        let tested = self.sensitivities.iter().zip(&self.tested);
        tested.filter_map(of_number).collect()
    }

    /// The change that fits of the parameter with the largest score, among those that can change so.
    fn best(&self) -> Fitted {
        let all = || (0..self.tested.len()).map(|k| self.fit(k));
        let possible = all().filter(|it| self.is_possible(it));
        let largest = possible.max_by(|a, b| self.size(a.number).total_cmp(&self.size(b.number)));
        largest.unwrap_or_else(|| self.fit(self.largest().0))
    }

    fn is_possible(&self, it: &Fitted) -> bool {
        self.sensitivities[it.number].is_possible(it.change)
    }

    /// The change of parameter `k` that fits, by weighted least squares.
    fn fit(&self, k: usize) -> Fitted {
        let tested = &self.tested[k];
        let information = tested.information;
        let change = tested.score / information;
        let of_derivative = of_blocks(&self.cells, |cell| {
            let [derivative, noise] = cell.derivatives[k];
            cell.weight * (noise * (derivative * derivative + noise)).sqrt()
        });
        let part = change / information;
        let of_score = tested.expected_variance / (information * information);
        let variance = of_score + part * part * of_derivative;
        let curvature = self.sensitivities[k].curvature(change);
        let rounding = tested.hidden / information;
        Fitted {
            number: k,
            change,
            error: (variance + curvature * curvature + rounding * rounding).sqrt(),
        }
    }

    /// Every parameter with the change of it that fits, by the size of their scores; first the `best`.
    fn changes(&self, best: &Fitted) -> Vec<NumberChange> {
        let best = |k: usize| best.number == k;
        let mut all: Vec<usize> = (0..self.tested.len()).collect();
        all.sort_by(|&a, &b| {
            (best(b), self.size(b))
                .partial_cmp(&(best(a), self.size(a)))
                .unwrap_or(Ordering::Equal)
        });
        let change = |k: usize| {
            let it = self.fit(k);
            let sensitivity = self.sensitivities[k];
            let score = self.tested[k].deviation();
            let is_finite = it.change.is_finite() && it.error.is_finite() && score.is_finite();
            (is_finite && sensitivity.stays_positive(it.change)).then(|| NumberChange {
                name: sensitivity.name.clone(),
                words: sensitivity.in_words(it.change, it.error),
                change: it.change,
                error: it.error,
                score,
                fits_best: best(k),
            })
        };
        all.into_iter().filter_map(change).collect()
    }

    /// Sentence on what the difference looks like.
    fn in_words(&self, best: &Fitted) -> String {
        let deviation = format!("{:.1} standard errors", self.size(best.number));
        let sensitivity = self.sensitivities[best.number];
        if sensitivity.is_far(best.change) || !self.is_possible(best) {
            return format!(
                "the difference is too large for derivatives to tell if a number is off, and which (score of the \
                 likeliest: {deviation})"
            );
        }
        let change = sensitivity.in_words(best.change, best.error);
        format!(
            "the difference looks as if this were so, or like a mistake with the same effect: {change} ({deviation})"
        )
    }
}

/// The score at which one test rejects at `level`.
fn critical(level: f64) -> f64 {
    (2.0 * math::ln(2.0 / level)).sqrt()
}

/// Channels of all blocks, with their derivatives by all these parameters.
fn cells(comparison: &Comparison<'_>, sensitivities: &[&Sensitivity]) -> Vec<Cell> {
    let mut cells = Vec::with_capacity(comparison.asked());
    for (at, block) in comparison.blocks.iter().enumerate() {
        let pixels = block.pixels() as f64;
        for (c, channel) in block.channels.iter().enumerate() {
            let floor = FLOOR * block.floor(c);
            let derivatives = sensitivities.iter().map(|sensitivity| {
                let film = &sensitivity.derivative;
                let variance = film.variance_at(at, c);
                [
                    f64::from(film.radiance()[at][c]) * pixels,
                    variance * pixels * pixels,
                ]
            });
            let [own, guard] = [channel.variance.own(), channel.variance.guard()];
            cells.push(Cell {
                difference: channel.difference.value,
                rounding: channel.difference.rounding,
                // Not by what the test image states of itself where it happens to be dark.
                weight: 1.0 / (guard + floor * floor),
                variances: [own, guard],
                derivatives: derivatives.collect(),
            });
        }
    }
    cells
}

/// Upper bound on the variance of a sum over blocks, whose channels each have this standard error:
/// reached if their noise is the same.
fn of_blocks(cells: &[Cell], error: impl Fn(&Cell) -> f64) -> f64 {
    let of_block = |block: &[Cell]| {
        let sum: f64 = block.iter().map(|cell| error(cell).abs()).sum();
        sum * sum
    };
    cells.chunks(3).map(of_block).sum()
}

fn those_that<T>(are: &[bool], all: Vec<T>) -> Vec<T> {
    let all = all.into_iter().zip(are);
    all.filter_map(|(item, &is)| is.then_some(item)).collect()
}

//! Score tests: correlation of the difference with the derivative of the image by each number of
//! the scene.
//!
//! The derivative D of the image by a number says where a small error of that number shows. The sum
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
//! The parameter with the largest score is named, and those that leave no score of it. Several together are fitted by the
//! [search for a cause](crate::naming), with scenes rendered anew.
//!
//! # What noise hides
//!
//! That a change leaves no more than noise shows little where the whole difference is hardly more. In n squares, in
//! units of their variance, a remainder of `h = 4·√(6n) + k` goes unseen: four standard errors of their sum, where
//! the
//! three channels share their noise, and a square for each of the k numbers of which the best was chosen. A change c of
//! the number makes `c²·G` of the squares, which is `S²/G`. Only from the score on at which a remainder of h is less than
//! [a tenth](LEAVES) of the whole is the difference said to look like the change; of a smaller one, as far as the noise
//! tells.

use super::blocks::{BLOCK, Block};
use super::comparison::Comparison;
use super::values;
use crate::compare::judgement::{Detectable, FitMap, NumberChange};
use crate::compare::sensitivity::Sensitivity;
use crate::compare::significance::deviation;
use crate::math;
use std::cmp::Ordering;

/// Smallest error of a difference, as a share of the radiance: rounding and the last of an infinite
/// series are of this size, whatever the noise.
const FLOOR: f64 = 1e-3;

/// The score from which a parameter is significant beside another: what noise alone exceeds in one test of sixteen
/// thousand.
const BESIDE: f64 = 4.0;

/// Largest share of the squared difference that numbers leave if it is said to be as if they were off.
const LEAVES: f64 = 0.1;

/// Largest residual of a block, in standard errors, beside changes that the difference looks like:
/// noise with rare events exceeds five in an image of many blocks.
const LARGEST_LEFT: f64 = 8.0;

/// The part of the largest score that the score of a number has which explains a difference as well:
/// the noise of its derivative takes some of it.
const ALIKE: f64 = 0.5;

/// Scores of one comparison.
pub(super) struct Scores<'s> {
    sensitivities: Vec<&'s Sensitivity>,
    /// Scores by number.
    tested: Vec<Tested>,
    cells: Vec<Cell>,
    /// Pixels on a side of a block.
    edge: usize,
    /// Blocks in a row.
    columns: usize,
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
    /// Derivative by each number, and its variance.
    derivatives: Vec<[f64; 2]>,
}

impl Cell {
    /// Variance of the difference, the larger of both estimates.
    fn variance(&self) -> f64 {
        self.variances[0].max(self.variances[1])
    }

    /// The part of the information on number `k`.
    fn information(&self, k: usize) -> f64 {
        let [derivative, noise] = self.derivatives[k];
        self.weight * (derivative * derivative - noise)
    }
}

#[derive(Clone, Copy, Debug)]
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
    /// Score of number `k`.
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

/// A change of a number that fits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fitted {
    /// Index of the number.
    number: usize,
    /// Change in its unit.
    change: f64,
    /// Standard error of the change.
    error: f64,
}

/// A change that explains a difference.
pub(super) struct Explanation {
    /// The one with the largest score.
    best: Fitted,
    /// Parameters that explain it as well.
    alike: Vec<usize>,
}

impl<'s> Scores<'s> {
    /// Scores in blocks with an `edge` of that many pixels; `None` without sensitivities in such
    /// blocks.
    pub fn new(
        comparison: &Comparison<'_>,
        edge: usize,
        all: &[&'s Sensitivity],
    ) -> Option<Scores<'s>> {
        let blocks = &comparison.blocks;
        let fits = |it: &&Sensitivity| it.derivative.radiance().len() == blocks.len();
        let mut sensitivities: Vec<&Sensitivity> = all.iter().copied().filter(fits).collect();
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
            edge,
            columns: comparison.columns(),
        })
    }

    /// Number of tests.
    pub fn count(&self) -> usize {
        self.tested.len()
    }

    /// The number with the largest score, and that score in standard errors.
    pub fn largest(&self) -> (usize, f64) {
        let deviations = self.tested.iter().map(Tested::deviation).enumerate();
        deviations
            .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
            .expect("there is a test")
    }

    /// The score of number `k` without its sign, in standard errors.
    fn size(&self, k: usize) -> f64 {
        self.tested[k].deviation().abs()
    }

    /// True if a score is so large by chance with a probability of `level` at most, in one test.
    pub fn is_rejected(&self, level: f64) -> bool {
        self.largest().1.abs() >= critical(level)
    }

    /// The smallest change of each number that would be rejected with probability one half: by its
    /// score, and by blocks and the mean of the image, at these deviations.
    pub fn detectable(&self, level: f64, [of_block, of_whole]: [f64; 2]) -> Vec<Detectable> {
        let critical = critical(level);
        let of_number = |(k, tested): (usize, &Tested)| {
            let visible = critical * tested.expected_variance.sqrt() + tested.hidden;
            let change = visible / tested.information;
            let (mut sums, mut without_score) = ([[0.0; 2]; 3], f64::INFINITY);
            for (at, cell) in self.cells.iter().enumerate() {
                let variance = cell.variance();
                let [derivative, noise] = cell.derivatives[k];
                // What noise makes of the derivative of a block is no change of it.
                let known = (derivative * derivative - noise).max(0.0).sqrt();
                if self.edge == BLOCK {
                    without_score = f64::min(without_score, of_block * variance.sqrt() / known);
                }
                sums[at % 3][0] += derivative;
                sums[at % 3][1] += variance;
            }
            for [derivative, variance] in sums {
                without_score =
                    f64::min(without_score, of_whole * variance.sqrt() / derivative.abs());
            }
            change.is_finite().then(|| Detectable {
                name: self.sensitivities[k].name.clone(),
                words: self.sensitivities[k].size_in_words(change),
                change,
                without_score: Some(without_score).filter(|size| size.is_finite()),
            })
        };
        let tested = self.tested.iter().enumerate();
        tested.filter_map(of_number).collect()
    }

    /// The parameter with the largest score among those that can change so.
    fn largest_possible(&self) -> usize {
        let can = |k: &usize| self.is_possible(&self.fit(*k));
        let possible = (0..self.count()).filter(can);
        let largest = possible.max_by(|&a, &b| self.size(a).total_cmp(&self.size(b)));
        largest.unwrap_or(self.largest().0)
    }

    fn is_possible(&self, it: &Fitted) -> bool {
        self.sensitivities[it.number].is_possible(it.change)
    }

    /// The score of a parameter in the residual of a fitted one, in standard errors of a single
    /// test.
    fn score_beside(&self, k: usize, it: &Fitted) -> f64 {
        let whole = self.tested[k].information;
        let shared = self.shared(k, it.number);
        let score = self.tested[k].score - shared * it.change;
        let left = whole - shared * shared / self.tested[it.number].information;
        if left <= 0.01 * whole {
            return 0.0;
        }
        // What varies alike is gone with the fit; the error of the derivatives of the fit is added.
        let of_derivatives = of_blocks(&self.cells, |cell| {
            let [derivative, noise] = cell.derivatives[k];
            let [of_fit, noise_of_fit] = cell.derivatives[it.number];
            let square = derivative * derivative * noise_of_fit + of_fit * of_fit * noise;
            cell.weight * it.change * square.sqrt()
        });
        let variance = self.tested[k].expected_variance * left / whole + of_derivatives;
        // Nor is what the fitted one does out of proportion a score of this one.
        let of_cell = |cell: &Cell| {
            let [along, fitted] = [k, it.number].map(|number| cell.derivatives[number][0].abs());
            cell.weight * along * fitted
        };
        let curvature = self.sensitivities[it.number].curvature(it.change);
        let explained =
            curvature * self.cells.iter().map(of_cell).sum::<f64>() + self.tested[k].hidden;
        score.signum() * (score.abs() - explained).max(0.0) / variance.sqrt()
    }

    /// Parameters that explain the difference as well as the `first` one: none leaves a score of that.
    fn alike(&self, first: &Fitted) -> Vec<usize> {
        let others = (0..self.count()).filter(|&k| k != first.number);
        let of_first = self.size(first.number);
        let leaves_noise = self.left(first).is_noise;
        let is_alike = |&k: &usize| {
            let alone = self.fit(k);
            alone.error.is_finite()
                && (!leaves_noise || self.left(&alone).is_noise)
                && self.is_possible(&alone)
                && self.size(k) > ALIKE * of_first
                && self.score_beside(first.number, &alone).abs() < BESIDE
        };
        others.filter(is_alike).collect()
    }

    /// Σ D_k·D_l/v, the noise of a square taken out.
    fn shared(&self, k: usize, l: usize) -> f64 {
        if k == l {
            return self.tested[k].information;
        }
        let of_cell = |cell: &Cell| cell.weight * cell.derivatives[k][0] * cell.derivatives[l][0];
        self.cells.iter().map(of_cell).sum()
    }

    /// The change of number `k` that fits, by weighted least squares.
    fn fit(&self, k: usize) -> Fitted {
        let Tested {
            score,
            hidden,
            information,
            expected_variance,
            ..
        } = self.tested[k];
        let change = score / information;
        let of_derivative = of_blocks(&self.cells, |cell| {
            let [derivative, noise] = cell.derivatives[k];
            cell.weight * (noise * (derivative * derivative + noise)).sqrt()
        });
        let part = change / information;
        let variance =
            expected_variance / (information * information) + part * part * of_derivative;
        let curvature = self.sensitivities[k].curvature(change);
        let rounding = hidden / information;
        Fitted {
            number: k,
            change,
            error: (variance + curvature * curvature + rounding * rounding).sqrt(),
        }
    }

    /// The score of number `k`, in standard errors, from which noise hides no more than [`LEAVES`] of a squared
    /// difference of which a change of that number leaves this.
    fn telling(&self, k: usize, left: &Left) -> f64 {
        let hidden = left.hidden + self.count() as f64;
        let squares = (1.0 / LEAVES - 1.0) * hidden;
        (squares * self.tested[k].information / self.tested[k].expected_variance).sqrt()
    }

    /// Residual of the difference after the change.
    fn left(&self, it: &Fitted) -> Left {
        let (mut whole, mut left, mut squares) = (0.0, 0.0, 0.0);
        let (mut squares_left, mut largest) = (0.0, 0.0_f64);
        for cell in &self.cells {
            let mut rest = cell.difference;
            let mut noise = cell.variance();
            // The channels of a block may share their noise; the square of a normal number varies by
            // twice the square of its variance.
            squares += 3.0 * 2.0 * (cell.weight * noise) * (cell.weight * noise);
            whole += cell.weight * (rest * rest - noise);
            let [derivative, variance] = cell.derivatives[it.number];
            rest -= it.change * derivative;
            noise += it.change * it.change * variance;
            left += cell.weight * (rest * rest - noise);
            squares_left += 3.0 * 2.0 * (cell.weight * noise) * (cell.weight * noise);
            largest = largest.max((rest.abs() - cell.rounding).max(0.0) / noise.sqrt());
        }
        let is_known = whole > BESIDE * squares.sqrt();
        let hidden = BESIDE * squares_left.sqrt();
        Left {
            share: is_known.then(|| (left / whole).clamp(0.0, 1.0)),
            is_noise: left <= hidden && largest <= LARGEST_LEFT,
            hidden,
        }
    }

    /// The change that fits best, and the parameters that cannot be told from it.
    pub fn explanation(&self) -> Explanation {
        let best = self.fit(self.largest_possible());
        Explanation {
            alike: self.alike(&best),
            best,
        }
    }

    /// Every parameter with the change of it that fits, by the size of their scores; first the one of the `explanation`,
    /// where that is in blocks of this size.
    pub fn changes(&self, explanation: Option<&Explanation>) -> Vec<NumberChange> {
        let best = |k: usize| explanation.is_some_and(|it| it.best.number == k);
        let mut all: Vec<usize> = (0..self.count()).collect();
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
                alike: explanation.is_some_and(|it| it.alike.contains(&k)),
            })
        };
        all.into_iter().filter_map(change).collect()
    }

    /// The difference and the part of it that the best change makes.
    pub fn map(&self, Explanation { best, .. }: &Explanation) -> FitMap {
        let of_blocks = |sum: &dyn Fn(&Cell) -> f64| {
            let of_cell = |cell: &Cell| match sum(cell) / cell.variance().sqrt() {
                errors if errors.is_finite() => errors,
                _ => 0.0,
            };
            let blocks = self.cells.chunks_exact(3);
            blocks
                .map(|block| [0, 1, 2].map(|c| of_cell(&block[c])))
                .collect()
        };
        let fitted = |cell: &Cell| best.change * cell.derivatives[best.number][0];
        FitMap {
            columns: self.columns,
            difference: of_blocks(&|cell| cell.difference),
            fitted: of_blocks(&fitted),
        }
    }

    /// Sentence on what the difference looks like, and whether it says no more than "as if".
    pub fn in_words(&self, Explanation { best, alike }: &Explanation) -> (String, bool) {
        let size = self.size(best.number);
        let deviation = format!("{size:.1} standard errors");
        let left = self.left(best);
        let sensitivity = self.sensitivities[best.number];
        let is_far = sensitivity.is_far(best.change);
        // Only where derivatives hold, and leave noise, is it the same as a rendering with the change.
        let is_found = left.is_noise && !is_far;
        let is_as_if = left.share.map_or(left.is_noise, |share| share <= LEAVES);
        if !self.is_possible(best) || !(is_found || is_as_if) {
            let what = if is_far {
                "the difference is too large for derivatives to tell if a number is off, and which"
            } else {
                "no small change of a parameter explains the difference"
            };
            return (
                format!("{what} (score of the likeliest: {deviation})"),
                false,
            );
        }
        let change = sensitivity.in_words(best.change, best.error);
        let telling = self.telling(best.number, &left);
        let mut text = if !is_found {
            format!(
                "the difference is as if this were so, or a mistake that looks like it: {change} ({deviation})"
            )
        } else if size >= telling {
            format!("the difference looks like this: {change} ({deviation})")
        } else {
            format!(
                "as far as the noise tells, the difference looks like this: {change} ({deviation}; below {telling:.0} a \
                 tenth of its square, or more, may have another cause)"
            )
        };
        match left.share {
            _ if is_found => text.push_str(", which leaves nothing beyond noise"),
            Some(share) if !is_far => {
                let share = crate::compare::left(share);
                text.push_str(&format!(
                    "; that leaves {share} of its square, weighed by noise"
                ));
            }
            _ => {}
        }
        let others = alike.iter().map(|&k| {
            let other = self.fit(k);
            self.sensitivities[k].in_words(other.change, other.error)
        });
        let others: Vec<String> = others.collect();
        if !others.is_empty() {
            text.push_str(&format!(
                "; this image cannot tell it from {}",
                others.join(", or ")
            ));
        }
        (text, !is_found)
    }
}

/// Residual of a difference after changes of numbers.
struct Left {
    /// Share of the squared difference, noise taken out; `None` where noise makes nearly all of the
    /// squares.
    share: Option<f64>,
    /// True if it is no more than noise, in all blocks together and in each.
    is_noise: bool,
    /// Squares that noise makes by chance, or hides.
    hidden: f64,
}

/// The score at which one test rejects at `level`.
fn critical(level: f64) -> f64 {
    (2.0 * math::ln(2.0 / level)).sqrt()
}

/// Channels of all blocks, with their derivatives by all these numbers.
fn cells(comparison: &Comparison<'_>, sensitivities: &[&Sensitivity]) -> Vec<Cell> {
    let mut cells = Vec::with_capacity(comparison.asked());
    for (at, block) in comparison.blocks.iter().enumerate() {
        let (pixels, share_seen) = (block.pixels() as f64, share_seen(comparison, block));
        for (c, channel) in block.channels.iter().enumerate() {
            let floor = FLOOR * block.floor(c);
            let derivatives = sensitivities.iter().map(|sensitivity| {
                let film = &sensitivity.derivative;
                // A derivative by a number of the scene is that of all pixels of a block, one by values of what
                // is seen.
                let is_of_seen = values::is_of_seen(&sensitivity.name);
                let pixels = pixels * if is_of_seen { 1.0 } else { share_seen };
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

/// Share of the pixels of a block that an image of 8 bits does not [cut off](super::cut_off).
fn share_seen(comparison: &Comparison<'_>, block: &Block) -> f64 {
    let Some(left_out) = comparison.left_out else {
        return 1.0;
    };
    let indices = block.indices(comparison.films[0].width());
    let seen = indices.filter(|&index| !left_out[index]).count();
    seen as f64 / block.pixels() as f64
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

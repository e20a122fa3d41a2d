//! Numbers of the scene that may be off, fitted to an image that no mistake explains.
//!
//! A mistake of the catalogue is one edit; a volume that is a tenth too dense is none. The scene is
//! rendered with each of its [numbers](crate::sensitivity) changed a little, which gives the
//! derivatives of the image: the columns of its Jacobian. The numbers whose derivatives lead
//! nearest to the image are changed by the Gauss–Newton method, with an image rendered for every
//! step and Broyden's update of the Jacobian (of one number alone: secants). Where that leaves
//! much, a second number is changed beside the first, and a third.
//!
//! A change is a finding only if the scene, rendered again with it, agrees with the image within the
//! gate: one that merely lies near is "as if". Gains of the values and an offset, which no scene has among
//! its numbers, compete with single numbers.
//!
//! # Errors in noise
//!
//! The noise of a prediction is in its derivatives as well as in the residual. Both together bias a fit,
//! the more so the farther the change is, since the random numbers on both sides then have less in common;
//! and no residual shows it. So the last steps take derivatives from one seed and residuals from another
//! (an instrumental variable: Durbin 1954, "Errors in variables", Review of the International Statistical
//! Institute 22, 23–32). Where these steps do not come to rest, no interval is stated.

use super::clock::SearchClock;
use super::compared_case::ComparedCase;
use super::predictor::UNCHANGED;
use super::volume_in_view::VolumeInView;
use crate::compare::cells::{Cells, Misfit};
use crate::compare::{Seen, change_in_words, left};
use crate::scene::Scene;
use crate::sensitivity::{Number, Unit, numbers, numbers_of_place};
use crate::variations::edited_film::mapped;
use glam::{DMat3, DVec3};

/// Words of a sentence on changes with which the scene, rendered again, agrees with the image.
const AGREES: &str = "the scene agrees with the image";

/// True if a sentence of those `said` of an image states a change of numbers with which the scene, rendered again,
/// agrees with it.
pub(crate) fn is_number_found(said: &[String]) -> bool {
    said.iter().any(|sentence| sentence.contains(AGREES))
}

/// Largest share of the squared difference that reported changes may leave unexplained: a third of
/// the difference, root mean square. The sentence states what they leave.
pub(super) const LEFT: f64 = 0.1;

/// Largest number of candidates in a fit of one number, or of one more: those whose derivatives
/// lead nearest.
const TRIED: usize = 4;

/// Largest number of numbers fitted together: one image seldom tells more apart.
const TOGETHER: usize = 3;

/// Largest number of them that are said to be off, without that the scene agrees with the image: together
/// they come near what none of them made.
const MOST_AS_IF: usize = 2;

/// Largest share of the previous residual that a fit with another number may leave.
const WORTH_ANOTHER: f64 = 0.5;

/// Largest number of steps of a fit.
const STEPS: usize = 12;

/// Largest number of halvings of a step that leads away.
const HALVINGS: usize = 2;

/// Smallest change of a number beside another, in its standard errors.
const BESIDE: f64 = 4.0;

/// Share of the step of a number below which a step of the fit is the last: the sentence has no
/// more digits.
const CLOSE: f64 = 0.002;

/// Largest number of steps that correct a fit for the noise of its derivatives.
const CORRECTIONS: usize = 4;

/// Smallest square of a derivative, in its standard errors, by which such a step is made.
const KNOWN: f64 = 4.0;

/// Part of a last step that counts as an error: the derivative at the wrong place.
const CURVED: f64 = 0.5;

/// Range of the fit: shares down to a twentieth and up to ten times a number, others this many of
/// their steps away.
const SHARES: [f64; 2] = [-0.95, 9.0];
const FARTHEST: f64 = 16.0;

/// Range of shares outside which a change is a finding, or nothing.
const NEARBY: [f64; 2] = [-0.75, 3.0];

/// Values of all channels of all cells.
type Vector = Vec<f64>;

/// Changes of numbers, and their residual.
struct Fit {
    /// Places in the list of numbers.
    numbers: Vec<usize>,
    /// Change of each, in its unit.
    changes: Vec<f64>,
    /// Standard errors of the changes; infinite where they are not known.
    errors: Vec<f64>,
    predicted: Cells,
    /// Residual: share of the squared difference.
    left: f64,
}

/// Fits to the image of one case.
struct Fitting<'f> {
    case: &'f ComparedCase,
    clock: &'f SearchClock<'f>,
    numbers: Vec<Number>,
    /// The scene as it is, once for each seed.
    unchanged: Vec<Cells>,
    /// Derivatives of the image by each number, where it has one: columns of the Jacobian.
    derivatives: Vec<Option<Vector>>,
    /// The measure of differences, and that of the golden from the image.
    scale: Cells,
    whole: Misfit,
    weights: Vector,
    golden: Vector,
    test: Vector,
    guarded_test: Cells,
}

/// Report on changes of numbers.
#[derive(Debug, Default)]
pub(super) struct Fitted {
    /// The sentence that says most.
    pub sentence: Option<String>,
    /// True if the changes explain the image as well as a mistake must.
    pub is_explained: bool,
    /// True if the image agrees with a rendering with them.
    pub agrees: bool,
    /// The least mean squared difference from such a rendering, in variances.
    pub in_noise: Option<f64>,
}

impl Fitted {
    /// Takes another report in place of this one, if that says more.
    pub fn or(&mut self, other: Fitted) {
        let is_explained = self.is_explained || other.is_explained;
        if other.agrees && !self.agrees || self.sentence.is_none() {
            *self = other;
        }
        self.is_explained = is_explained;
    }
}

/// Changes that may explain an image.
pub(super) struct Candidate {
    /// The changes: `density 10 % too large`.
    pub words: String,
    /// Share of the squared difference that they leave.
    pub left: f64,
    /// True if the scene, rendered with them, agrees with the image.
    pub agrees: bool,
    /// Mean squared difference from that rendering, in variances.
    pub in_noise: f64,
    /// True if they explain the image as well as a mistake must.
    pub is_explained: bool,
    /// The image with them.
    pub predicted: Cells,
}

impl ComparedCase {
    /// The changes of numbers that would explain the image.
    pub fn fitted_numbers(&self, clock: &SearchClock<'_>) -> Fitted {
        let Some(fitting) = Fitting::new(self, clock) else {
            return Fitted::default();
        };
        self.report(fitting.candidates())
    }

    /// One sentence on all changes that agree with the image, or on the one that lies nearest.
    pub(super) fn report(&self, mut candidates: Vec<Candidate>) -> Fitted {
        candidates.sort_by(|a, b| a.left.total_cmp(&b.left));
        let agrees = candidates.iter().any(|it| it.agrees);
        let is_said = |it: &Candidate| it.agrees || !agrees;
        candidates.retain(is_said);
        if !agrees {
            candidates.truncate(1);
        }
        let Some(first) = candidates.first() else {
            return Fitted::default();
        };
        let words: Vec<&str> = candidates.iter().map(|it| it.words.as_str()).collect();
        let words = words.join(", or ");
        let left = left(first.left);
        let sentence = if agrees {
            let with = match candidates.len() {
                1 => "this change",
                _ => "each of these changes",
            };
            format!("{words}: with {with} {AGREES}")
        } else {
            let place = self.place_of_rest(&first.predicted);
            let place = place.map_or(String::new(), |place| format!("; {place}"));
            format!("as if {words}, which leaves {left} of the squared difference{place}")
        };
        Fitted {
            sentence: Some(sentence),
            is_explained: candidates.iter().any(|it| it.is_explained),
            agrees,
            in_noise: candidates
                .iter()
                .filter(|it| it.agrees)
                .map(|it| it.in_noise)
                .min_by(f64::total_cmp),
        }
    }
}

impl<'f> Fitting<'f> {
    /// Renders the scene with each number changed by its step. Numbers that a verdict suspects are the
    /// only ones, if there are such.
    fn new(case: &'f ComparedCase, clock: &'f SearchClock<'f>) -> Option<Fitting<'f>> {
        let mut numbers = numbers(case.scene());
        if !case.is_sampled() {
            // In noise each would take many samples.
            let names: Vec<String> = numbers.iter().map(Number::name).collect();
            let place = numbers_of_place(case.scene()).into_iter();
            numbers.extend(place.filter(|number| !names.contains(&number.name())));
        }
        if !case.suspects.is_empty() {
            numbers.retain(|number| case.suspects.contains(&number.name()));
        }
        let unchanged = case.predicted_for_fit(case.scene(), UNCHANGED, clock)?;
        let [golden, test] = case.in_fit();
        let scale = golden.beside_noise_of(&unchanged);
        let guarded_test = test.guarded_by(golden);
        let mut fitting = Fitting {
            case,
            clock,
            unchanged,
            derivatives: Vec::new(),
            whole: golden.misfit(&guarded_test, &scale),
            weights: scale.weights(test),
            scale,
            golden: golden.values(),
            test: test.values(),
            guarded_test,
            numbers,
        };
        fitting.derivatives = (0..fitting.numbers.len())
            .map(|at| {
                let step = fitting.numbers[at].step;
                let sides = [step, -step].into_iter();
                let mut sides = sides.filter_map(|step| {
                    let moved = fitting.predicted(&[at], &[step])?.values();
                    Some(scaled(&difference(&moved, &fitting.golden), 1.0 / step))
                });
                sides.next()
            })
            .collect();
        Some(fitting)
    }

    /// Changes that explain most of the difference.
    fn candidates(&self) -> Vec<Candidate> {
        let mut candidates = Vec::new();
        let mut nearest = f64::INFINITY;
        for fit in self.best() {
            let fit = if self.case.is_sampled() {
                self.corrected(fit)
            } else {
                fit
            };
            // Where noise leaves it open how much is left, the verdict's own estimate is the better one.
            if !self.leaves(&fit.predicted, LEFT) {
                continue;
            }
            // Where the time is over nothing is known of it.
            let Some(closely) = self.closely(&fit) else {
                continue;
            };
            let whole = || {
                let changed = self.changed(&fit.numbers, &fit.changes)?;
                let label = self.label(&fit.numbers, &fit.changes);
                self.case.whole_of_scene(&changed, &label, self.clock)
            };
            let agrees = self.case.agrees_in_all(&closely, whole);
            // At an end of its range a fit was stopped, not found.
            if !agrees && self.is_at_an_end(&fit) {
                continue;
            }
            if agrees || fit.numbers.len() <= MOST_AS_IF {
                nearest = nearest.min(self.misfit(&fit.predicted).distance().at_most());
                candidates.push(Candidate {
                    words: self.in_words(&fit),
                    left: fit.left,
                    agrees,
                    in_noise: self.case.in_noise(&closely),
                    is_explained: self.leaves(&fit.predicted, self.case.may_leave()),
                    predicted: fit.predicted,
                });
            }
        }
        let of_values = GAINS.iter().filter_map(|gain| self.of_values(gain));
        candidates.extend(of_values.filter(|it| {
            self.leaves(&it.predicted, LEFT)
                && self.misfit(&it.predicted).distance().at_least() <= nearest
        }));
        candidates
    }

    /// The golden with the change of its values that is nearest to the image.
    fn of_values(&self, gain: &Gain) -> Option<Candidate> {
        let [golden, _] = self.case.in_fit();
        let derivative = golden.mapped(|value, c| (gain.derivative(value, c), 0.0));
        let derivative = derivative.values();
        let rest = difference(&self.test, &self.golden);
        let square = self.product(&derivative, &derivative);
        let change = self.product(&derivative, &rest) / square;
        let map = |value: f64, c: usize| {
            let slope = if gain.is_factor {
                1.0 + change * gain.channels[c]
            } else {
                1.0
            };
            (value + change * gain.derivative(value, c), slope)
        };
        let predicted = golden.mapped(map);
        let whole = || Some(mapped(&self.case.golden, map));
        let left = self
            .share_left(&predicted)
            .filter(|_| change.is_finite() && !(gain.is_factor && change <= -1.0))?;
        let errors = self.errors(&[derivative], &predicted);
        let unit = (!gain.is_factor).then_some("");
        Some(Candidate {
            words: change_in_words(gain.words, unit, change, Some(errors[0])),
            left: left.max(0.0),
            agrees: self.case.agrees_in_all(&predicted, whole),
            in_noise: self.case.in_noise(&predicted),
            is_explained: self.leaves(&predicted, self.case.may_leave()),
            predicted,
        })
    }

    /// True if a number of `fit` has so large a change that a fit may have been stopped there, not found.
    fn is_at_an_end(&self, fit: &Fit) -> bool {
        let mut changes = fit.numbers.iter().zip(&fit.changes);
        changes.any(|(&at, change)| match self.numbers[at].quantity.unit {
            Unit::Share => !(NEARBY[0]..NEARBY[1]).contains(change),
            Unit::Absolute(_) => range(&self.numbers[at]).contains(change),
        })
    }

    /// The scene rendered with the changes, in noise anew; nothing if the time is over.
    fn closely(&self, fit: &Fit) -> Option<Cells> {
        if !self.case.is_sampled() {
            return Some(fit.predicted.clone());
        }
        let changed = self.changed(&fit.numbers, &fit.changes)?;
        let label = self.label(&fit.numbers, &fit.changes);
        self.case.predicted_closely(&changed, &label, self.clock)
    }

    /// The fits that explain most: one alone, or those of single numbers that explain it as well.
    fn best(&self) -> Vec<Fit> {
        let rest = difference(&self.test, &self.golden);
        let alone = self.nearest(&rest, &[]).into_iter();
        let mut alone: Vec<Fit> = alone
            .filter_map(|at| self.fitted(&[at], &[0.0], 1.0))
            .collect();
        alone.sort_by(|a, b| a.left.total_cmp(&b.left));
        let is_enough = |fit: &Fit| {
            self.leaves(&fit.predicted, self.case.may_leave()) || fit.numbers.len() == TOGETHER
        };
        // Nothing need be near by itself for two to be.
        let mut together = None::<Fit>;
        loop {
            let now = together.as_ref().or(alone.first());
            if now.is_some_and(is_enough) {
                break;
            }
            let Some(more) = self.with_another(now) else {
                break;
            };
            together = Some(more);
        }
        match together {
            Some(together) => vec![self.without_insignificant(together)],
            None => {
                let least = alone.first().map(|fit| self.misfit(&fit.predicted));
                let least = least.map_or(f64::INFINITY, |least| least.distance().at_most());
                alone.retain(|fit| self.leaves(&fit.predicted, LEFT) && !self.is_worse(fit, least));
                alone
            }
        }
    }

    /// True if `predicted` leaves no more than this share, beyond doubt.
    fn leaves(&self, predicted: &Cells, share: f64) -> bool {
        self.misfit(predicted).explains_together(&self.whole, share)
    }

    /// True if `fit` leaves more than this distance, beyond doubt; without noise two numbers may
    /// well do the same.
    fn is_worse(&self, fit: &Fit, distance: f64) -> bool {
        self.case.is_sampled() && self.misfit(&fit.predicted).distance().at_least() > distance
    }

    fn misfit(&self, prediction: &Cells) -> Misfit {
        prediction.misfit(&self.guarded_test, &self.scale)
    }

    /// The share of the squared difference that `prediction` leaves.
    fn share_left(&self, prediction: &Cells) -> Option<f64> {
        self.misfit(prediction).share_of(&self.whole)
    }

    /// `fit` without numbers that hardly change.
    fn without_insignificant(&self, fit: Fit) -> Fit {
        let is_idle = |&i: &usize| fit.changes[i].abs() < BESIDE * fit.errors[i];
        let idle = (0..fit.numbers.len()).find(is_idle);
        let Some(idle) = idle.filter(|_| fit.numbers.len() > 1) else {
            return fit;
        };
        let (mut numbers, mut changes) = (fit.numbers.clone(), fit.changes.clone());
        numbers.remove(idle);
        changes.remove(idle);
        match self.fitted(&numbers, &changes, fit.left / WORTH_ANOTHER) {
            Some(simpler) => self.without_insignificant(simpler),
            None => fit,
        }
    }

    /// `fit` with the number beside it that leaves least, if that is worth another number.
    fn with_another(&self, fit: Option<&Fit>) -> Option<Fit> {
        let nothing = (Vec::new(), Vec::new());
        let (chosen, changes) =
            fit.map_or(nothing, |fit| (fit.numbers.clone(), fit.changes.clone()));
        let now = fit.map_or_else(|| self.golden.clone(), |fit| fit.predicted.values());
        let before = fit.map_or(1.0, |fit| fit.left);
        let others = self.nearest(&difference(&self.test, &now), &chosen);
        let with = |at: usize| {
            let numbers = [&chosen[..], &[at]].concat();
            self.fitted(&numbers, &[&changes[..], &[0.0]].concat(), before)
        };
        let least = others
            .into_iter()
            .filter_map(with)
            .min_by(|a, b| a.left.total_cmp(&b.left));
        least.filter(|fit| fit.left < WORTH_ANOTHER * before)
    }

    /// The numbers beside those `chosen` whose derivatives lead nearest along the `rest`.
    fn nearest(&self, rest: &Vector, chosen: &[usize]) -> Vec<usize> {
        let gain = |at: usize| {
            let mut across = self.derivatives[at].clone()?;
            let whole = self.product(&across, &across);
            for &other in chosen {
                let other = self.derivatives[other].as_ref()?;
                let part = self.product(&across, other) / self.product(other, other);
                across = difference(&across, &scaled(other, part));
            }
            let (along, square) = (self.product(&across, rest), self.product(&across, &across));
            // What lies along the others cannot be told from them.
            (square > 0.01 * whole).then_some((along * along / square, at))
        };
        let free = (0..self.numbers.len()).filter(|at| !chosen.contains(at));
        let mut gains: Vec<(f64, usize)> = free.filter_map(gain).collect();
        gains.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        gains.into_iter().take(TRIED).map(|(_, at)| at).collect()
    }

    /// The Gauss–Newton method for these numbers together, from these changes, which leave `before`;
    /// nothing where it leads nowhere.
    fn fitted(&self, chosen: &[usize], from: &[f64], before: f64) -> Option<Fit> {
        let derivatives = chosen.iter().map(|&at| self.derivatives[at].clone());
        let mut derivatives: Vec<Vector> = derivatives.collect::<Option<_>>()?;
        let mut changes = from.to_vec();
        let mut now = self.predicted(chosen, &changes)?;
        let mut left = self.share_left(&now)?;
        for _ in 0..STEPS {
            let mut step = self.step(&derivatives, &difference(&self.test, &now.values()))?;
            let mut halvings = 0;
            let (next, moved, next_left) = loop {
                let next = self.after(chosen, &changes, step);
                let in_steps = self.in_steps(chosen, &changes, &next);
                if in_steps.iter().all(|steps| steps.abs() < CLOSE) {
                    break (changes.clone(), now.clone(), left);
                }
                let moved = self.predicted(chosen, &next)?;
                self.update(&mut derivatives, chosen, &in_steps, (&now, &moved));
                let next_left = self.share_left(&moved)?;
                if next_left < left || halvings == HALVINGS {
                    break (next, moved, next_left);
                }
                step *= 0.5;
                halvings += 1;
            };
            if next_left >= left {
                break;
            }
            (changes, now, left) = (next, moved, next_left);
        }
        // The last step was not made.
        let last = chosen.iter().map(|&at| CLOSE * self.numbers[at].step);
        let errors = self.errors(&derivatives, &now);
        let errors = errors.iter().zip(last);
        (left < before).then(|| Fit {
            errors: errors
                .map(|(error, last)| (error * error + last * last).sqrt())
                .collect(),
            numbers: chosen.to_vec(),
            changes,
            predicted: now,
            left: left.max(0.0),
        })
    }

    /// The changes after a step, within their [`range`].
    fn after(&self, chosen: &[usize], changes: &[f64], step: DVec3) -> Vec<f64> {
        let of = chosen.iter().zip(changes).enumerate();
        of.map(|(i, (&at, change))| {
            let [least, most] = range(&self.numbers[at]);
            (change + step[i]).clamp(least, most)
        })
        .collect()
    }

    /// Difference of two sets of changes, in steps of the numbers.
    fn in_steps(&self, chosen: &[usize], from: &[f64], to: &[f64]) -> Vec<f64> {
        let of = chosen.iter().zip(from).zip(to);
        of.map(|((&at, from), to)| (to - from) / self.numbers[at].step)
            .collect()
    }

    /// Broyden's update: the least change of the derivatives, in steps of the numbers, that makes a step
    /// lead from one image to the other.
    fn update(
        &self,
        derivatives: &mut [Vector],
        chosen: &[usize],
        steps: &[f64],
        (from, to): (&Cells, &Cells),
    ) {
        let mut missed = difference(&to.values(), &from.values());
        let length: f64 = steps.iter().map(|steps| steps * steps).sum();
        for ((derivative, &at), steps) in derivatives.iter().zip(chosen).zip(steps) {
            missed = difference(&missed, &scaled(derivative, steps * self.numbers[at].step));
        }
        for ((derivative, &at), steps) in derivatives.iter_mut().zip(chosen).zip(steps) {
            let share = steps / length / self.numbers[at].step;
            *derivative = sum_of(derivative, &scaled(&missed, share));
        }
    }

    /// The changes that lead along `derivatives` nearest to the end of `rest`.
    fn step(&self, derivatives: &[Vector], rest: &Vector) -> Option<DVec3> {
        let along = |i: usize| derivatives.get(i).map_or(0.0, |d| self.product(d, rest));
        let step = self.squares(derivatives).inverse() * DVec3::from_array([0, 1, 2].map(along));
        step.is_finite().then_some(step)
    }

    /// Products of derivatives with each other.
    fn squares(&self, derivatives: &[Vector]) -> DMat3 {
        let mut squares = DMat3::IDENTITY;
        for (i, a) in derivatives.iter().enumerate() {
            for (j, b) in derivatives.iter().enumerate() {
                squares.col_mut(j)[i] = self.product(a, b);
            }
        }
        squares
    }

    /// Standard errors by what is left in each cell, whatever its cause (White 1980, Econometrica 48,
    /// 817–838). The channels of a cell may share their noise.
    fn errors(&self, derivatives: &[Vector], now: &Cells) -> Vec<f64> {
        let rest = difference(&self.test, &now.values());
        let inverse = self.squares(derivatives).inverse();
        let variances = inverse * self.spread(derivatives, &rest) * inverse;
        (0..derivatives.len())
            .map(|i| variances.col(i)[i].sqrt())
            .collect()
    }

    /// Sum over cells of the products of what the `rest` pulls along derivatives.
    fn spread(&self, derivatives: &[Vector], rest: &Vector) -> DMat3 {
        let mut spread = DMat3::ZERO;
        for cell in 0..rest.len() / 3 {
            let pull = |i: usize| {
                derivatives
                    .get(i)
                    .map_or(0.0, |d| self.in_cell(cell, d, rest))
            };
            let pull = DVec3::from_array([0, 1, 2].map(pull));
            spread += DMat3::from_cols(pull * pull.x, pull * pull.y, pull * pull.z);
        }
        spread
    }

    /// `fit` by derivatives of one seed and residuals of the other, so that their noise has nothing in
    /// common.
    fn corrected(&self, mut fit: Fit) -> Fit {
        let unknown = vec![f64::INFINITY; fit.numbers.len()];
        for _ in 0..CORRECTIONS {
            let Some((step, errors)) = self.correction(&fit) else {
                break;
            };
            let changes = self.after(&fit.numbers, &fit.changes, step);
            let Some(predicted) = self.predicted(&fit.numbers, &changes) else {
                break;
            };
            let steps: Vec<f64> = changes
                .iter()
                .zip(&fit.changes)
                .map(|(a, b)| a - b)
                .collect();
            fit.left = self.share_left(&predicted).unwrap_or(1.0).max(0.0);
            (fit.changes, fit.predicted) = (changes, predicted);
            if steps
                .iter()
                .zip(&errors)
                .all(|(step, error)| step.abs() <= *error)
            {
                let with_step = |(error, step): (&f64, &f64)| {
                    (error * error + CURVED * CURVED * step * step).sqrt()
                };
                fit.errors = errors.iter().zip(&steps).map(with_step).collect();
                return fit;
            }
        }
        fit.errors = unknown;
        fit
    }

    /// A step from the changes of `fit`, and the standard errors where it leads; nothing where noise hides
    /// the derivatives.
    fn correction(&self, fit: &Fit) -> Option<(DVec3, Vec<f64>)> {
        let now = self.predicted_by_seed(&fit.numbers, &fit.changes)?;
        let [first, second] = &now[..] else {
            return None;
        };
        let rest = [first, second].map(|now| difference(&self.test, now));
        let mut derivatives = [Vec::new(), Vec::new()];
        for (i, &at) in fit.numbers.iter().enumerate() {
            let mut sides = [1.0, -1.0].into_iter();
            let moved = sides.find_map(|side| {
                let mut changes = fit.changes.clone();
                changes[i] += side * self.numbers[at].step;
                let moved = self.predicted_by_seed(&fit.numbers, &changes)?;
                Some((side * self.numbers[at].step, moved))
            });
            let (step, moved) = moved?;
            for ((of_seed, moved), now) in derivatives.iter_mut().zip(&moved).zip(&now) {
                of_seed.push(scaled(&difference(moved, now), 1.0 / step));
            }
        }
        let (mut squares, mut along) = (DMat3::IDENTITY, DVec3::ZERO);
        let [a, b] = &derivatives;
        for i in 0..a.len() {
            let of_cells = (0..self.test.len() / 3).map(|cell| self.in_cell(cell, &a[i], &b[i]));
            let (sum, spread) = of_cells.fold((0.0, 0.0), |(sum, spread), square| {
                (sum + square, spread + square * square)
            });
            if sum <= KNOWN * spread.sqrt() {
                return None;
            }
            along[i] = 0.5 * (self.product(&a[i], &rest[1]) + self.product(&b[i], &rest[0]));
            for j in 0..a.len() {
                squares.col_mut(j)[i] =
                    0.5 * (self.product(&a[i], &b[j]) + self.product(&b[i], &a[j]));
            }
        }
        let inverse = squares.inverse();
        let step = inverse * along;
        // For the mean of both, which share the noise of the image.
        let mean = |a: &[Vector], b: &[Vector]| -> Vec<Vector> {
            a.iter()
                .zip(b)
                .map(|(a, b)| scaled(&sum_of(a, b), 0.5))
                .collect()
        };
        let rest = scaled(&sum_of(&rest[0], &rest[1]), 0.5);
        let variances = inverse * self.spread(&mean(a, b), &rest) * inverse.transpose();
        let errors = (0..a.len()).map(|i| variances.col(i)[i].sqrt()).collect();
        step.is_finite().then_some((step, errors))
    }

    /// The image with these changes: the golden, and what the changes make of the same random numbers.
    fn predicted(&self, chosen: &[usize], changes: &[f64]) -> Option<Cells> {
        let [golden, _] = self.case.in_fit();
        if changes.iter().all(|&change| change == 0.0) {
            return Some(golden.clone());
        }
        let changed = self.rendered(chosen, changes)?;
        Some(golden.moved(&self.unchanged, &changed))
    }

    /// The values of such an image by the random numbers of each seed.
    fn predicted_by_seed(&self, chosen: &[usize], changes: &[f64]) -> Option<Vec<Vector>> {
        let [golden, _] = self.case.in_fit();
        let changed = self.rendered(chosen, changes)?;
        let pairs = self.unchanged.chunks(1).zip(changed.chunks(1));
        Some(
            pairs
                .map(|(before, after)| golden.moved(before, after).values())
                .collect(),
        )
    }

    /// The scene with these changes, once for each seed.
    fn rendered(&self, chosen: &[usize], changes: &[f64]) -> Option<Vec<Cells>> {
        if self.clock.is_late() {
            return None;
        }
        let changed = self.changed(chosen, changes)?;
        let label = self.label(chosen, changes);
        self.case.predicted_for_fit(&changed, &label, self.clock)
    }

    fn label(&self, chosen: &[usize], changes: &[f64]) -> String {
        let changes = chosen.iter().zip(changes);
        let of = changes.map(|(&at, change)| format!("{}={change} ", self.numbers[at].name()));
        of.collect()
    }

    fn changed(&self, chosen: &[usize], changes: &[f64]) -> Option<Scene> {
        let mut scene = self.case.scene().clone();
        for (&at, &change) in chosen.iter().zip(changes) {
            scene = self.numbers[at].changed(&scene, change)?;
        }
        Some(scene)
    }

    /// A shift of the image in voxels of the volume.
    fn shift_in_voxels(&self, number: &Number, change: f64) -> Option<String> {
        let pixels = match &*number.name() {
            "camera.right" => [change, 0.0],
            "camera.down" => [0.0, change],
            _ => return None,
        };
        let seen = Seen {
            voxels: VolumeInView::of(self.case.scene())?.voxels(),
            ..Seen::default()
        };
        seen.voxels_in_words(pixels)
    }

    /// The part of a [`product`](Self::product) in one cell.
    fn in_cell(&self, cell: usize, a: &Vector, b: &Vector) -> f64 {
        let of = 3 * cell..3 * cell + 3;
        of.map(|at| self.weights[at] * a[at] * b[at]).sum()
    }

    fn product(&self, a: &Vector, b: &Vector) -> f64 {
        let terms = self.weights.iter().zip(a).zip(b);
        terms.map(|((weight, a), b)| weight * a * b).sum()
    }

    fn in_words(&self, fit: &Fit) -> String {
        let changes = fit.numbers.iter().enumerate().map(|(i, &at)| {
            let number = &self.numbers[at];
            let unit = number.quantity.unit.name();
            let error = Some(fit.errors[i]).filter(|error| error.is_finite());
            let mut words = change_in_words(&number.words(), unit, fit.changes[i], error);
            if number.name() == "camera.view"
                && let Some(scene) = self.changed(&[at], &[fit.changes[i]])
                && let Some(angle) = field_of_view(&scene)
            {
                words.push_str(&format!(" (a field of view of {angle:.2} degrees)"));
            }
            if let Some(voxels) = self.shift_in_voxels(number, fit.changes[i]) {
                words.push_str(&format!(" ({voxels})"));
            }
            words
        });
        let changes: Vec<String> = changes.collect();
        changes.join(" and ")
    }
}

/// A factor on values, or an offset, which is fitted beside the numbers of a scene.
struct Gain {
    words: &'static str,
    channels: [f64; 3],
    is_factor: bool,
}

const GAINS: [Gain; 5] = [
    Gain::factor("exposure", [1.0; 3]),
    Gain::factor("gain of red", [1.0, 0.0, 0.0]),
    Gain::factor("gain of green", [0.0, 1.0, 0.0]),
    Gain::factor("gain of blue", [0.0, 0.0, 1.0]),
    Gain {
        is_factor: false,
        ..Gain::factor("offset of all values", [1.0; 3])
    },
];

impl Gain {
    const fn factor(words: &'static str, channels: [f64; 3]) -> Gain {
        Gain {
            words,
            channels,
            is_factor: true,
        }
    }

    /// Derivative of a value of channel `c` by the change.
    fn derivative(&self, value: f64, c: usize) -> f64 {
        self.channels[c] * if self.is_factor { value } else { 1.0 }
    }
}

/// Field of view in degrees; `None` for an orthographic camera.
fn field_of_view(scene: &Scene) -> Option<f64> {
    let mut cameras = scene.panels.iter().filter_map(|panel| panel.model.camera());
    let camera = cameras.next().filter(|camera| !camera.is_orthographic())?;
    Some(camera.vertical_fov().to_degrees())
}

/// Range of the changes of a number in a fit.
fn range(number: &Number) -> [f64; 2] {
    match number.quantity.unit {
        Unit::Share => SHARES,
        Unit::Absolute(_) => [-1.0, 1.0].map(|side| side * FARTHEST * number.step),
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vector {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn sum_of(a: &[f64], b: &[f64]) -> Vector {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn scaled(a: &[f64], factor: f64) -> Vector {
    a.iter().map(|a| a * factor).collect()
}

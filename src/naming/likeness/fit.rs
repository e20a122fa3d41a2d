//! Numbers of the scene that may be off, fitted to an image that no mistake explains.
//!
//! A mistake of the catalogue is one edit; a volume that is a tenth too dense is none. The scene is
//! rendered with each of its [numbers](crate::sensitivity) changed a little, which gives the
//! derivatives of the image: the columns of its Jacobian. The numbers whose derivatives lead
//! nearest to the image are changed by the Gauss–Newton method, with an image rendered for every
//! step and Broyden's update of the Jacobian (of one number alone: secants). Where that leaves
//! much, a second number is changed beside the first, and a third. A fit is reported only if it
//! explains most of the difference: a measurement, not a name.

use super::clock::SearchClock;
use super::compared_case::ComparedCase;
use super::volume_in_view::VolumeInView;
use crate::compare::cells::{Cells, Misfit};
use crate::compare::{Seen, change_in_words, left};
use crate::scene::Scene;
use crate::sensitivity::{Number, Unit, numbers};
use glam::{DMat3, DVec3};

/// Largest share of the squared difference that reported changes may leave unexplained: a third of
/// the difference, root mean square. The sentence states what they leave.
pub(super) const LEFT: f64 = 0.1;

/// Largest number of candidates in a fit of one number, or of one more: those whose derivatives
/// lead nearest.
const TRIED: usize = 4;

/// Largest number of numbers fitted together: one image seldom tells more apart.
const TOGETHER: usize = 3;

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

/// Range of the fit: shares down to a quarter and up to four times a number, others this many of
/// their steps away.
const SHARES: [f64; 2] = [-0.75, 3.0];
const FARTHEST: f64 = 16.0;

/// Values of all channels of all cells.
type Vector = Vec<f64>;

/// Changes of numbers, and their residual.
struct Fit {
    /// Places in the list of numbers.
    numbers: Vec<usize>,
    /// Change of each, in its unit.
    changes: Vec<f64>,
    /// Standard errors of the changes.
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
    /// One for each fit.
    pub sentences: Vec<String>,
    /// True if one of them explains the image as well as a mistake must.
    pub is_explained: bool,
}

impl Fitted {
    /// Adds a sentence, and whether what it says explains the image.
    pub fn add(&mut self, found: Option<(String, bool)>) {
        if let Some((sentence, is_explained)) = found {
            self.sentences.push(sentence);
            self.is_explained |= is_explained;
        }
    }
}

impl ComparedCase {
    /// The changes of numbers that would explain the image.
    pub fn fitted_numbers(&self, clock: &SearchClock<'_>) -> Fitted {
        let mut fitted = Fitted::default();
        let Some(fitting) = Fitting::new(self, clock) else {
            return fitted;
        };
        for fit in fitting.best() {
            // Where noise leaves it open how much is left, the verdict's own estimate is the better one.
            if fitting.leaves(&fit, LEFT) {
                let sentence = explained_but_for(&fitting.in_words(&fit), fit.left);
                fitted.add(Some((sentence, fitting.leaves(&fit, self.may_leave()))));
            }
        }
        fitted
    }
}

/// The sentence that these words would explain all but a share of the squared difference.
pub(super) fn explained_but_for(words: &str, share: f64) -> String {
    let left = left(share);
    format!("{words} would explain all but {left} of the squared difference")
}

impl<'f> Fitting<'f> {
    /// Renders the scene with each number changed by its step. Numbers that a verdict suspects are the
    /// only ones, if there are such.
    fn new(case: &'f ComparedCase, clock: &'f SearchClock<'f>) -> Option<Fitting<'f>> {
        let mut numbers = numbers(case.scene());
        if !case.suspects.is_empty() {
            numbers.retain(|number| case.suspects.contains(&number.name()));
        }
        let unchanged = case.predicted_for_fit(case.scene(), "unchanged", clock)?;
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

    /// The fits that explain most: one alone, or those of single numbers that explain it as well.
    fn best(&self) -> Vec<Fit> {
        let rest = difference(&self.test, &self.golden);
        let alone = self.nearest(&rest, &[]).into_iter();
        let mut alone: Vec<Fit> = alone
            .filter_map(|at| self.fitted(&[at], &[0.0], 1.0))
            .collect();
        alone.sort_by(|a, b| a.left.total_cmp(&b.left));
        let is_enough =
            |fit: &Fit| self.leaves(fit, self.case.may_leave()) || fit.numbers.len() == TOGETHER;
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
                alone.retain(|fit| self.leaves(fit, LEFT) && !self.is_worse(fit, least));
                alone
            }
        }
    }

    /// True if `fit` leaves no more than this share, beyond doubt.
    fn leaves(&self, fit: &Fit, share: f64) -> bool {
        self.misfit(&fit.predicted)
            .explains_together(&self.whole, share)
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
        (left < before).then(|| Fit {
            errors: self.errors(chosen, &derivatives, &now),
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
    /// 817–838), and by the last step that was not made. The channels of a cell may share their noise.
    fn errors(&self, chosen: &[usize], derivatives: &[Vector], now: &Cells) -> Vec<f64> {
        let rest = difference(&self.test, &now.values());
        let mut spread = DMat3::ZERO;
        for cell in 0..rest.len() / 3 {
            let pull = |i: usize| -> f64 {
                let of = 3 * cell..3 * cell + 3;
                derivatives.get(i).map_or(0.0, |derivative| {
                    of.map(|at| self.weights[at] * derivative[at] * rest[at])
                        .sum()
                })
            };
            let pull = DVec3::from_array([0, 1, 2].map(pull));
            spread += DMat3::from_cols(pull * pull.x, pull * pull.y, pull * pull.z);
        }
        let inverse = self.squares(derivatives).inverse();
        let variances = inverse * spread * inverse;
        let of = (0..chosen.len()).map(|i| {
            let last = CLOSE * self.numbers[chosen[i]].step;
            (variances.col(i)[i] + last * last).sqrt()
        });
        of.collect()
    }

    /// The image with these changes: the golden, and what the changes make of the same random numbers.
    fn predicted(&self, chosen: &[usize], changes: &[f64]) -> Option<Cells> {
        let [golden, _] = self.case.in_fit();
        if changes.iter().all(|&change| change == 0.0) {
            return Some(golden.clone());
        }
        if self.clock.is_late() {
            return None;
        }
        let mut label = String::new();
        for (&at, change) in chosen.iter().zip(changes) {
            label.push_str(&format!("{}={change} ", self.numbers[at].name()));
        }
        let changed = self.changed(chosen, changes)?;
        let changed = self.case.predicted_for_fit(&changed, &label, self.clock)?;
        Some(golden.moved(&self.unchanged, &changed))
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

    fn product(&self, a: &Vector, b: &Vector) -> f64 {
        let terms = self.weights.iter().zip(a).zip(b);
        terms.map(|((weight, a), b)| weight * a * b).sum()
    }

    fn in_words(&self, fit: &Fit) -> String {
        let changes = fit.numbers.iter().enumerate().map(|(i, &at)| {
            let number = &self.numbers[at];
            let unit = number.quantity.unit.name();
            let mut words = change_in_words(&number.words(), unit, fit.changes[i], fit.errors[i]);
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

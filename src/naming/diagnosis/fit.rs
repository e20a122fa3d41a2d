//! Parameters of the scene that may be off, fitted to an image that no mistake explains.
//!
//! A mistake of the catalogue is one edit; a volume that is a tenth too dense is none. The scene is rendered with each
//! of its [parameters](crate::sensitivity) changed a little, which gives the derivatives of the image. The parameters
//! whose derivatives lead nearest to the image are changed by the Gauss–Newton method, with an image rendered for every
//! step and Broyden's update of the derivatives. Where that leaves much, a second parameter is changed beside the first,
//! and a third.
//!
//! A change is a finding only if the scene, rendered again with it, passes for the image: one that merely lies near is
//! "as if".
//!
//! In noise, the noise of a prediction is in its derivatives as well as in the residual, which biases a fit: no interval is
//! stated.

use super::clock::SearchClock;
use super::compared_case::ComparedCase;
use crate::compare::coarse::Coarse;
use crate::compare::unexplained::SquaredDistance;
use crate::compare::{change_in_words, left};
use crate::scene::Scene;
use crate::sensitivity::{Number, numbers, numbers_of_place};
use glam::{DMat3, DVec3};
use std::cell::OnceCell;

/// Largest share of the squared difference that reported changes may leave unexplained: a third of
/// the difference, root mean square. The sentence states what they leave.
const LEFT: f64 = 0.1;

/// The same of one that ends the search for others: a fiftieth, as of a mistake.
const ENOUGH: f64 = 0.02;

/// Largest number of candidates in a fit of one parameter, or of one more: those whose derivatives
/// lead nearest.
const TRIED: usize = 4;

/// Largest number of parameters fitted together: one image seldom tells more apart.
const TOGETHER: usize = 3;

/// Largest number of them that are said to be off, without that the scene agrees with the image: together
/// they come near what none of them made.
const MOST_AS_IF: usize = 2;

/// Largest share of the previous residual that a fit with another parameter may leave.
const WORTH_ANOTHER: f64 = 0.5;

/// Largest number of steps of a fit.
const STEPS: usize = 12;

/// Largest number of halvings of a step that leads away.
const HALVINGS: usize = 2;

/// Smallest change of a parameter beside another, in its standard errors.
const BESIDE: f64 = 4.0;

/// Share of the step of a parameter below which a step of the fit is the last: the sentence has no
/// more digits.
const CLOSE: f64 = 0.002;

/// Range of the fit: shares down to a twentieth and up to ten times a parameter, others this many of
/// their steps away. Near its ends a fit was stopped, not found.
const SHARES: [f64; 2] = [-0.95, 9.0];
const FARTHEST: f64 = 16.0;

/// Values of all channels.
type Vector = Vec<f64>;

/// Changes of parameters, and what they leave.
#[derive(Clone)]
struct Fit {
    /// Places in the list of parameters.
    chosen: Vec<usize>,
    /// Change of each, in its unit.
    changes: Vec<f64>,
    /// Standard errors of the changes; infinite where they are not known.
    errors: Vec<f64>,
    predicted: Coarse,
    left: SquaredDistance,
}

/// Report on changes of parameters.
#[derive(Debug, Default)]
pub(super) struct Fitted {
    /// The sentence that says most.
    pub sentence: Option<String>,
    /// True if the scene, rendered with the changes, passes for the image.
    pub agrees: bool,
    /// What they leave of the squared difference.
    pub left: f64,
}

/// Fits to the image of one case.
struct Fitting<'f> {
    case: &'f ComparedCase,
    clock: &'f SearchClock<'f>,
    parameters: Vec<Number>,
    /// The scene as it is.
    unchanged: OnceCell<Option<Coarse>>,
    /// Derivatives of the image by each parameter, where it has one.
    derivatives: Vec<Option<Vector>>,
}

impl ComparedCase {
    /// The changes of parameters that would explain the image: all that agree with it, or the one that lies nearest.
    pub fn fitted(&self, clock: &SearchClock<'_>) -> Fitted {
        let fitting = Fitting::new(self, clock);
        let mut fits: Vec<(Fit, bool)> = fitting
            .best()
            .into_iter()
            .filter_map(|fit| {
                let agrees = fitting.agrees(&fit)?;
                let is_near = fit.chosen.len() <= MOST_AS_IF && !fitting.is_at_an_end(&fit);
                (agrees || is_near).then_some((fit, agrees))
            })
            .collect();
        fits.sort_by(|(a, _), (b, _)| a.left.value.total_cmp(&b.left.value));
        let agrees = fits.iter().any(|(_, agrees)| *agrees);
        fits.retain(|(_, it)| *it == agrees);
        let Some((first, _)) = fits.first() else {
            return Fitted::default();
        };
        let share = (first.left.value / self.few.whole.value).max(0.0);
        let sentence = if agrees {
            let words: Vec<String> = fits.iter().map(|(fit, _)| fitting.in_words(fit)).collect();
            let with = match fits.len() {
                1 => "this change",
                _ => "each of these changes",
            };
            let words = words.join(", or ");
            format!("{words}: with {with} the scene agrees with the image")
        } else {
            let words = fitting.in_words(first);
            format!(
                "as if {words}, which leaves {} of the squared difference",
                left(share)
            )
        };
        Fitted {
            sentence: Some(sentence),
            agrees,
            left: first.left.value,
        }
    }
}

impl<'f> Fitting<'f> {
    /// Renders the scene with each parameter changed by its step. A verdict that suspects some
    /// leaves no others.
    fn new(case: &'f ComparedCase, clock: &'f SearchClock<'f>) -> Fitting<'f> {
        let mut parameters = numbers(case.scene());
        if !case.is_sampled {
            // In noise each would take many samples.
            let names: Vec<String> = parameters.iter().map(Number::name).collect();
            let place = numbers_of_place(case.scene()).into_iter();
            parameters.extend(place.filter(|it| !names.contains(&it.name())));
        }
        if !case.suspects.is_empty() {
            parameters.retain(|it| case.suspects.contains(&it.name()));
        }
        let mut fitting = Fitting {
            case,
            clock,
            unchanged: OnceCell::new(),
            derivatives: Vec::new(),
            parameters,
        };
        let golden = case.few.golden.values();
        let derivative = |at: usize| {
            let step = fitting.parameters[at].step;
            [step, -step].into_iter().find_map(|step| {
                let moved = fitting.predicted(&[at], &[step])?.values();
                Some(scaled(&difference(&moved, &golden), 1.0 / step))
            })
        };
        fitting.derivatives = (0..fitting.parameters.len()).map(derivative).collect();
        fitting
    }

    /// The fits that leave little: of one parameter, all that do as well; of several, the one that leaves least.
    fn best(&self) -> Vec<Fit> {
        let nothing = Fit {
            chosen: Vec::new(),
            changes: Vec::new(),
            errors: Vec::new(),
            predicted: self.case.few.golden.clone(),
            left: self.case.few.whole,
        };
        let alone = self.with_another(&nothing);
        let mut best = alone.first().cloned();
        while let Some(fit) = best.as_ref().filter(|it| !self.is_enough(it)) {
            let more = self.with_another(fit).into_iter().next();
            let more = more.filter(|more| {
                let mut changes = more.changes.iter().zip(&more.errors);
                more.left.value < WORTH_ANOTHER * fit.left.value
                    && changes.all(|(change, error)| change.abs() >= BESIDE * error)
            });
            match more {
                Some(more) => best = Some(more),
                None => break,
            }
        }
        let mut fits = match best {
            Some(together) if together.chosen.len() > 1 => vec![together],
            _ => alone,
        };
        fits.retain(|fit| self.leaves(fit, LEFT));
        if self.case.is_sampled {
            // The noise of derivatives biases a fit by what nobody knows.
            fits.iter_mut()
                .for_each(|fit| fit.errors.fill(f64::INFINITY));
        }
        let most = fits.iter().map(|fit| fit.left.at_most());
        let least = most.fold(f64::INFINITY, f64::min);
        // Without noise two parameters may well do the same.
        fits.retain(|fit| !self.case.is_sampled || fit.left.at_least() <= least);
        fits
    }

    /// True if a further parameter need not be changed, or may not.
    fn is_enough(&self, fit: &Fit) -> bool {
        fit.chosen.len() == TOGETHER || self.leaves(fit, ENOUGH)
    }

    /// True if `fit` leaves no more than this share, beyond doubt.
    fn leaves(&self, fit: &Fit, share: f64) -> bool {
        let whole = &self.case.few.whole;
        whole.at_least() > 0.0 && fit.left.is_explained(whole, share)
    }

    /// True if the scene, rendered again, passes for the image; nothing if the time is over.
    fn agrees(&self, fit: &Fit) -> Option<bool> {
        let changed = self.changed(&fit.chosen, &fit.changes)?;
        self.case.passes_with(&changed, self.clock)
    }

    /// True if a parameter of `fit` is changed so far that the fit may have been stopped there.
    fn is_at_an_end(&self, fit: &Fit) -> bool {
        let mut changes = fit.chosen.iter().zip(&fit.changes);
        changes.any(|(&at, change)| {
            let [least, most] = range(&self.parameters[at]);
            !(0.75 * least..0.75 * most).contains(change)
        })
    }

    /// Fits of `fit` with one parameter more, of those whose derivatives lead nearest along its residual; the one that
    /// leaves least first.
    fn with_another(&self, fit: &Fit) -> Vec<Fit> {
        let rest = difference(&self.case.few.test.values(), &fit.predicted.values());
        let gain = |at: usize| {
            let mut across = self.derivatives[at].clone()?;
            let whole = self.product(&across, &across);
            for &other in &fit.chosen {
                let other = self.derivatives[other].as_ref()?;
                let part = self.product(&across, other) / self.product(other, other);
                across = difference(&across, &scaled(other, part));
            }
            let (along, square) = (self.product(&across, &rest), self.product(&across, &across));
            // What lies along the others cannot be told from them.
            (square > 0.01 * whole).then_some((along * along / square, at))
        };
        let free = (0..self.parameters.len()).filter(|at| !fit.chosen.contains(at));
        let mut gains: Vec<(f64, usize)> = free.filter_map(gain).collect();
        gains.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let with = |(_, at): &(f64, usize)| {
            let chosen = [&fit.chosen[..], &[*at]].concat();
            self.refined(chosen, [&fit.changes[..], &[0.0]].concat(), fit)
        };
        let mut fits: Vec<Fit> = gains.iter().take(TRIED).filter_map(with).collect();
        fits.sort_by(|a, b| a.left.value.total_cmp(&b.left.value));
        fits
    }

    /// The Gauss–Newton method for these parameters together, from these changes of `before`; nothing where it leads
    /// nowhere.
    fn refined(&self, chosen: Vec<usize>, from: Vec<f64>, before: &Fit) -> Option<Fit> {
        let derivatives = chosen.iter().map(|&at| self.derivatives[at].clone());
        let mut derivatives: Vec<Vector> = derivatives.collect::<Option<_>>()?;
        let steps: Vec<f64> = chosen.iter().map(|&at| self.parameters[at].step).collect();
        let mut now = (from, before.predicted.clone(), before.left);
        'steps: for _ in 0..STEPS {
            let rest = difference(&self.case.few.test.values(), &now.1.values());
            let (mut step, _) = self.step(&derivatives, &rest)?;
            for _ in 0..=HALVINGS {
                let changes = self.after(&chosen, &now.0, step);
                let made: Vec<f64> = difference(&changes, &now.0);
                let is_small = |(made, step): (&f64, &f64)| made.abs() < CLOSE * step;
                if made.iter().zip(&steps).all(is_small) {
                    break 'steps;
                }
                let predicted = self.predicted(&chosen, &changes)?;
                update(&mut derivatives, &steps, &made, (&now.1, &predicted));
                let left = self.case.few.left(&predicted);
                if left.value < now.2.value {
                    now = (changes, predicted, left);
                    continue 'steps;
                }
                step *= 0.5;
            }
            break;
        }
        let (changes, predicted, left) = now;
        let rest = difference(&self.case.few.test.values(), &predicted.values());
        let (_, errors) = self.step(&derivatives, &rest)?;
        // The last step was not made.
        let with_last =
            |(error, step): (&f64, &f64)| (error * error + (CLOSE * step) * (CLOSE * step)).sqrt();
        (left.value < before.left.value).then(|| Fit {
            errors: errors.iter().zip(&steps).map(with_last).collect(),
            chosen,
            changes,
            predicted,
            left,
        })
    }

    /// The changes after a step, within their [`range`].
    fn after(&self, chosen: &[usize], changes: &[f64], step: DVec3) -> Vec<f64> {
        let of = chosen.iter().zip(changes).enumerate();
        of.map(|(i, (&at, change))| {
            let [least, most] = range(&self.parameters[at]);
            (change + step[i]).clamp(least, most)
        })
        .collect()
    }

    /// The changes that lead along `derivatives` nearest to the end of `rest`; and their standard errors by what is left in each block, whatever its cause (White 1980, Econometrica 48, 817–838).
    /// The channels of a block may share their noise.
    fn step(&self, derivatives: &[Vector], rest: &Vector) -> Option<(DVec3, Vec<f64>)> {
        let mut squares = DMat3::IDENTITY;
        for (i, a) in derivatives.iter().enumerate() {
            for (j, b) in derivatives.iter().enumerate() {
                squares.col_mut(j)[i] = self.product(a, b);
            }
        }
        let weights = &self.case.few.weights;
        let mut along = DVec3::ZERO;
        let mut spread = DMat3::ZERO;
        for block in 0..rest.len() / 3 {
            let pull = |i: usize| {
                let of = |d: &Vector| {
                    (3 * block..3 * block + 3)
                        .map(|at| weights[at] * d[at] * rest[at])
                        .sum()
                };
                derivatives.get(i).map_or(0.0, of)
            };
            let pull = DVec3::from_array([0, 1, 2].map(pull));
            along += pull;
            spread += DMat3::from_cols(pull * pull.x, pull * pull.y, pull * pull.z);
        }
        let inverse = squares.inverse();
        let step = inverse * along;
        let variances = inverse * spread * inverse.transpose();
        let errors = (0..derivatives.len())
            .map(|i| variances.col(i)[i].sqrt())
            .collect();
        step.is_finite().then_some((step, errors))
    }

    /// The image with these changes: the golden, and what the changes make of the same random numbers.
    fn predicted(&self, chosen: &[usize], changes: &[f64]) -> Option<Coarse> {
        if self.clock.is_late() {
            return None;
        }
        let rendered = |scene: &Scene| {
            let image = self.case.few_of(scene, self.clock)?;
            image.has_size_of(&self.case.few.golden).then_some(image)
        };
        let before = self
            .unchanged
            .get_or_init(|| rendered(self.case.scene()))
            .as_ref()?;
        let after = rendered(&self.changed(chosen, changes)?)?;
        Some(self.case.few.golden.moved(before, &after))
    }

    fn changed(&self, chosen: &[usize], changes: &[f64]) -> Option<Scene> {
        let mut scene = self.case.scene().clone();
        for (&at, &change) in chosen.iter().zip(changes) {
            scene = self.parameters[at].changed(&scene, change)?;
        }
        Some(scene)
    }

    fn product(&self, a: &Vector, b: &Vector) -> f64 {
        let terms = self.case.few.weights.iter().zip(a).zip(b);
        terms.map(|((weight, a), b)| weight * a * b).sum()
    }

    fn in_words(&self, fit: &Fit) -> String {
        let changes = fit.chosen.iter().enumerate().map(|(i, &at)| {
            let parameter = &self.parameters[at];
            let error = Some(fit.errors[i]).filter(|error| error.is_finite());
            change_in_words(&parameter.words(), parameter.unit, fit.changes[i], error)
        });
        changes.collect::<Vec<_>>().join(" and ")
    }
}

/// Broyden's update: the least change of the derivatives, in steps of the parameters, that makes the step which was
/// `made` lead from one image to the other.
fn update(derivatives: &mut [Vector], steps: &[f64], made: &[f64], (from, to): (&Coarse, &Coarse)) {
    let mut missed = difference(&to.values(), &from.values());
    for (derivative, made) in derivatives.iter().zip(made) {
        missed = difference(&missed, &scaled(derivative, *made));
    }
    let shares = made.iter().zip(steps).map(|(made, step)| made / step);
    let length: f64 = shares.map(|share| share * share).sum();
    for ((derivative, made), step) in derivatives.iter_mut().zip(made).zip(steps) {
        let share = -made / (step * step) / length;
        *derivative = difference(derivative, &scaled(&missed, share));
    }
}

/// Range of the changes of a parameter in a fit.
fn range(parameter: &Number) -> [f64; 2] {
    match parameter.unit {
        None => SHARES,
        Some(_) => [-1.0, 1.0].map(|side| side * FARTHEST * parameter.step),
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vector {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn scaled(a: &[f64], factor: f64) -> Vector {
    a.iter().map(|a| a * factor).collect()
}

//! Registration: the place, size and turn of a volume that would explain an image, however far they are off.
//!
//! Derivatives at the scene as it is lead to the image only from nearby. So image and renderings are blurred first,
//! by less and less (coarse to fine: Lucas & Kanade 1981, "An iterative image registration technique"); each step is
//! one of Levenberg and Marquardt, by differences of renderings where the last step has led.

use super::clock::SearchClock;
use super::compared_case::ComparedCase;
use super::fit::{Candidate, Fitted, LEFT};
use crate::compare::cells::Cells;
use crate::compare::change_in_words;
use crate::geometry::Transform;
use crate::math::atan2;
use crate::scene::Scene;
use crate::sensitivity::{Number, Unit, numbers_of_place};
use glam::DVec3;

/// Numbers that are sought together, one set after the other until one explains the image.
const SETS: [&[&str]; 4] = [
    &["grid"],
    &["grid", "turn"],
    &["grid", "size"],
    &["grid", "turn", "size"],
];

/// Radii of the blur, in parts of the width of the image.
const RADII: [f64; 4] = [1.0 / 6.0, 1.0 / 12.0, 1.0 / 24.0, 0.0];

/// The radii to go through: where a blur leaves little to go by, as of a turn alone, its steps lead astray.
const STARTS: [&[f64]; 2] = [&RADII, &[RADII[2], RADII[3]]];

/// Largest number of steps at each radius, but for those of more than [`CLOSE`] at the last.
const STEPS: usize = 5;
const LAST_STEPS: usize = 12;

/// Differences of a blurred image are over this many steps of a number.
const COARSE: f64 = 5.0;

/// Share of the step of a number below which a step is the last.
const CLOSE: f64 = 0.002;

/// Smallest change of a number that is stated, in its steps.
const LEAST: f64 = 0.2;

/// Share of the squared difference of blurred images beyond which no place of the volume is looked for any longer.
const WORTH_GOING_ON: f64 = 0.25;

/// First damping, and the factors after steps that lead nearer and away.
const DAMPING: f64 = 1e-3;
const NEARER: f64 = 0.2;
const AWAY: f64 = 10.0;

/// Damping beyond which no step leads nearer.
const MOST_DAMPING: f64 = 1e3;

/// Kind of a number: `grid` of `grid.x`.
fn kind(number: &Number) -> &str {
    number.quantity.name.split('.').next().unwrap_or_default()
}

/// Pixels of all channels.
type Values = Vec<f64>;

impl ComparedCase {
    /// The place, size or turn of the volume, if it explains most of the difference. Nothing in noise, where each step
    /// would take many samples.
    pub fn fitted_place(&self, clock: &SearchClock<'_>) -> Fitted {
        if self.is_sampled() {
            return Fitted::default();
        }
        let all = numbers_of_place(self.scene());
        if all.is_empty() {
            return Fitted::default();
        }
        let found = STARTS.iter().find_map(|radii| {
            SETS.iter().find_map(|set| {
                let of_set = all.iter().filter(|number| set.contains(&kind(number)));
                Registration::new(self, of_set.cloned().collect(), clock).candidate(radii)
            })
        });
        self.report(found.into_iter().collect())
    }
}

struct Registration<'r> {
    case: &'r ComparedCase,
    clock: &'r SearchClock<'r>,
    numbers: Vec<Number>,
    test: Values,
    columns: usize,
}

impl<'r> Registration<'r> {
    fn new(case: &'r ComparedCase, numbers: Vec<Number>, clock: &'r SearchClock<'r>) -> Self {
        let [_, test] = case.in_fit();
        Registration {
            case,
            clock,
            numbers,
            test: test.values(),
            columns: test.columns,
        }
    }

    /// Changes that explain most of the difference; nothing if the time is over.
    fn candidate(&self, radii: &[f64]) -> Option<Candidate> {
        let mut changes = vec![0.0; self.numbers.len()];
        let mut last = vec![0.0; self.numbers.len()];
        for &part in radii {
            let radius = (part * self.columns as f64).round() as usize;
            let left;
            (changes, last, left) = self.nearest(changes, radius)?;
            // Blurred more, small parts and turns leave nothing to go by.
            if part <= RADII[2] && left > WORTH_GOING_ON {
                return None;
            }
        }
        let is_stated = |at: usize| changes[at].abs() >= LEAST * self.numbers[at].step;
        let turns = (0..changes.len()).any(|at| is_stated(at) && self.is_turn(at));
        let is_kept = |at: &usize| is_stated(*at) || turns && self.is_turn(*at);
        let kept: Vec<usize> = (0..changes.len()).filter(is_kept).collect();
        let numbers = kept.iter().map(|&at| self.numbers[at].clone()).collect();
        let of_kept = Registration::new(self.case, numbers, self.clock);
        let changes = kept.iter().map(|&at| changes[at]).collect();
        if kept.len() == last.len() {
            return of_kept.stated(changes, last);
        }
        // Without those that hardly changed the others have another place.
        let (changes, last, _) = of_kept.nearest(changes, 0)?;
        of_kept.stated(changes, last)
    }

    /// The report on changes of all numbers, if they explain most of the difference.
    fn stated(&self, changes: Vec<f64>, last: Vec<f64>) -> Option<Candidate> {
        let predicted = self.predicted(&changes)?;
        let worth_saying =
            !changes.is_empty() && self.case.is_explained_but_for(&predicted, LEFT)?;
        let whole = || {
            let edited = self.changed(&changes)?;
            self.case
                .whole_of_scene(&edited, &self.label(&changes), self.clock)
        };
        let agrees = self.case.agrees_in_all(&predicted, whole);
        // No interval holds for a change that merely comes near.
        let error = |at: usize| last[at].abs().max(CLOSE * self.numbers[at].step);
        let errors: Vec<Option<f64>> = (0..changes.len())
            .map(|at| agrees.then(|| error(at)))
            .collect();
        worth_saying.then_some(Candidate {
            words: self.in_words(&changes, &errors),
            left: self.case.share_left(&predicted)?.max(0.0),
            agrees,
            in_noise: self.case.in_noise(&predicted),
            is_explained: self
                .case
                .is_explained_but_for(&predicted, self.case.may_leave())?,
            predicted,
        })
    }

    fn is_turn(&self, at: usize) -> bool {
        kind(&self.numbers[at]) == "turn"
    }

    /// The changes in words: three turns as the one that they are together.
    fn in_words(&self, changes: &[f64], errors: &[Option<f64>]) -> String {
        let others = (0..changes.len()).filter(|&at| !self.is_turn(at));
        let mut words: Vec<String> = others
            .map(|at| {
                let number = &self.numbers[at];
                let unit = number.quantity.unit.name();
                change_in_words(&number.words(), unit, changes[at], errors[at])
            })
            .collect();
        let turns: Vec<usize> = (0..changes.len()).filter(|&at| self.is_turn(at)).collect();
        if let [x, y, z] = turns[..] {
            let (angle, axis) = together([x, y, z].map(|at| changes[at]));
            let error = errors[x].map(|_| {
                let errors = turns.iter().filter_map(|&at| errors[at]);
                errors.fold(0.0, f64::max)
            });
            let by = change_in_words("turn of the volume", Some("degrees"), angle, error);
            // No minus before what is rounded to 0.
            let [x, y, z] = axis.to_array().map(|x| (1e3 * x).round() / 1e3 + 0.0);
            words.push(format!("{by} about ({x:.3}, {y:.3}, {z:.3})"));
        }
        words.join(" and ")
    }

    /// The changes, from these on, that lead nearest to the image, both blurred; the last step; and the share of the
    /// squared difference from the golden that is left.
    fn nearest(&self, mut changes: Vec<f64>, radius: usize) -> Option<(Vec<f64>, Vec<f64>, f64)> {
        let test = blurred(&self.test, self.columns, radius);
        let rest = |values: &Values| -> Values {
            let values = blurred(values, self.columns, radius);
            values
                .iter()
                .zip(&test)
                .map(|(now, test)| test - now)
                .collect()
        };
        let (scale, most) = match radius {
            0 => (1.0, LAST_STEPS),
            _ => (COARSE, STEPS),
        };
        let mut now = rest(&self.rendered(&changes)?);
        let squares = |a: &Values| -> f64 { a.iter().map(|x| x * x).sum() };
        let whole = squares(&rest(&self.case.in_fit()[0].values()));
        let mut damping = DAMPING;
        let mut last = vec![0.0; changes.len()];
        for _ in 0..most {
            let mut derivatives = Vec::new();
            for at in 0..changes.len() {
                let mut moved = changes.clone();
                moved[at] += scale * self.numbers[at].step;
                let moved = rest(&self.rendered(&moved)?);
                derivatives.push(
                    now.iter()
                        .zip(&moved)
                        .map(|(a, b)| a - b)
                        .collect::<Values>(),
                );
            }
            let before = squares(&now);
            loop {
                let step = damped_step(&derivatives, &now, damping)?;
                let step: Vec<f64> = (0..step.len())
                    .map(|at| step[at] * scale * self.numbers[at].step)
                    .collect();
                let next: Vec<f64> = changes.iter().zip(&step).map(|(a, b)| a + b).collect();
                let seen = self.rendered(&next).map(|seen| rest(&seen));
                if let Some(seen) = seen.filter(|seen| squares(seen) < before) {
                    (changes, now, last) = (next, seen, step);
                    damping *= NEARER;
                    break;
                }
                if self.clock.is_late() {
                    return None;
                }
                damping *= AWAY;
                if damping > MOST_DAMPING {
                    return Some((changes, last, before / whole));
                }
            }
            let is_close = |at: usize| last[at].abs() < CLOSE * self.numbers[at].step;
            if (0..last.len()).all(is_close) {
                break;
            }
        }
        Some((changes, last, squares(&now) / whole))
    }

    fn changed(&self, changes: &[f64]) -> Option<Scene> {
        let mut scene = self.case.scene().clone();
        for (number, &change) in self.numbers.iter().zip(changes) {
            if number.quantity.unit == Unit::Share && change <= -1.0 {
                return None;
            }
            if change != 0.0 {
                scene = number.changed(&scene, change)?;
            }
        }
        Some(scene)
    }

    fn rendered(&self, changes: &[f64]) -> Option<Values> {
        Some(self.predicted(changes)?.values())
    }

    fn predicted(&self, changes: &[f64]) -> Option<Cells> {
        if self.clock.is_late() {
            return None;
        }
        let edited = self.changed(changes)?;
        let label = self.label(changes);
        let cells = self.case.predicted_with(&edited, &label, self.clock)?;
        cells.has_size_of(self.case.in_fit()[0]).then_some(cells)
    }

    fn label(&self, changes: &[f64]) -> String {
        let of = self.numbers.iter().zip(changes);
        of.map(|(number, change)| format!("{}={change} ", number.name()))
            .collect()
    }
}

/// Angle, degrees, and axis of turns about x, then y, then z by these angles.
fn together(angles: [f64; 3]) -> (f64, DVec3) {
    let turned = |axis: DVec3| {
        (0..3).fold(axis, |vector, about| {
            let turn = Transform::rotation(DVec3::AXES[about], angles[about]);
            turn.map_or(vector, |turn| turn.vector(vector))
        })
    };
    let [x, y, z] = DVec3::AXES.map(turned);
    // Twice the sine along the axis, and one more than twice the cosine.
    let along = DVec3::new(y.z - z.y, z.x - x.z, x.y - y.x);
    let angle = atan2(along.length(), x.x + y.y + z.z - 1.0);
    (angle.to_degrees(), along.normalize_or_zero())
}

/// The step that leads nearest to the end of `rest`, by `derivatives`, with the diagonal of their squares damped.
fn damped_step(derivatives: &[Values], rest: &Values, damping: f64) -> Option<Vec<f64>> {
    let product = |a: &Values, b: &Values| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let size = derivatives.len();
    let mut rows: Vec<Vec<f64>> = (0..size)
        .map(|i| {
            let mut row: Vec<f64> = derivatives
                .iter()
                .map(|d| product(&derivatives[i], d))
                .collect();
            row[i] *= 1.0 + damping;
            row.push(product(&derivatives[i], rest));
            row
        })
        .collect();
    // Gauss's elimination: positive definite, so that no pivot is sought.
    for i in 0..size {
        let pivot = rows[i].clone();
        if pivot[i] <= 0.0 {
            return None;
        }
        for (_, row) in rows.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            let factor = row[i] / pivot[i];
            row.iter_mut()
                .zip(&pivot)
                .for_each(|(x, p)| *x -= factor * p);
        }
    }
    let step: Vec<f64> = (0..size).map(|i| rows[i][size] / rows[i][i]).collect();
    step.iter().all(|x| x.is_finite()).then_some(step)
}

/// Means over squares of `2 · radius + 1` pixels, those beyond the edges left out, made twice.
fn blurred(values: &Values, columns: usize, radius: usize) -> Values {
    if radius == 0 {
        return values.clone();
    }
    let rows = values.len() / 3 / columns;
    let along = |values: &Values, count: usize, stride: usize| -> Values {
        let mut means = vec![0.0; values.len()];
        for (at, mean) in means.iter_mut().enumerate() {
            let place = at / stride % count;
            let (first, last) = (
                place.saturating_sub(radius),
                (place + radius).min(count - 1),
            );
            let sum: f64 = (first..=last)
                .map(|other| values[at - place * stride + other * stride])
                .sum();
            *mean = sum / (last - first + 1) as f64;
        }
        means
    };
    let once = |values: &Values| along(&along(values, columns, 3), rows, 3 * columns);
    once(&once(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_solves_the_normal_equations() {
        let derivatives = vec![vec![1.0, 0.0, 1.0], vec![0.0, 2.0, 1.0]];
        // 3 and -1 of them.
        let rest = vec![3.0, -2.0, 2.0];
        let step = damped_step(&derivatives, &rest, 0.0).unwrap();
        assert!((step[0] - 3.0).abs() < 1e-14 && (step[1] + 1.0).abs() < 1e-14);
        assert_eq!(damped_step(&[vec![0.0; 3]], &rest, 0.0), None);
    }

    #[test]
    fn turns_one_after_the_other_are_one() {
        let (angle, axis) = together([0.0, -30.0, 0.0]);
        assert!((angle - 30.0).abs() < 1e-12 && (axis + DVec3::Y).length() < 1e-12);
        // Quarter turns about x and then y take x to -z, y to x and z to -y: a third about (1, 1, -1).
        let (angle, axis) = together([90.0, 90.0, 0.0]);
        let expected = DVec3::new(1.0, 1.0, -1.0) / 3_f64.sqrt();
        assert!((angle - 120.0).abs() < 1e-12 && (axis - expected).length() < 1e-12);
    }

    #[test]
    fn a_blur_keeps_constants_and_spreads_points() {
        let constant = vec![2.5; 5 * 4 * 3];
        assert_eq!(blurred(&constant, 5, 1), constant);
        let mut point = vec![0.0; 9 * 9 * 3];
        point[3 * (4 + 9 * 4)] = 81.0;
        let spread = blurred(&point, 9, 1);
        // Twice the mean of three along each axis: weights 1, 2, 3, 2, 1 over 9.
        assert!((spread[3 * (4 + 9 * 4)] - 9.0).abs() < 1e-12);
        assert!((spread[3 * (2 + 9 * 4)] - 3.0).abs() < 1e-12);
        assert_eq!(spread[3 * (1 + 9 * 4)], 0.0);
    }
}

//! Samples along a ray.

use crate::geometry::Span;
use crate::scene::{Conventions, Fault, FittedSteps, LastStep, StepLength};
use glam::DVec3;

/// Places of samples and lengths of steps.
#[derive(Clone, Copy, Debug)]
pub struct StepRule {
    /// Position of a sample within its step, in steps: 0.5 is the middle.
    pub position: f64,
    /// Length of the first step, in steps.
    pub first: f64,
    /// Treatment of the step that is cut off.
    pub last: LastStep,
    /// Whole number of steps instead.
    pub fitted: FittedSteps,
    /// The last sample lies at the end of the span.
    pub ends_on_face: bool,
    /// A span has a sample, even if it ends before that.
    pub one_sample: bool,
}

impl StepRule {
    /// Steps of one length with a sample at `position`, the last one cut off.
    pub fn at(position: f64) -> StepRule {
        StepRule {
            position,
            first: 1.0,
            last: LastStep::Exact,
            fitted: FittedSteps::None,
            ends_on_face: false,
            one_sample: false,
        }
    }

    /// The rule of `conventions`.
    pub fn of(conventions: &Conventions) -> StepRule {
        StepRule {
            last: conventions.last_step,
            fitted: conventions.fitted_steps,
            ends_on_face: conventions.last_sample_on_face,
            one_sample: conventions.one_sample,
            first: match conventions.fault {
                Some(Fault::FirstStep(length)) => length,
                _ => 1.0,
            },
            position: conventions.first_sample,
        }
    }
}

/// Length in the world of steps of length `step` by `measure`, along `direction`, through a volume with
/// this distance between nodes and of this size, all in the coordinates of the volume; `voxel` and `longest`
/// are the lengths of a voxel and of the longest side in the world.
pub fn step_in_world(
    step: f64,
    measure: StepLength,
    direction: DVec3,
    [spacing, size]: [DVec3; 2],
    [voxel, longest]: [f64; 2],
) -> f64 {
    let nodes = direction / spacing;
    let voxels = step / voxel;
    match measure {
        StepLength::World => step,
        StepLength::Voxels => voxels / nodes.length(),
        StepLength::MainAxis => voxels / nodes.abs().max_element(),
        StepLength::Texture => step / longest / (direction / size).length(),
        StepLength::Volume => step / direction.length(),
    }
}

/// The samples along a span of a ray, one in each step.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    span: Span,
    rule: StepRule,
    /// Length of a whole step, > 0.
    pub step: f64,
    /// Number of steps.
    pub count: usize,
    /// The last step ends with the span.
    is_last_cut: bool,
}

impl Steps {
    /// Steps of length `step`. At least one where the span has a length and the last step is exact,
    /// even if the quotient of both underflows.
    pub fn new(span: Span, step: f64, rule: StepRule) -> Steps {
        let steps = span.length() / step;
        let fitted = match rule.fitted {
            FittedSteps::None => return Steps::unfitted(span, step, rule),
            FittedSteps::Rounded => steps.round(),
            FittedSteps::Up => steps.ceil(),
            FittedSteps::Down => steps.floor(),
        };
        Steps {
            span,
            rule,
            // Without a step its length is of no interest.
            step: span.length() / fitted.max(1.0),
            count: fitted as usize,
            is_last_cut: false,
        }
    }

    fn unfitted(span: Span, step: f64, rule: StepRule) -> Steps {
        let steps = span.length() / step;
        let is_long = steps > 1.0;
        // As if the first step were a whole one.
        let steps = if is_long {
            steps + (1.0 - rule.first)
        } else {
            steps
        };
        let count = match rule.last {
            _ if rule.one_sample && !is_long => 1.0,
            LastStep::Exact if span.length() > 0.0 => steps.ceil().max(1.0),
            LastStep::Exact => steps.ceil(),
            // As many as have their sample inside.
            LastStep::Whole => (steps - rule.position).floor() + 1.0,
            LastStep::Dropped => steps.floor(),
        };
        Steps {
            span,
            rule,
            step,
            count: count as usize,
            is_last_cut: rule.last == LastStep::Exact,
        }
    }

    /// Distance of sample `index` along the ray, and the length of its step. Computed from the index,
    /// because adding up lengths would accumulate rounding errors.
    pub fn sample(&self, index: usize) -> (f64, f64) {
        let Steps { span, rule, .. } = *self;
        let is_last = index + 1 == self.count;
        let (begin, length) = if index == 0 {
            (0.0, rule.first)
        } else {
            (index as f64 + (rule.first - 1.0), 1.0)
        };
        let (t, length) = if is_last && self.is_last_cut {
            let begin = begin * self.step;
            let rest = (span.length() - begin).max(0.0);
            (span.near + (begin + rule.position * rest), rest)
        } else {
            let place = begin + rule.position * length;
            (span.near + place * self.step, length * self.step)
        };
        if is_last && index > 0 && rule.ends_on_face {
            (span.far, length)
        } else {
            (t, length)
        }
    }
}

/// Steps counted anew in each of the parts of a span.
#[derive(Clone, Debug)]
pub struct StepsInParts {
    /// Steps of each part, with the number of those before.
    parts: Vec<(usize, Steps)>,
    /// Number of steps.
    pub count: usize,
    /// Length of a whole step in the first part, > 0.
    pub step: f64,
}

impl StepsInParts {
    /// Steps of length `step` from the beginning of `span` on, and from each of the `cuts` in it, in rising order.
    pub fn new(span: Span, step: f64, rule: StepRule, cuts: &[f64]) -> StepsInParts {
        let begins = std::iter::once(span.near).chain(cuts.iter().copied());
        let ends = cuts.iter().copied().chain([span.far]);
        let mut count = 0;
        let parts = begins.zip(ends).map(|(begin, end)| {
            let steps = Steps::new(Span::new(begin, end), step, rule);
            let before = count;
            count += steps.count;
            (before, steps)
        });
        let parts: Vec<(usize, Steps)> = parts.collect();
        let step = parts[0].1.step;
        StepsInParts { parts, count, step }
    }

    /// As [`Steps::sample`].
    pub fn sample(&self, index: usize) -> (f64, f64) {
        let part = self.parts.partition_point(|(before, _)| *before <= index);
        let (before, steps) = self.parts[part - 1];
        steps.sample(index - before)
    }
}

/// The steps of a ray over `span`, which a surface or a clip may end before the volume does, at `far`; and how many of
/// them are taken.
pub fn taken(
    conventions: &Conventions,
    span: Span,
    far: f64,
    steps_over: impl Fn(Span) -> StepsInParts,
) -> (StepsInParts, usize) {
    let mut steps = steps_over(span);
    let mut count = steps.count;
    if conventions.sample_behind_ends && span.far < far {
        steps = steps_over(Span::new(span.near, far));
        count = steps.count.min(count + 1);
    }
    if let Some(Fault::MostSteps(most)) = conventions.fault {
        count = count.min(most as usize);
    }
    (steps, count)
}

/// Distances within `span` at which a ray enters another brick of `edge` cells, from the node coordinates of both ends.
pub fn brick_faces(span: Span, [near, far]: [DVec3; 2], edge: u32) -> Vec<f64> {
    let edge = f64::from(edge);
    let mut faces = Vec::new();
    for axis in 0..3 {
        let (a, b) = (near[axis], far[axis]);
        let bricks = (a.min(b) / edge).floor() as i64 + 1..(a.max(b) / edge).ceil() as i64;
        faces.extend(bricks.map(|brick| {
            let share = (brick as f64 * edge - a) / (b - a);
            span.near + share * span.length()
        }));
    }
    faces.sort_by(f64::total_cmp);
    faces.dedup();
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions and lengths of the samples over a span of length 1.
    fn samples(step: f64, position: f64, last_step: LastStep) -> Vec<(f64, f64)> {
        let last = last_step;
        let rule = StepRule {
            last,
            ..StepRule::at(position)
        };
        all(step, rule)
    }

    fn all(step: f64, rule: StepRule) -> Vec<(f64, f64)> {
        let steps = Steps::new(Span::new(2.0, 3.0), step, rule);
        (0..steps.count).map(|index| steps.sample(index)).collect()
    }

    #[test]
    fn the_last_step_is_cut_off_counted_whole_or_dropped() {
        use LastStep::*;
        // Powers of two: no rounding. The span has 2.5 steps.
        let step = 0.375;
        for (position, last_step, expected) in [
            (
                0.5,
                Exact,
                vec![(2.1875, step), (2.5625, step), (2.875, 0.25)],
            ),
            (0.0, Exact, vec![(2.0, step), (2.375, step), (2.75, 0.25)]),
            (1.0, Exact, vec![(2.375, step), (2.75, step), (3.0, 0.25)]),
            (0.0, Whole, vec![(2.0, step), (2.375, step), (2.75, step)]),
            (
                0.5,
                Whole,
                vec![(2.1875, step), (2.5625, step), (2.9375, step)],
            ),
            (1.0, Whole, vec![(2.375, step), (2.75, step)]),
            (0.0, Dropped, vec![(2.0, step), (2.375, step)]),
            (1.0, Dropped, vec![(2.375, step), (2.75, step)]),
        ] {
            assert_eq!(
                samples(step, position, last_step),
                expected,
                "{position} {last_step:?}"
            );
        }
        // Longer than the span, and as long as it.
        assert_eq!(samples(4.0, 0.5, Exact), [(2.5, 1.0)]);
        assert_eq!(samples(4.0, 0.5, Whole), []);
        assert_eq!(samples(4.0, 0.5, Dropped), []);
        assert_eq!(samples(1.0, 1.0, Whole), [(3.0, 1.0)]);
    }

    #[test]
    fn a_short_first_step_and_a_sample_on_the_back_face() {
        let rule = StepRule {
            first: 0.25,
            ends_on_face: true,
            ..StepRule::at(0.0)
        };
        let step = 0.375;
        let first = 0.25 * step;
        let expected = [
            (2.0, first),
            (2.0 + first, step),
            (2.0 + first + step, step),
            (3.0, 1.0 - first - 2.0 * step),
        ];
        assert_eq!(all(step, rule), expected);
        // Longer than the span: one step, over all of it.
        assert_eq!(all(8.0, rule), [(2.0, 1.0)]);
    }

    #[test]
    fn a_sample_behind_the_span() {
        let one_sample = |last| StepRule {
            last,
            one_sample: true,
            ..StepRule::at(1.0)
        };
        assert_eq!(all(8.0, one_sample(LastStep::Whole)), [(10.0, 8.0)]);
        assert_eq!(all(0.75, one_sample(LastStep::Whole)), [(2.75, 0.75)]);
    }

    #[test]
    fn steps_begin_anew_in_each_part() {
        let rule = StepRule::at(0.5);
        let span = Span::new(2.0, 3.0);
        // From node 1.5 to node 4.5 along x, back along y: faces of bricks of two cells at 2 and 4.
        let ends = [DVec3::new(1.5, 4.0, 1.0), DVec3::new(4.5, 1.0, 1.0)];
        let cuts = brick_faces(span, ends, 2);
        let expected = [2.0 + 0.5 / 3.0, 2.0 + 2.0 / 3.0, 2.0 + 2.5 / 3.0];
        assert_eq!(cuts.len(), 3);
        assert!(
            cuts.iter()
                .zip(expected)
                .all(|(cut, right)| (cut - right).abs() < 1e-15)
        );
        let steps = StepsInParts::new(span, 0.375, rule, &[2.5]);
        let all: Vec<_> = (0..steps.count).map(|index| steps.sample(index)).collect();
        let expected = [
            (2.1875, 0.375),
            (2.4375, 0.125),
            (2.6875, 0.375),
            (2.9375, 0.125),
        ];
        assert_eq!(all, expected);
        let whole = StepsInParts::new(span, 0.375, rule, &[]);
        let plain = Steps::new(span, 0.375, rule);
        assert_eq!(whole.count, plain.count);
        assert!((0..plain.count).all(|index| whole.sample(index) == plain.sample(index)));
    }

    #[test]
    fn a_whole_number_of_steps_fills_the_span() {
        let fitted = |fitted| StepRule {
            fitted,
            ..StepRule::at(0.5)
        };
        let two = vec![(2.25, 0.5), (2.75, 0.5)];
        assert_eq!(all(0.45, fitted(FittedSteps::Rounded)), two);
        assert_eq!(all(0.6, fitted(FittedSteps::Up)), two);
        assert_eq!(all(0.375, fitted(FittedSteps::Down)), two);
        assert_eq!(all(3.0, fitted(FittedSteps::Rounded)), []);
    }

    #[test]
    fn steps_in_voxels() {
        let direction = DVec3::new(0.6, 0.8, 0.0);
        let (spacing, size) = (DVec3::new(0.25, 0.5, 8.0), DVec3::new(2.0, 4.0, 8.0));
        let (voxel, longest) = (spacing.min_element(), size.max_element());
        let step =
            |measure| step_in_world(0.5, measure, direction, [spacing, size], [voxel, longest]);
        assert_eq!(step(StepLength::World), 0.5);
        // (2.4, 1.6, 0) nodes and (0.3, 0.2, 0) of the sides of the volume per unit.
        let root = 13_f64.sqrt();
        assert!((step(StepLength::Voxels) - 2.0 / (0.8 * root)).abs() < 1e-15);
        assert!((step(StepLength::MainAxis) - 2.0 / 2.4).abs() < 1e-15);
        assert!((step(StepLength::Texture) - 0.0625 / (0.1 * root)).abs() < 1e-15);
    }
}

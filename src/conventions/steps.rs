//! Samples along a ray.

use crate::geometry::Span;
use crate::scene::LastStep;

/// The samples along a span of a ray, one in each step.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    span: Span,
    /// Length of a step, > 0.
    step: f64,
    /// Position of a sample within its step, in steps: 0.5 is the middle.
    position: f64,
    /// Number of steps.
    pub count: usize,
    /// The last step ends with the span.
    is_last_cut: bool,
}

impl Steps {
    /// Samples at `position` within steps of length `step`. At least one step where the span has a
    /// length and the last step is exact, even if the quotient of both underflows.
    pub fn new(span: Span, step: f64, position: f64, last_step: LastStep) -> Steps {
        let steps = span.length() / step;
        let count = match last_step {
            LastStep::Exact if span.length() > 0.0 => steps.ceil().max(1.0),
            LastStep::Exact => steps.ceil(),
            // As many as have their sample inside.
            LastStep::Whole => (steps - position).floor() + 1.0,
            LastStep::Dropped => steps.floor(),
        };
        Steps {
            span,
            step,
            position,
            count: count as usize,
            is_last_cut: last_step == LastStep::Exact,
        }
    }

    /// Distance of sample `index` along the ray, and the length of its step. Computed from the index,
    /// because adding up lengths would accumulate rounding errors.
    pub fn sample(&self, index: usize) -> (f64, f64) {
        if index + 1 < self.count || !self.is_last_cut {
            let t = self.span.near + (index as f64 + self.position) * self.step;
            return (t, self.step);
        }
        let begin = index as f64 * self.step;
        let rest = (self.span.length() - begin).max(0.0);
        (self.span.near + (begin + self.position * rest), rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions and lengths of the samples over a span of length 1.
    fn samples(step: f64, position: f64, last_step: LastStep) -> Vec<(f64, f64)> {
        let steps = Steps::new(Span::new(2.0, 3.0), step, position, last_step);
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
}

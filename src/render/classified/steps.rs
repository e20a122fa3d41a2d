//! Positions of the samples of a ray.

use crate::geometry::Span;

/// Samples in the middle of steps of equal length along a span; the last step is as long as
/// what is left.
///
/// Positions follow from the index, `near + (i + ½)·h`: adding up `t += h` drifts by a rounding
/// a step (1.6e-4 after 10⁷ steps of 0.1).
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    near: f64,
    length: f64,
    last: f64,
    count: usize,
}

impl Steps {
    /// Steps of `length > 0` world units over `span`; none over a span of length 0.
    pub fn over(span: Span, length: f64) -> Steps {
        let mut count = (span.length() / length).ceil() as usize;
        // The quotient may underflow; what is longer than 0 has a step nevertheless.
        if span.length() > 0.0 {
            count = count.max(1);
        }
        // The product may round past the end of the span by an ulp: a last step of length 0.
        let last = (span.length() - count.saturating_sub(1) as f64 * length).max(0.0);
        Steps {
            near: span.near,
            length,
            last,
            count,
        }
    }

    /// Number of steps.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Length of all steps but the last, world units.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The middle of the whole step with the number `at`.
    #[inline(always)]
    fn middle(&self, at: f64) -> f64 {
        self.near + (at + 0.5) * self.length
    }

    /// Distance of sample `index` from the origin of the ray, and the length of its step.
    pub fn sample(&self, index: usize) -> (f64, f64) {
        // Signed, for which processors have an instruction.
        let at = index as i64 as f64;
        if index + 1 < self.count {
            (self.middle(at), self.length)
        } else {
            (self.near + (at * self.length + 0.5 * self.last), self.last)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_step_is_what_is_left() {
        let steps = Steps::over(Span::new(1.0, 2.25), 0.5);
        let samples: Vec<_> = (0..steps.count()).map(|i| steps.sample(i)).collect();
        assert_eq!(samples, [(1.25, 0.5), (1.75, 0.5), (2.125, 0.25)]);
    }

    #[test]
    fn a_whole_number_of_steps_leaves_no_rest() {
        let steps = Steps::over(Span::new(0.0, 2.0), 0.5);
        assert_eq!((steps.count(), steps.sample(3)), (4, (1.75, 0.5)));
    }

    #[test]
    fn a_step_longer_than_the_span_is_cut_to_it() {
        let steps = Steps::over(Span::new(3.0, 4.0), 100.0);
        assert_eq!((steps.count(), steps.sample(0)), (1, (3.5, 1.0)));
        assert_eq!(
            Steps::over(
                Span {
                    near: 3.0,
                    far: 3.0
                },
                0.5
            )
            .count(),
            0
        );
    }

    #[test]
    fn ten_million_steps_do_not_drift() {
        let steps = Steps::over(Span::new(0.0, 1e6), 0.1);
        let (t, length) = steps.sample(steps.count() - 1);
        // One rounding of 10⁶ each for the sample and its step.
        assert!((t + 0.5 * length - 1e6).abs() <= 1e6 * f64::EPSILON);
    }
}

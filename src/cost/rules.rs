//! Rules for the integral of the extinction over equal steps along a ray.

use super::profile::Profile;
use crate::math::Sum;
use crate::math::quadrature::cubic_integral;
use crate::render::classified::steps::Steps;

/// A rule for one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepRule {
    /// The value where the step begins.
    Left,
    /// The value in its middle.
    Midpoint,
    /// The mean of those at its ends.
    Trapezoid,
    /// A parabola through ends and middle.
    Simpson,
    /// Gauss's two points.
    GaussTwo,
}

/// The rules with their names and the orders of their errors in the length of a step, where the
/// extinction has as many derivatives.
const RULES: [(StepRule, &str, f64); 5] = [
    (StepRule::Left, "left", 1.0),
    (StepRule::Midpoint, "midpoint", 2.0),
    (StepRule::Trapezoid, "trapezoid", 2.0),
    (StepRule::Simpson, "Simpson", 4.0),
    (StepRule::GaussTwo, "Gauss, 2 points a step", 4.0),
];

impl StepRule {
    /// All rules.
    pub fn all() -> [StepRule; 5] {
        RULES.map(|(rule, ..)| rule)
    }

    /// Name.
    pub fn name(self) -> &'static str {
        RULES[self as usize].1
    }

    /// Order of its error.
    pub fn order(self) -> f64 {
        RULES[self as usize].2
    }

    /// Order where the extinction is continuous and has kinks between the steps' ends, as
    /// interpolated data have; with `jumps`, where it is not even that.
    pub fn order_with_kinks(self, jumps: bool) -> f64 {
        self.order().min(if jumps { 1.0 } else { 2.0 })
    }

    /// Optical depth of `profile` by steps of `length`, and the number of lookups.
    pub fn depth(self, profile: &Profile<'_>, length: f64) -> (f64, u64) {
        let steps = Steps::over(profile.span(), length);
        let mut lookups = 0;
        let mut at = |t: f64| (profile.extinction)(t, &mut lookups);
        let mut depth = Sum::default();
        // Neighbouring steps share the value between them.
        let mut before = None;
        for index in 0..steps.count() {
            let (middle, length) = steps.sample(index);
            let (near, far) = (middle - 0.5 * length, middle + 0.5 * length);
            depth.add(match self {
                StepRule::Left => at(near) * length,
                StepRule::Midpoint => at(middle) * length,
                StepRule::Trapezoid | StepRule::Simpson => {
                    let first = before.unwrap_or_else(|| at(near));
                    let last = at(far);
                    before = Some(last);
                    match self {
                        StepRule::Simpson => (first + 4.0 * at(middle) + last) * length / 6.0,
                        _ => (first + last) * length / 2.0,
                    }
                }
                StepRule::GaussTwo => cubic_integral(&mut at, near, far),
            });
        }
        (depth.value(), lookups)
    }
}

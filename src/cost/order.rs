//! Orders of convergence, compared with theory.

use super::norms::Norms;
use crate::math;
use serde::Serialize;

/// Smallest error that counts, in bounds on the error of the reference.
const ABOVE_THE_BOUND: f64 = 100.0;

/// Smallest error of a random estimate that counts, in standard errors of the reference: the
/// squares add up, and move the error by a thirty-second.
const ABOVE_THE_NOISE: f64 = 4.0;

/// Largest relative error that counts: beyond it there is no limit yet. Errors of random estimates
/// all count.
const COARSE: f64 = 0.1;

/// Smallest and largest number of settings in a fit, from the fine end: an order is a statement
/// about the limit.
const FEWEST: usize = 3;
const MOST: usize = 4;

/// Order of convergence: the error falls as the `order`-th power of the parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConvergenceOrder {
    /// Order by theory, if there is one; negative for a number of samples.
    pub expected: Option<f64>,
    /// Errors up to this may be those of the reference, and are not counted.
    pub known: f64,
    /// Order by least squares through the logarithms of the root mean square errors that are
    /// counted.
    pub fitted: Option<f64>,
    /// Order of the root mean square error from each setting to the next.
    pub local: Vec<Option<f64>>,
    /// Largest distance of `fitted` from `expected`.
    pub tolerance: f64,
    /// Standard error of `fitted`, as far as these rays stand for others.
    pub uncertainty: f64,
    /// The verdict.
    pub verdict: OrderVerdict,
}

/// Verdict on an order of convergence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OrderVerdict {
    /// The error falls as expected, within the tolerance and two standard errors.
    AsExpected,
    /// The error falls otherwise.
    Otherwise,
    /// Too few settings count, too coarse or below what the reference knows; or the order still changes from setting to
    /// setting.
    Undecided,
    /// Nothing is expected.
    NothingExpected,
}

/// The order of convergence that theory expects of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedOrder {
    /// The order, if anything is expected.
    pub order: Option<f64>,
    /// Largest deviation of a fit.
    pub tolerance: f64,
    /// True if all settings that count are fitted, not only the finest: with random estimates every
    /// one measures the same law.
    pub by_chance: bool,
}

impl ExpectedOrder {
    /// No expectation.
    pub const NOTHING: ExpectedOrder = ExpectedOrder {
        order: None,
        tolerance: 0.1,
        by_chance: false,
    };

    /// The order of a rule in the length of a step.
    pub fn of_step(order: f64) -> ExpectedOrder {
        ExpectedOrder {
            order: Some(order),
            ..ExpectedOrder::NOTHING
        }
    }

    /// The error of a mean of samples.
    pub const OF_SAMPLES: ExpectedOrder = ExpectedOrder {
        order: Some(-0.5),
        tolerance: 0.05,
        by_chance: true,
    };
}

/// A setting and its error.
pub type ErrorPoint = (f64, Norms);

/// The order in which errors fall with settings, from coarse to fine, against a reference that may be off by `bound`.
pub fn order(mut points: Vec<ErrorPoint>, expected: ExpectedOrder, bound: f64) -> ConvergenceOrder {
    let (floor, ceiling) = if expected.by_chance {
        (ABOVE_THE_NOISE * bound, f64::INFINITY)
    } else {
        (ABOVE_THE_BOUND * bound, COARSE)
    };
    let local = points.windows(2).map(|pair| {
        let (_, error) = pair[1];
        let line = line(pair).filter(|_| error.l2 > bound)?;
        Some(line.slope)
    });
    let local = local.collect();
    points.retain(|(_, error)| error.l2 > floor && error.l2 < ceiling);
    if !expected.by_chance && points.len() > MOST {
        points.drain(..points.len() - MOST);
    }
    let enough = Some(&points).filter(|points| points.len() >= FEWEST);
    let line_of_all = enough.and_then(|points| line(points));
    let fitted = line_of_all.map(|line| line.slope);
    let uncertainty = line_of_all.map_or(0.0, |line| line.uncertainty);
    let doubt = expected.tolerance + 2.0 * uncertainty;
    let verdict = match (expected.order, fitted) {
        (None, _) => OrderVerdict::NothingExpected,
        (Some(_), None) => OrderVerdict::Undecided,
        (Some(order), Some(fitted)) if (fitted - order).abs() <= doubt => OrderVerdict::AsExpected,
        _ => {
            let steps = points.windows(2).filter_map(line).map(|line| line.slope);
            let (low, high) = steps.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                (low.min(at), high.max(at))
            });
            // From setting to setting chance leaves any order; together they have one.
            if !expected.by_chance && high - low > 2.0 * doubt {
                OrderVerdict::Undecided
            } else {
                OrderVerdict::Otherwise
            }
        }
    };
    ConvergenceOrder {
        expected: expected.order,
        known: floor,
        fitted,
        local,
        tolerance: expected.tolerance,
        uncertainty,
        verdict,
    }
}

/// A straight line through logarithms.
#[derive(Clone, Copy, Debug)]
struct FittedLine {
    slope: f64,
    /// Standard error of the slope, if the points are independent.
    uncertainty: f64,
}

/// The line of least squares through the logarithms of `points`, all positive; none through fewer
/// than two different ones.
fn line(points: &[ErrorPoint]) -> Option<FittedLine> {
    let usable =
        |(value, error): &ErrorPoint| *value > 0.0 && error.l2 > 0.0 && error.l2.is_finite();
    if points.len() < 2 || !points.iter().all(usable) {
        return None;
    }
    let xs: Vec<f64> = points.iter().map(|(value, _)| math::ln(*value)).collect();
    let ys: Vec<f64> = points.iter().map(|(_, error)| math::ln(error.l2)).collect();
    let mean = |numbers: &[f64]| numbers.iter().sum::<f64>() / numbers.len() as f64;
    let (mean_x, mean_y) = (mean(&xs), mean(&ys));
    let (mut across, mut along, mut doubt) = (0.0, 0.0, 0.0);
    for ((x, y), (_, error)) in xs.iter().zip(&ys).zip(points) {
        across += (x - mean_x) * (y - mean_y);
        along += (x - mean_x) * (x - mean_x);
        // The logarithm of an error is off by as much as the error is relative to itself.
        doubt += (x - mean_x) * (x - mean_x) * (error.uncertainty * error.uncertainty);
    }
    (along > 0.0).then(|| FittedLine {
        slope: across / along,
        uncertainty: doubt.sqrt() / along,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep(error: impl Fn(f64) -> f64) -> Vec<ErrorPoint> {
        let norms = |l2| Norms {
            l2,
            uncertainty: 0.0,
        };
        let steps = [1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125];
        steps.map(|h| (h, norms(error(h)))).to_vec()
    }

    #[test]
    fn a_power_is_found_and_judged() {
        let points = sweep(|h| 0.05 * h * h);
        let found = order(points.clone(), ExpectedOrder::of_step(2.0), 1e-12);
        assert!((found.fitted.unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(found.verdict, OrderVerdict::AsExpected);
        let found = order(points, ExpectedOrder::of_step(1.0), 1e-12);
        assert_eq!(found.verdict, OrderVerdict::Otherwise);
    }

    #[test]
    fn what_the_reference_does_not_know_is_not_judged() {
        let points = sweep(|h| 0.05 * h * h);
        // Below 100 × 1e-4 are all but the two coarsest.
        let found = order(points, ExpectedOrder::of_step(2.0), 1e-4);
        assert_eq!(
            (found.fitted, found.verdict),
            (None, OrderVerdict::Undecided)
        );
    }

    #[test]
    fn a_floor_is_no_power() {
        let points = sweep(|h| 0.05 * h * h + 1e-3);
        let found = order(points, ExpectedOrder::of_step(2.0), 1e-12);
        assert_eq!(found.verdict, OrderVerdict::Undecided);
    }

    #[test]
    fn no_error_has_no_order() {
        let points = sweep(|_| 0.0);
        let found = order(points, ExpectedOrder::of_step(2.0), 0.0);
        assert_eq!(found.verdict, OrderVerdict::Undecided);
    }
}

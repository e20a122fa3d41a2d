//! Known answers with tolerances.

use crate::compare::{Gate, Metric};

/// The class of rows in results.
pub(crate) const ANALYTIC: &str = "analytic";

/// The metric for the error of a known answer relative to its tolerance.
pub(crate) const ERROR_OF_TOLERANCE: &str = "error_of_tolerance";

/// A known answer with a tolerance. It judges numbers, not pairs of images.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Analytic;

impl Gate for Analytic {
    fn name(&self) -> &'static str {
        ANALYTIC
    }

    fn rule(&self) -> &'static str {
        "The answer is known beforehand; the tolerance follows from the number of roundings or \
        samples."
    }

    fn metrics(&self) -> &'static [Metric] {
        &[(
            ERROR_OF_TOLERANCE,
            "Error of the known answer as a fraction of its tolerance: 0 is exact, 1 is the limit.",
        )]
    }
}

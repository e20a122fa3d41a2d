//! Known answers with tolerances.

use crate::compare::{Gate, Metric};

/// The class of rows in results.
pub const ANALYTIC: &str = "analytic";

/// The metric for the error of a known answer relative to its tolerance.
pub const ERROR_OF_TOLERANCE: &str = "error_of_tolerance";

/// A known answer with a tolerance. It judges numbers, not pairs of images.
#[derive(Clone, Copy, Debug)]
pub struct Analytic;

impl Gate for Analytic {
    fn name(&self) -> &'static str {
        ANALYTIC
    }

    fn rule(&self) -> &'static str {
        "The answer is known beforehand, and how far from it a number may be follows from how many \
         roundings or samples it takes."
    }

    fn metrics(&self) -> &'static [Metric] {
        &[(
            ERROR_OF_TOLERANCE,
            "Error against the answer that is known beforehand, as a share of what it may be: 0 is \
             exact, 1 the edge.",
        )]
    }
}

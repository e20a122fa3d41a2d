//! The gate: a rule for judging images, and its description.
//!
//! A new gate is a file that implements [`Gate`] and [`ImageGate`](super::ImageGate), and a row of
//! [`GATES`](super::GATES).

use super::difference_scale::DifferenceScale;
use crate::film::Film;
use serde::{Serialize, Serializer};
use std::fmt;

/// Name and meaning of a metric.
pub(crate) type Metric = (&'static str, &'static str);

/// A rule behind a result.
pub trait Gate: Send + Sync {
    /// Name, as in JSON and after `--gate`.
    fn name(&self) -> &'static str;

    /// The rule with its limits, in sentences for the reader of a report.
    fn rule(&self) -> &'static str;

    /// The metrics of its judgements.
    fn metrics(&self) -> &'static [Metric];

    /// For a report: the unit of the difference of two images of the same size.
    fn difference_scale(&self, _golden: &Film, _test: &Film) -> DifferenceScale {
        DifferenceScale::Radiance
    }
}

/// Metrics by name and meaning, or as they stand elsewhere.
macro_rules! metrics {
    (@row $name:expr, $meaning:expr) => { ($name, $meaning) };
    (@row $metric:expr) => { $metric };
    ($($name:expr $(=> $meaning:expr)?;)+) => { [$(metrics!(@row $name $(, $meaning)?)),+] };
}
pub(super) use metrics;

/// Means of the channels, test minus golden: metrics of several gates.
pub(super) const MEAN_DIFFERENCES: [Metric; 3] = metrics! {
    "mean_difference_red" => "Mean of test minus golden: above 0, red is too bright.";
    "mean_difference_green" => "Mean of test minus golden: above 0, green is too bright.";
    "mean_difference_blue" => "Mean of test minus golden: above 0, blue is too bright.";
};

impl PartialEq for dyn Gate {
    fn eq(&self, other: &dyn Gate) -> bool {
        self.name() == other.name()
    }
}

impl Eq for dyn Gate {}

impl fmt::Debug for dyn Gate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for dyn Gate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

//! The gate: a rule by which images are judged, and everything the program says about it.
//!
//! A new gate is a file that implements [`Gate`] and [`ImageGate`], and a row of
//! [`GATES`](super::GATES).

use super::difference_scale::DifferenceScale;
use super::judgement::Judgement;
use super::picture::{Picture, PictureError};
use crate::film::Film;
use serde::{Serialize, Serializer};
use std::fmt;

/// Name and meaning of a metric.
pub type Metric = (&'static str, &'static str);

/// A rule that a result was reached by.
pub trait Gate: Send + Sync {
    /// Name, as in JSON and after `--gate`.
    fn name(&self) -> &'static str;

    /// The rule with its limits, in sentences for the reader of a report.
    fn rule(&self) -> &'static str;

    /// The metrics of its judgements.
    fn metrics(&self) -> &'static [Metric];

    /// Evidence for a report: the unit in which the difference of two images of one size is shown.
    fn difference_scale(&self, _golden: &Film, _test: &Film) -> DifferenceScale {
        DifferenceScale::Radiance
    }
}

/// A gate for a pair of images.
pub trait ImageGate: Gate {
    /// Judges `test` by `reference`: images of one size, whose radiance is finite.
    ///
    /// # Errors
    ///
    /// Where the gate cannot judge images of this kind.
    fn judge(
        &self,
        reference: &Picture,
        test: &Picture,
        conditions: &Conditions,
    ) -> Result<Judgement, PictureError>;

    /// The pairs that it judges where no gate is named, in words after "for"; none for a gate that
    /// has to be named.
    fn default_for(&self) -> Option<&'static str> {
        None
    }

    /// Whether `reference` and `test` are such a pair, with the reason as the end of a sentence; it
    /// is empty where it is plain.
    fn default_reason(&self, _reference: &Picture, _test: &Picture) -> Option<&'static str> {
        None
    }

    /// Whether it judges what a display shows, so that the exposure decides.
    fn depends_on_exposure(&self) -> bool {
        false
    }
}

/// What a comparison depends on beside the images.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Stops at which radiance is shown.
    pub exposure: f64,
    /// Comparisons, this one included, that share one rate of false alarms.
    pub cases: usize,
    /// Bias of the mean of the image that a pass must have been able to see, relative to that mean
    /// plus [`DARK`](super::stochastic::DARK); none where a pass promises nothing.
    pub visible_bias: Option<f64>,
}

impl Default for Conditions {
    /// A single comparison at exposure 0, whose pass promises nothing.
    fn default() -> Conditions {
        Conditions {
            exposure: 0.0,
            cases: 1,
            visible_bias: None,
        }
    }
}

/// Means of the channels, test minus golden: metrics of several gates.
pub(super) const MEAN_DIFFERENCES: [Metric; 3] = [
    (
        "mean_difference_red",
        "Mean of test minus golden: above 0, red is too bright.",
    ),
    (
        "mean_difference_green",
        "Mean of test minus golden: above 0, green is too bright.",
    ),
    (
        "mean_difference_blue",
        "Mean of test minus golden: above 0, blue is too bright.",
    ),
];

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

impl fmt::Debug for dyn ImageGate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for dyn Gate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

//! The gates: rules for judging images.
//!
//! A new gate is a file with its [`Description`], a variant of [`Gate`], and arms in [`Gate::description`] and
//! [`judge`](super::judge).

use super::promise::Promise;
use super::sensitivity::Sensitivity;
use serde::{Deserialize, Serialize};

/// Name and meaning of a metric.
pub(crate) type Metric = (&'static str, &'static str);

/// The rule behind a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Gate {
    /// Every bit of every pixel.
    #[default]
    Exact,
    /// Linear radiance within a tolerance, for renderings without noise.
    Deterministic,
    /// 8-bit images that look the same.
    Perceptual,
    /// Means of random samples, by the noise they state.
    Stochastic,
    /// Images with steps h, h/2, h/4 against their limit, or one against a bound of first order.
    Refinement,
}

/// Description of a gate.
#[derive(Debug)]
pub struct Description {
    /// Name, as in JSON and after `--gate`.
    pub name: &'static str,
    /// The rule with its limits, in sentences for the reader of a report.
    pub rule: &'static str,
    /// The metrics of its judgements.
    pub metrics: &'static [(&'static str, &'static str)],
    /// The pairs of images for which it is the default, in words after "for"; `None` for a gate that has to be named.
    pub default_for: Option<&'static str>,
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

/// Parameters of a comparison beside the images; by default a single comparison at exposure 0, without a required bias.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conditions<'s> {
    /// Exposure applied to linear images, in stops.
    pub exposure: f64,
    /// Number of comparisons, including this one, that share one rate of false alarms; 0 is 1.
    pub cases: usize,
    /// Biases that must be detectable for a pass; `None` for no such requirement.
    pub promise: Option<Promise>,
    /// The renderer of the test image is known to compute in single precision.
    pub in_single_precision: bool,
    /// Opacity was asked for, so that 1 everywhere is a statement about the volume.
    pub opacity: bool,
    /// Derivatives of the reference by the parameters of its scene, for the stochastic gate.
    pub sensitivities: &'s [Sensitivity],
}

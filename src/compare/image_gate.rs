//! Gates for pairs of images.

use super::gate::Gate;
use super::judgement::Judgement;
use super::picture::{Picture, PictureError};
use super::promise::Promise;
use super::sensitivity::Sensitivity;
use std::fmt;

/// A gate for a pair of images.
pub trait ImageGate: Gate {
    /// Judges `test` by `reference`: images of one size, whose radiance is finite.
    ///
    /// # Errors
    ///
    /// If the gate cannot judge images of this kind.
    fn judge(
        &self,
        reference: &Picture,
        test: &Picture,
        conditions: &Conditions<'_>,
    ) -> Result<Judgement, PictureError>;

    /// The pairs for which it is the default, in words after "for"; `None` for a gate that has to
    /// be named.
    fn default_for(&self) -> Option<&'static str> {
        None
    }

    /// The reason why `reference` and `test` are such a pair, as the end of a sentence; empty if it
    /// is obvious, `None` for another pair.
    fn default_reason(&self, _reference: &Picture, _test: &Picture) -> Option<&'static str> {
        None
    }

    /// True if the gate depends on the exposure, because it judges displayed images.
    fn depends_on_exposure(&self) -> bool {
        false
    }
}

/// Parameters of a comparison beside the images.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions<'s> {
    /// Exposure applied to linear images, in stops.
    pub exposure: f64,
    /// Number of comparisons, including this one, that share one rate of false alarms.
    pub cases: usize,
    /// Biases that must be detectable for a pass; `None` for no such requirement.
    pub promise: Option<Promise>,
    /// The renderer of the test image is known to compute in single precision.
    pub in_single_precision: bool,
    /// Opacity was asked for, so that 1 everywhere is a statement about the volume.
    pub opacity: bool,
    /// Derivatives of the reference by the numbers of its scene, for the stochastic gate.
    pub sensitivities: &'s [Sensitivity],
}

impl Default for Conditions<'_> {
    /// A single comparison at exposure 0, without a required bias.
    fn default() -> Self {
        Conditions {
            exposure: 0.0,
            cases: 1,
            promise: None,
            in_single_precision: false,
            opacity: false,
            sensitivities: &[],
        }
    }
}

impl fmt::Debug for dyn ImageGate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

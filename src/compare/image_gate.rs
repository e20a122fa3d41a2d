//! Gates for pairs of images.

use super::gate::Gate;
use super::judgement::Judgement;
use super::picture::{Picture, PictureError};
use std::fmt;

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

    /// The reason why `reference` and `test` are such a pair, as the end of a sentence; empty where it
    /// is plain, `None` for another pair.
    fn default_reason(&self, _reference: &Picture, _test: &Picture) -> Option<&'static str> {
        None
    }

    /// The gate judges what a display shows, so that the exposure decides.
    fn depends_on_exposure(&self) -> bool {
        false
    }
}

/// The conditions of a comparison beside the images.
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

impl fmt::Debug for dyn ImageGate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

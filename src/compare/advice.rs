//! The samples needed to decide a comparison that noise leaves open.

use crate::math;
use std::fmt;

/// An inconclusive pass: the required bias of the mean would not have been detected. The variants
/// state what would decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Undecided {
    /// More samples in the test image.
    Samples(Advice),
    /// No test image would decide: even one without noise would not show a bias below this,
    /// relative to the mean of the image.
    Reference(f64),
    /// Images with smaller steps; this share of the mean is now allowed for the step.
    Step(f64),
    /// An image that is not cut off; in this one, this share of the pixels is.
    CutOff(f64),
}

/// Samples of a test image that would decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advice {
    /// Factor on its present samples.
    pub times: f64,
    /// Samples per pixel, of all its renderings together; `None` if unknown.
    pub has: Option<u64>,
}

impl Advice {
    /// Samples per pixel that would decide, of all renderings together, where those of the image
    /// are known.
    pub fn samples(&self) -> Option<f64> {
        let has = self.has? as f64;
        Some(two_digits(self.times * has).ceil())
    }
}

/// The next number of two decimal digits from a `value` of at least 1 up: more would claim what an
/// estimate does not know.
fn two_digits(value: f64) -> f64 {
    let scale = math::powu(10.0, math::log10(value) as u32);
    (10.0 * value / scale).ceil() * scale / 10.0
}

impl fmt::Display for Undecided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Undecided::Samples(advice) => advice.fmt(f),
            Undecided::Reference(bias) => write!(
                f,
                "no number of samples of this image would decide: the noise of the reference image alone \
                 hides a bias below {:.2} %",
                100.0 * bias
            ),
            Undecided::Step(width) => write!(
                f,
                "that decides nothing: the step is so long that errors of {:.1} % have to be allowed for it; \
                 begin with a smaller one",
                100.0 * width
            ),
            Undecided::CutOff(share) => write!(
                f,
                "that decides nothing: {:.0} % of the pixels are cut off by the 8 bits of the image; write \
                 16 or 32 bits a channel, or a PNG at the exposure of the case",
                100.0 * share
            ),
        }
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let times = two_digits(self.times);
        write!(
            f,
            "about {times} times as many samples per pixel would decide"
        )?;
        match self.samples() {
            Some(samples) => write!(f, ", {samples} in all"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_has_two_digits_and_is_never_less() {
        for (value, shown) in [
            (1.0, "1"),
            (1.01, "1.1"),
            (9.95, "10"),
            (16.04, "17"),
            (6144.0, "6200"),
            (99_999.0, "100000"),
        ] {
            assert_eq!(two_digits(value).to_string(), shown);
        }
    }
}

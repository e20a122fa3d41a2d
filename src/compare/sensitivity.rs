//! The derivative of an image by a parameter of its scene, in blocks, as a gate uses it.

use crate::film::Film;

/// Derivative of the image of a scene by one of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// `density`, `reflectance.2`.
    pub name: String,
    /// Description of the parameter, for a sentence.
    pub words: String,
    /// Unit of its changes: `None` for shares of itself, empty for a bare number.
    pub unit: Option<String>,
    /// Change by which the derivative was taken; infinite where the image changes in proportion.
    pub step: f64,
    /// True where the parameter can be smaller, and larger: an albedo of 1 cannot be larger.
    pub can_be: [bool; 2],
    /// Mean derivative of each block of [`BLOCK`](super::stochastic::BLOCK)² pixels, per unit of change, with its variance.
    pub derivative: Film,
}

impl Sensitivity {
    /// A change in words: `2.1 ± 0.3 % too large`, `off by −0.25 ± 0.02 pixels`.
    pub fn in_words(&self, change: f64, error: f64) -> String {
        // Far from the right value, at which the derivative was taken, no error is known.
        let error = Some(error).filter(|_| !self.is_far(change));
        change_in_words(&self.words, self.unit.as_deref(), change, error)
    }

    /// True if an image hardly changes in proportion to a change of this size.
    pub(crate) fn is_far(&self, change: f64) -> bool {
        change.abs() > self.step
    }

    /// Error by curvature of a change that is estimated by the derivative alone: a tenth of a whole
    /// step in most scenes.
    pub(crate) fn curvature(&self, change: f64) -> f64 {
        0.1 * change * change / self.step
    }

    /// True if the parameter can be changed by this, in this direction: a share of itself no further than to 0.
    pub fn is_possible(&self, change: f64) -> bool {
        self.can_be[usize::from(change > 0.0)] && self.stays_positive(change)
    }

    /// True if the parameter stays positive, where the change is a share of it.
    pub(crate) fn stays_positive(&self, change: f64) -> bool {
        self.unit.is_some() || change > -1.0
    }

    /// A size without a sign in words: `density 1.6 %`.
    pub(crate) fn size_in_words(&self, size: f64) -> String {
        let (factor, unit) = match self.unit.as_deref() {
            None => (100.0, " %".to_owned()),
            Some("") => (1.0, String::new()),
            Some(unit) => (1.0, format!(" {unit}")),
        };
        let [size, _] = with_error(factor * size, 0.1 * factor * size);
        format!("{} {size}{unit}", self.words)
    }
}

/// Largest part of a change that its standard error is, if its size is said.
const LARGEST_ERROR: f64 = 0.5;

/// A change of a number that is called `words`, in this unit, or in shares of itself: `density
/// 2.1 ± 0.3 % too large`; in two digits where no error is known, and without a size where that is
/// too uncertain.
pub(crate) fn change_in_words(
    words: &str,
    unit: Option<&str>,
    change: f64,
    error: Option<f64>,
) -> String {
    let side = if change < 0.0 { "small" } else { "large" };
    let factor = if unit.is_none() { 100.0 } else { 1.0 };
    let size = factor * change.abs();
    let (about, size) = match error {
        None => ("about ", two_digits(size)),
        Some(error) if error <= LARGEST_ERROR * change.abs() => {
            let [size, error] = with_error(size, factor * error);
            ("", format!("{size} ± {error}"))
        }
        Some(_) => return format!("{words} too {side}, by how much is not known"),
    };
    let sign = if change < 0.0 { "−" } else { "+" };
    match unit {
        None => format!("{words} {about}{size} % too {side}"),
        Some("") => format!("{words} off by {about}{sign}{size}"),
        Some(unit) => format!("{words} off by {about}{sign}{size} {unit}"),
    }
}

/// A size of which no error is known: `140`, `0.25`.
fn two_digits(size: f64) -> String {
    if !(size > 0.0 && size.is_finite()) {
        return format!("{size}");
    }
    let place = crate::math::log10(size).floor() as i32 - 1;
    if place > 0 {
        let unit = crate::math::powu(10.0, place as u32);
        format!("{:.0}", (size / unit).round() * unit)
    } else {
        format!("{size:.*}", (-place) as usize)
    }
}

/// A value and its error to the second digit of the error.
pub(super) fn with_error(value: f64, error: f64) -> [String; 2] {
    let digits = if error > 0.0 && error.is_finite() {
        (1 - crate::math::log10(error).floor() as i32).clamp(0, 12) as usize
    } else {
        3
    };
    [value, error].map(|number| format!("{number:.digits$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sensitivity(unit: Option<&str>) -> Sensitivity {
        Sensitivity {
            name: "density".to_owned(),
            words: "density".to_owned(),
            unit: unit.map(str::to_owned),
            step: 1.0,
            can_be: [true; 2],
            derivative: Film::new(1, 1, vec![[0.0; 3]]),
        }
    }

    #[test]
    fn changes_have_the_digits_of_their_error() {
        let share = sensitivity(None);
        assert_eq!(
            share.in_words(0.0984, 0.0112),
            "density 9.8 ± 1.1 % too large"
        );
        assert_eq!(share.in_words(-0.5, 0.2), "density 50 ± 20 % too small");
        assert_eq!(share.size_in_words(0.0163), "density 1.63 %");
        assert_eq!(share.in_words(1.537, 0.2), "density about 150 % too large");
        assert_eq!(
            share.in_words(0.1, 0.06),
            "density too large, by how much is not known"
        );
        assert!(share.is_possible(-0.9) && !share.is_possible(-1.1));
        let pixels = sensitivity(Some("pixels"));
        assert_eq!(
            pixels.in_words(-0.25, 0.021),
            "density off by −0.250 ± 0.021 pixels"
        );
        assert_eq!(
            pixels.in_words(-2.31, 0.1),
            "density off by about −2.3 pixels"
        );
        assert!(pixels.is_possible(-1.1));
        assert_eq!(
            sensitivity(Some("")).in_words(0.1, 0.02),
            "density off by +0.100 ± 0.020"
        );
    }
}

//! Absolute rounding errors of values, by the digits that they have: of a text with decimal places, and of
//! half floats near 0.

use super::Film;
use half::f16;
use std::collections::BTreeSet;

/// Rounding error of half floats below their smallest normal number, 2⁻¹⁴, where they have steps of 2⁻²⁴.
const HALF_FLOATS: f64 = 1.0 / 33_554_432.0;

/// Decimal places that `printf` writes unless told otherwise.
const USUAL_PLACES: u32 = 6;

/// Most decimal places that are looked for. Half a unit of the next is no more than half precision rounds off
/// a radiance of 10⁻⁶.
const MOST_PLACES: u32 = 9;

/// Fewest different values that are no chance with fewer places than [`USUAL_PLACES`]: 0.5 and 0.25 have two,
/// and are exact.
const FEWEST_VALUES: usize = 16;

/// Relative rounding error of the nearest single-precision number, and a little more for the product.
const SINGLE_PRECISION: f64 = 1.01 / 16_777_216.0;

/// Rounding error of single precision, in units of the last decimal place, up to which a value tells if it is a
/// decimal: one in five is by chance.
const TELLS: f64 = 0.1;

impl Film {
    /// Largest error of a value by rounding to the decimal places of a text or to half floats near 0; 0 where
    /// values have more digits. A mean of several renderings has that of each.
    pub(crate) fn absolute_rounding(&self) -> f64 {
        let of_values = || {
            let values = self.radiance().as_flattened();
            let is_half = |value: &f32| f16::from_f32(*value).to_f32() == *value;
            let of_halves = if values.iter().all(is_half) {
                HALF_FLOATS
            } else {
                0.0
            };
            of_text(values).max(of_halves)
        };
        self.reading.rounding.unwrap_or_else(of_values)
    }
}

/// Half a unit of the last decimal place of `values`; 0 where they are no decimals.
fn of_text(values: &[f32]) -> f64 {
    let mut places = 0;
    for &value in values {
        while is_decimal(value, places) == Some(false) {
            places += 1;
            if places > MOST_PLACES {
                return 0.0;
            }
        }
    }
    let enough = if places < USUAL_PLACES {
        FEWEST_VALUES
    } else {
        1
    };
    let mut different = BTreeSet::new();
    let telling = values.iter().filter(|value| **value != 0.0);
    let telling = telling.filter(|value| is_decimal(**value, places) == Some(true));
    let is_text = telling
        .map(|value| value.to_bits())
        .any(|bits| different.insert(bits) && different.len() >= enough);
    if is_text { 0.5 / units(places) } else { 0.0 }
}

/// Units of the last of so many decimal places in 1.
fn units(places: u32) -> f64 {
    10_u64.pow(places) as f64
}

/// Answer whether a value is the nearest to a number of so many decimal places; `None` where single precision
/// does not tell.
fn is_decimal(value: f32, places: u32) -> Option<bool> {
    let number = f64::from(value) * units(places);
    let rounding = SINGLE_PRECISION * number.abs();
    let is_telling = rounding <= TELLS || !number.is_finite();
    is_telling.then(|| (number - number.round()).abs() <= rounding)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slope from next to black to `most`, in three colours.
    fn slope(most: f64, written: impl Fn(f64) -> f32) -> Film {
        let value = |i: usize, c: usize| most * ((7 * i + c) as f64 + 0.3) / 7200.0;
        let pixels = (0..1024).map(|i| [0, 1, 2].map(|c| written(value(i, c))));
        Film::new(32, 32, pixels.collect())
    }

    fn text(places: usize) -> impl Fn(f64) -> f32 {
        move |value| format!("{value:.places$}").parse().unwrap()
    }

    #[test]
    fn decimals_are_known_and_floats_are_none() {
        for most in [1e-5, 1e-3, 1.0, 4.0] {
            let [six, nine] = [6, 9].map(|places| slope(most, text(places)));
            assert_eq!(six.absolute_rounding(), 5e-7, "{most}");
            // For brighter values single precision does not tell.
            let found = nine.absolute_rounding();
            assert!(
                found == 5e-10 || found == 0.0 && most >= 1.0,
                "{most} {found}"
            );
            assert_eq!(slope(most, |value| value as f32).absolute_rounding(), 0.0);
            let digits = |value: f64| format!("{value:.5e}").parse().unwrap();
            // In the darkest of the brighter ones, six digits are nine places.
            assert!(slope(most, digits).absolute_rounding() <= 5e-10);
        }
        assert_eq!(slope(1.0, text(3)).absolute_rounding(), 5e-4);
        let half = slope(1.0, |value| f16::from_f64(value).to_f32());
        assert_eq!(half.absolute_rounding(), HALF_FLOATS);
    }

    /// Two and a half may be exact, and so may what is no number be anything.
    #[test]
    fn few_values_are_no_text() {
        for values in [[0.5, 0.1, 2.5], [0.0; 3], [f32::NAN, f32::INFINITY, 0.1]] {
            let film = Film::new(1, 1, vec![values]);
            assert!(film.absolute_rounding() <= HALF_FLOATS, "{values:?}");
        }
    }

    #[test]
    fn a_mean_of_texts_is_as_far_off_as_they_are() {
        let films = [1.0, 1.1, 1.3].map(|most| slope(most, text(6)));
        let mean = Film::from_replicates(&films).unwrap();
        assert_eq!(mean.absolute_rounding(), 5e-7);
        let exact = [1.0, 1.1, 1.3].map(|most| slope(most, |value| value as f32));
        let mean = Film::from_replicates(&exact).unwrap();
        assert_eq!(mean.absolute_rounding(), 0.0);
    }
}

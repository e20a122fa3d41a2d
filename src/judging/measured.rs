//! Measurements of a failed image, without rendering anything: a simple map from the golden to it.
//!
//! These are statements about the image, not guesses at what went wrong: none is made unless it
//! holds for all of the image.

use crate::compare::cells::Cells;
use crate::compare::flip::SrgbImage;
use crate::compare::unexplained::{UNEXPLAINED, UNEXPLAINED_IN_NOISE, makes_what_shows};
use crate::compare::{Conditions, Deterministic, Perceptual, Picture, judge};
use crate::film::{Bits, Film, Origin, Quantisation};
use crate::math;
use crate::suite::Case;
use crate::variations::edited_film::mapped;

/// The largest code of 8 bits.
const LARGEST_CODE: f64 = 255.0;

/// Statement on an image of whole numbers, and of many.
const OF_CODES: &str =
    "every value is a whole number from 0 to 255: the image holds codes, not radiance";

/// Measurements of `picture`, a failed image of `case`: sentences without a full stop.
pub(crate) fn measured(case: &Case, golden: &Film, picture: &Picture) -> Vec<String> {
    if let Picture::Codes(codes) = picture {
        let factor = exposure_factor(case, golden, codes);
        return factor.map(another_exposure).into_iter().collect();
    }
    let Some(test) = comparable(golden, picture) else {
        return Vec::new();
    };
    if is_black(golden) {
        let mean = number(test.mean_magnitude().unwrap_or_default());
        return vec![format!(
            "the golden is black, and the mean of the image is {mean}"
        )];
    }
    let words = |map: Map| match map {
        Map::Scaled(factor) if is_of_png(test) => another_exposure(factor),
        map => map.in_words(),
    };
    let map = simple_map(case, golden, test).map(words);
    codes_in_words(picture).into_iter().chain(map).collect()
}

/// Statement that `picture` holds codes that were written as numbers.
pub(crate) fn codes_in_words(picture: &Picture) -> Option<String> {
    let codes = Quantisation::of_whole_numbers(picture.radiance()?);
    codes.map(|_| OF_CODES.to_owned())
}

/// A simple map of an image's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SimpleMap {
    /// A factor, or one for each channel.
    Gain,
    /// An offset or a power besides, or of a black golden.
    Other,
}

fn is_black(film: &Film) -> bool {
    film.mean_magnitude() == Some(0.0)
}

/// The simple map from the golden to `picture`, if there is one.
pub(crate) fn simple(case: &Case, golden: &Film, picture: &Picture) -> Option<SimpleMap> {
    if is_black(golden) {
        return Some(SimpleMap::Other);
    }
    let map = simple_map(case, golden, comparable(golden, picture)?)?;
    Some(match map {
        Map::Scaled(_) | Map::Tinted(_) => SimpleMap::Gain,
        Map::Shifted { .. } | Map::Power { .. } => SimpleMap::Other,
    })
}

/// True if `picture` is an 8-bit image of the golden at another exposure. In a file made for a
/// display that is what a plain factor means first.
pub(crate) fn is_another_exposure(case: &Case, golden: &Film, picture: &Picture) -> bool {
    match picture {
        Picture::Codes(codes) => exposure_factor(case, golden, codes).is_some(),
        Picture::Radiance(test) => {
            is_of_png(test) && simple(case, golden, picture) == Some(SimpleMap::Gain)
        }
    }
}

/// True of radiance from the codes of a PNG image.
fn is_of_png(film: &Film) -> bool {
    film.quantisation()
        .is_some_and(|it| it.origin == Origin::Png)
}

/// The radiance that 8-bit codes stand for, at `exposure` stops.
pub(crate) fn decoded(codes: &SrgbImage, exposure: f64) -> Film {
    let bits = Bits::UNKNOWN;
    let quantisation = bits.of_png(exposure);
    quantisation.decoded(codes.width(), codes.height(), codes.pixels())
}

/// The factor on the golden after which the perceptual gate cannot tell it from `codes`.
fn exposure_factor(case: &Case, golden: &Film, codes: &SrgbImage) -> Option<f64> {
    let test = decoded(codes, case.exposure);
    if !golden.is_comparable(&test) {
        return None;
    }
    let saturated = |index: usize, channel: usize| codes.pixels()[index][channel] == u8::MAX;
    let factor = Fits::of_values(golden, &test, |i, c| !saturated(i, c))?.factor();
    if !(factor > 0.0 && factor.is_finite()) {
        return None;
    }
    let map = Map::Scaled(factor);
    if !map.shows(golden, &test) {
        return None;
    }
    let scaled = Picture::Radiance(map.of(golden));
    let test = Picture::Codes(codes.clone());
    let conditions = Conditions {
        exposure: case.exposure,
        ..Conditions::default()
    };
    let judgement = judge(&Perceptual, &scaled, &test, &conditions);
    judgement
        .is_ok_and(|judgement| judgement.passed)
        .then_some(factor)
}

fn another_exposure(factor: f64) -> String {
    let stops = math::ln(factor) / std::f64::consts::LN_2;
    let sign = if stops < 0.0 { "−" } else { "+" };
    format!(
        "the image is the golden × {}, another exposure ({sign}{:.2} stops)",
        number(factor),
        stops.abs()
    )
}

/// The radiance of `picture`, where it can be compared with the golden's.
fn comparable<'p>(golden: &Film, picture: &'p Picture) -> Option<&'p Film> {
    let Picture::Radiance(test) = picture else {
        return None;
    };
    golden.is_comparable(test).then_some(test)
}

/// A map of every value of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Map {
    /// Times a factor.
    Scaled(f64),
    /// Each channel times a factor of its own.
    Tinted([f64; 3]),
    /// Times a factor, plus an offset.
    Shifted { factor: f64, offset: f64 },
    /// To the power of an exponent, times a factor.
    Power { factor: f64, exponent: f64 },
}

impl Map {
    /// Value and slope at `x` in `channel`.
    fn at(&self, x: f64, channel: usize) -> (f64, f64) {
        match *self {
            Map::Scaled(factor) => (factor * x, factor),
            Map::Tinted(factors) => (factors[channel] * x, factors[channel]),
            Map::Shifted { factor, offset } => (factor * x + offset, factor),
            Map::Power { factor, exponent } if x > 0.0 => {
                let value = factor * math::exp(exponent * math::ln(x));
                (value, exponent * value / x)
            }
            Map::Power { .. } => (0.0, 0.0),
        }
    }

    fn of(&self, film: &Film) -> Film {
        mapped(film, |x, channel| self.at(x, channel))
    }

    /// True if `test` shows the map of `golden`, which leaves little of what it is without its factor: a few codes, or
    /// less than the tolerance, are no measurement.
    fn shows(&self, golden: &Film, test: &Film) -> bool {
        let offset = match *self {
            Map::Shifted { offset, .. } => offset,
            _ => 0.0,
        };
        makes_what_shows(
            &self.of(golden),
            test,
            &mapped(golden, |_, _| (offset, 0.0)),
        )
    }

    /// True if the map is increasing, apart from its offset.
    fn is_growing(&self) -> bool {
        let is = |number: f64| number > 0.0 && number.is_finite();
        match *self {
            Map::Scaled(factor) | Map::Shifted { factor, .. } => is(factor),
            Map::Tinted(factors) => factors.into_iter().all(is),
            Map::Power { factor, exponent } => is(factor) && is(exponent),
        }
    }

    fn in_words(&self) -> String {
        match *self {
            Map::Scaled(factor) if (factor / LARGEST_CODE - 1.0).abs() < 1e-3 => {
                format!(
                    "the image is the golden × {}: divide the codes by 255",
                    number(factor)
                )
            }
            Map::Scaled(factor) => format!("the image is the golden × {}", number(factor)),
            Map::Tinted([r, g, b]) => format!(
                "the image is the golden × {}, {}, {} in red, green and blue",
                number(r),
                number(g),
                number(b)
            ),
            Map::Shifted { factor, offset } => format!(
                "the image is the golden × {} {} {}",
                number(factor),
                if offset < 0.0 { "−" } else { "+" },
                number(offset.abs())
            ),
            Map::Power { factor, exponent } => format!(
                "the image is the golden to the power of {}, × {}",
                number(exponent),
                number(factor)
            ),
        }
    }
}

/// A number in four digits.
fn number(value: f64) -> String {
    match value.abs() {
        0.01..10.0 => format!("{value:.3}"),
        10.0..1000.0 => format!("{value:.1}"),
        _ => format!("{value:.3e}"),
    }
}

/// The simplest map of the golden after which the gate of the case cannot tell it from `test`.
fn simple_map(case: &Case, golden: &Film, test: &Film) -> Option<Map> {
    let is_sampled = case.sampling.is_some();
    let fits = Fits::new(golden, test)?;
    let mut maps = vec![Some(fits.scaled()), Some(fits.tinted()), fits.shifted()];
    if !is_sampled {
        // The mean of a power is not the power of the mean: with noise there is no telling.
        maps.push(power(golden, test));
    }
    let mut maps = maps.into_iter().flatten().filter(Map::is_growing);
    if !is_sampled {
        let picture = Picture::Radiance(test.clone());
        let colours = golden.clone().without_opacity();
        let agrees = |film: Film| {
            let film = Picture::Radiance(film);
            let judgement = judge(&Deterministic, &film, &picture, &Conditions::default());
            judgement.is_ok_and(|judgement| judgement.passed)
        };
        // No colour map is reported if colours agree, or if only a few pixels differ.
        let left = |prediction: &Film| squared_difference(prediction, test, &colours);
        let whole = left(&colours);
        let holds = |map: &Map| {
            let mapped = map.of(&colours);
            left(&mapped) <= UNEXPLAINED * whole && map.shows(&colours, test) && agrees(mapped)
        };
        let found = maps.find(holds).filter(|_| !agrees(colours.clone()))?;
        // Rounding leaves factors open that are 1.
        let is_rounded = test.quantisation().is_some();
        return Some(match found {
            Map::Tinted(_) if is_rounded => (0..3).fold(found, |map, c| {
                let Map::Tinted(mut factors) = map else {
                    return map;
                };
                factors[c] = 1.0;
                Some(Map::Tinted(factors)).filter(holds).unwrap_or(map)
            }),
            found => found,
        });
    }
    let cells = Cells::of_blocks(golden);
    let mut test_cells = Cells::of_blocks(test);
    if test.noise().is_none() {
        test_cells.spread_noise_like(&cells);
    }
    let from_golden = cells.misfit(&test_cells, &cells);
    maps.find(|map| {
        let misfit = Cells::of_blocks(&map.of(golden)).misfit(&test_cells, &cells);
        misfit.is_noise() && misfit.explains(&from_golden, UNEXPLAINED_IN_NOISE)
    })
}

/// Sum of the squared differences of `test` from `prediction`, relative to the golden, beyond rounding.
fn squared_difference(prediction: &Film, test: &Film, golden: &Film) -> f64 {
    let mean = golden.mean_magnitude().unwrap_or_default();
    let nearest = test.nearest_to(prediction);
    let [golden, predicted, nearest] =
        [golden, prediction, &nearest].map(|film| film.radiance().as_flattened());
    let values = golden.iter().zip(predicted).zip(nearest);
    let squares = values.map(|((golden, a), b)| {
        let difference = f64::from(*b) - f64::from(*a);
        relative_weight(f64::from(*golden), mean) * difference * difference
    });
    squares.sum()
}

/// The weight of a square where the golden is `value` and `mean` on average: relative, but not to what is next to black.
fn relative_weight(value: f64, mean: f64) -> f64 {
    1.0 / ((value.abs() + mean) * (value.abs() + mean))
}

/// Weighted sums over an image, by channel: of the weights, of the golden `a`, the image `b`, a²
/// and a b.
struct Fits([[f64; 5]; 3]);

impl Fits {
    fn new(golden: &Film, test: &Film) -> Option<Fits> {
        // A value that is cut off says nothing of a factor.
        let most = test.quantisation().map_or(f64::INFINITY, |it| it.largest());
        let is_below = |value: f32| f64::from(value) < most * (1.0 - 1e-3);
        Fits::of_values(golden, test, |i, c| is_below(test.radiance()[i][c]))
    }

    /// Sums of the `wanted` values, by pixel and channel.
    fn of_values(
        golden: &Film,
        test: &Film,
        wanted: impl Fn(usize, usize) -> bool,
    ) -> Option<Fits> {
        let mean = golden.mean_magnitude().filter(|&mean| mean > 0.0)?;
        let mut sums = [[0.0; 5]; 3];
        let pixels = golden.radiance().iter().zip(test.radiance());
        for (index, (golden, test)) in pixels.enumerate() {
            for (c, sums) in sums.iter_mut().enumerate() {
                if !wanted(index, c) {
                    continue;
                }
                let (a, b) = (f64::from(golden[c]), f64::from(test[c]));
                let weight = relative_weight(a, mean);
                for (sum, value) in sums.iter_mut().zip([1.0, a, b, a * a, a * b]) {
                    *sum += weight * value;
                }
            }
        }
        Some(Fits(sums))
    }

    fn all(&self) -> [f64; 5] {
        std::array::from_fn(|i| self.0.iter().map(|sums| sums[i]).sum())
    }

    fn factor(&self) -> f64 {
        let [_, _, _, aa, ab] = self.all();
        ab / aa
    }

    fn scaled(&self) -> Map {
        Map::Scaled(self.factor())
    }

    fn tinted(&self) -> Map {
        // A channel that is black in the golden stays so under any factor.
        let factor = |[_, _, _, aa, ab]: [f64; 5]| if aa > 0.0 { ab / aa } else { 1.0 };
        Map::Tinted(self.0.map(factor))
    }

    fn shifted(&self) -> Option<Map> {
        // An image of one value is shifted as well as scaled: that was tried.
        let [factor, offset] = line(self.all());
        (factor.is_finite() && offset.is_finite()).then_some(Map::Shifted { factor, offset })
    }
}

/// The power of the golden that is nearest to `test`, by the logarithms of what is not black.
fn power(golden: &Film, test: &Film) -> Option<Map> {
    let [golden, test] = [golden, test].map(|film| film.radiance().as_flattened());
    let mean = golden.iter().map(|x| f64::from(*x)).sum::<f64>() / golden.len() as f64;
    let mut sums = [0.0; 5];
    for (a, b) in golden.iter().zip(test) {
        let (a, b) = (f64::from(*a), f64::from(*b));
        if a > 0.0 && b > 0.0 {
            // Relative differences again: those of the logarithms.
            let weight = (a / (a + mean)) * (a / (a + mean));
            let (x, y) = (math::ln(a), math::ln(b));
            for (sum, value) in sums.iter_mut().zip([1.0, x, y, x * x, x * y]) {
                *sum += weight * value;
            }
        }
    }
    let [exponent, offset] = line(sums);
    let factor = math::exp(offset);
    Some(Map::Power { factor, exponent })
}

/// Slope and offset of the line nearest to points, by weighted sums of 1, x, y, x² and x y.
fn line([weights, x, y, xx, xy]: [f64; 5]) -> [f64; 2] {
    let slope = (weights * xy - x * y) / (weights * xx - x * x);
    [slope, (y - slope * x) / weights]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::suite::Suite;
    use std::path::Path;

    fn case(name: &str) -> Case {
        let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
        suite.select(&[name.to_owned()]).unwrap()[0].clone()
    }

    /// Slopes of three colours, from next to black to 0.96.
    fn golden() -> Film {
        let value = |i: usize, c: usize| ((i % 32 * (c + 1) + i / 32) as f32 + 0.3) / 132.0;
        let pixels = (0..32 * 24).map(|i| std::array::from_fn(|c| value(i, c)));
        Film::new(32, 24, pixels.collect())
    }

    fn said(map: impl Fn(f64, usize) -> f64) -> String {
        let golden = golden();
        let edited = |pixel: &[f32; 3]| -> [f32; 3] {
            std::array::from_fn(|c| map(f64::from(pixel[c]), c) as f32)
        };
        let pixels = golden.radiance().iter().map(edited).collect();
        let test = Picture::Radiance(Film::new(32, 24, pixels));
        measured(&case("figures/figure-1"), &golden, &test).join("; ")
    }

    #[test]
    fn simple_maps_are_measured() {
        assert_eq!(said(|x, _| 1.3 * x), "the image is the golden × 1.300");
        let codes = said(|x, _| 255.0 * x);
        assert!(codes.ends_with(": divide the codes by 255"), "{codes}");
        let tint = [1.1, 1.0, 0.9];
        assert_eq!(
            said(|x, c| tint[c] * x),
            "the image is the golden × 1.100, 1.000, 0.900 in red, green and blue"
        );
        assert_eq!(
            said(|x, _| 0.9 * x + 0.05),
            "the image is the golden × 0.900 + 0.050"
        );
        assert_eq!(
            said(|x, _| 1.5 * math::exp(0.8 * math::ln(x))),
            "the image is the golden to the power of 0.800, × 1.500"
        );
        assert_eq!(said(|x, _| 0.0 * x), "");
        assert_eq!(said(|x, _| if x > 0.4 { 1.3 * x } else { x }), "");
    }

    /// Rounding to 8 bits leaves factors open that are 1, and those that are not are not made so.
    #[test]
    fn a_channel_that_is_right_has_the_factor_1() {
        let case = case("figures/figure-1");
        let colours = golden();
        let quantisation = Bits::UNKNOWN.of_png(case.exposure);
        let tint = [1.02, 1.0, 1.0];
        let edited = |pixel: &[f32; 3]| -> [f32; 3] {
            std::array::from_fn(|c| (tint[c] * f64::from(pixel[c])) as f32)
        };
        let pixels = colours.radiance().iter().map(edited).collect();
        let test = quantisation.rounded(&Film::new(32, 24, pixels));
        let said = measured(&case, &colours, &Picture::Radiance(test)).join("; ");
        assert!(
            said.ends_with(", 1.000, 1.000 in red, green and blue"),
            "{said}"
        );
        assert!(said.starts_with("the image is the golden × 1.0"), "{said}");
    }

    /// Beside black nothing is a factor, and one number says all.
    #[test]
    fn of_a_black_golden_the_mean_is_said() {
        let black = Film::new(32, 24, vec![[0.0; 3]; 32 * 24]);
        let test = Picture::Radiance(golden());
        // Means over the columns, twice that, and the rows: (31 + 11.5 + 0.3) / 132.
        assert_eq!(
            measured(&case("figures/figure-1"), &black, &test),
            ["the golden is black, and the mean of the image is 0.324"]
        );
    }

    /// A PNG of another exposure, saturated or not; shadows of another depth are none.
    #[test]
    fn exposures_are_measured_in_8_bits() {
        let case = case("figures/figure-1");
        let golden = golden();
        let said = |map: &dyn Fn(f64) -> f64| {
            let edited = |pixel: &[f32; 3]| pixel.map(|x| map(f64::from(x)) as f32);
            let pixels = golden.radiance().iter().map(edited).collect();
            let codes = Film::new(32, 24, pixels).srgb_codes(case.exposure);
            let codes = SrgbImage::new(32, 24, codes).unwrap();
            // Judged by how it looks, and as radiance.
            let radiance = Picture::Radiance(decoded(&codes, case.exposure));
            let [said, of_radiance] = [Picture::Codes(codes), radiance].map(|picture| {
                let said = measured(&case, &golden, &picture).join("; ");
                let is_said = is_another_exposure(&case, &golden, &picture);
                assert_eq!(!said.is_empty(), is_said);
                said
            });
            assert_eq!(said.is_empty(), of_radiance.is_empty(), "{of_radiance}");
            said
        };
        // Codes are rounded: 0.1 % of a mean over 2304 values.
        assert!(said(&|x| 0.5 * x).starts_with("the image is the golden × 0.5"));
        assert!(said(&|x| 0.5 * x).ends_with(", another exposure (−1.00 stops)"));
        assert!(said(&|x| 4.0 * x).ends_with(", another exposure (+2.00 stops)"));
        assert_eq!(said(&|x| if x > 0.4 { 0.5 * x } else { x }), "");
        assert_eq!(said(&|_| 0.0), "");
    }

    /// A factor in noise, stated or not, and noise alone.
    #[test]
    fn factors_are_measured_in_noise_too() {
        use crate::math::rng::{Purpose, Stream};
        let noisy = |factor: f64, seed: u64, states: bool| {
            let values = golden();
            let sigma = 0.05;
            let pixel = |(index, pixel): (usize, &[f32; 3])| -> [f32; 3] {
                let stream = Stream::new(seed, index as u32, 0);
                std::array::from_fn(|c| {
                    let u = stream.uniform(0, Purpose::Camera, c as u32) - 0.5;
                    let value = f64::from(pixel[c]) + 1.0 + u * sigma * 12_f64.sqrt();
                    (factor * value) as f32
                })
            };
            let pixels = values.radiance().iter().enumerate().map(pixel).collect();
            if states {
                let variance = (factor * factor * sigma * sigma) as f32;
                Film::with_noise(32, 24, pixels, vec![[variance; 3]; 32 * 24], 16)
            } else {
                Film::new(32, 24, pixels)
            }
        };
        let case = case("fog/forward");
        let golden = noisy(1.0, 1, true);
        for states in [true, false] {
            let test = Picture::Radiance(noisy(1.3, 2, states));
            let said = measured(&case, &golden, &test).join("; ");
            // The mean of 2304 values that deviate by at most 5 % is within 0.1 %, five times over.
            assert!(said.starts_with("the image is the golden × 1."), "{said}");
            let factor: f64 = said.rsplit(' ').next().unwrap().parse().unwrap();
            assert!((factor - 1.3).abs() < 0.0075, "{said}");
            let same = Picture::Radiance(noisy(1.0, 3, states));
            assert_eq!(measured(&case, &golden, &same), Vec::<String>::new());
        }
    }
}

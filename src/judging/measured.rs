//! Measurements of a failed image, without rendering anything: a simple map from the golden to it.
//!
//! These are statements about the image, not guesses at what went wrong: none is made unless it
//! holds for all of the image.

use crate::compare::coarse::Coarse;
use crate::compare::unexplained::{UNEXPLAINED, UNEXPLAINED_IN_NOISE, makes_what_shows};
use crate::compare::{Conditions, Picture, default_gate, judge};
use crate::film::{Film, Origin, Quantisation};
use crate::math;
use crate::suite::Case;
use crate::variations::edited_film::mapped;

/// The largest code of 8 bits.
const LARGEST_CODE: f64 = 255.0;

/// Statement on an image of whole numbers, and of many.
const OF_CODES: &str =
    "every value is a whole number from 0 to 255: the image holds codes, not radiance";

/// Statement that `picture` holds codes that were written as numbers.
pub(crate) fn codes_in_words(picture: &Picture) -> Option<String> {
    let codes = Quantisation::of_whole_numbers(picture.radiance()?);
    codes.map(|_| OF_CODES.to_owned())
}

/// A simple map from a golden to an image of its case.
pub(crate) struct SimpleMap {
    /// A sentence without a full stop.
    pub words: String,
    /// It is a factor, or one for each channel.
    pub is_gain: bool,
}

/// The simple map from the golden to the radiance of `picture`, if there is one.
pub(crate) fn simple(case: &Case, golden: &Film, picture: &Picture) -> Option<SimpleMap> {
    if golden.mean_magnitude() == Some(0.0) {
        let test = picture.radiance().filter(|it| golden.is_comparable(it))?;
        let mean = number(test.mean_magnitude().unwrap_or_default());
        return Some(SimpleMap {
            words: format!("the golden is black, and the mean of the image is {mean}"),
            is_gain: false,
        });
    }
    let map = simple_map(case, golden, picture)?;
    Some(SimpleMap {
        words: match map.factor() {
            Some(factor) if is_of_png(picture) => another_exposure(factor),
            _ => map.in_words(),
        },
        is_gain: map.offset == 0.0 && map.exponent == 1.0,
    })
}

/// True of codes, and of radiance from those of a PNG image.
pub(crate) fn is_of_png(picture: &Picture) -> bool {
    match picture {
        Picture::Codes(_) => true,
        Picture::Radiance(film) => film
            .quantisation()
            .is_some_and(|it| it.origin == Origin::Png),
    }
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

/// A map of every value of an image: to the power of an exponent, times a factor of its channel, plus an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Map {
    factors: [f64; 3],
    exponent: f64,
    offset: f64,
}

impl Map {
    /// Each channel times a factor.
    fn scaled(factors: [f64; 3]) -> Map {
        Map {
            factors,
            exponent: 1.0,
            offset: 0.0,
        }
    }

    /// The factor, if that is all.
    fn factor(&self) -> Option<f64> {
        (*self == Map::scaled([self.factors[0]; 3])).then_some(self.factors[0])
    }

    fn of(&self, film: &Film) -> Film {
        mapped(film, |x, channel| {
            let factor = self.factors[channel];
            if self.exponent == 1.0 {
                return (factor * x + self.offset, factor);
            }
            let power = match x > 0.0 {
                true => factor * math::exp(self.exponent * math::ln(x)),
                false => 0.0,
            };
            (
                power + self.offset,
                self.exponent * power / x.max(f64::MIN_POSITIVE),
            )
        })
    }

    /// True if `test` shows the map of `golden`, which leaves little of what it is without its factor: a few codes, or
    /// less than the tolerance, are no measurement.
    fn shows(&self, golden: &Film, test: &Film) -> bool {
        let nothing = mapped(golden, |_, _| (self.offset, 0.0));
        makes_what_shows(&self.of(golden), test, &nothing)
    }

    /// True if the map is increasing, apart from its offset.
    fn is_growing(&self) -> bool {
        let numbers = self.factors.into_iter().chain([self.exponent]);
        self.offset.is_finite() && numbers.into_iter().all(|it| it > 0.0 && it.is_finite())
    }

    fn in_words(&self) -> String {
        let [r, g, b] = self.factors.map(number);
        let sign = if self.offset < 0.0 { "−" } else { "+" };
        let map = match self.factor() {
            Some(factor) if (factor / LARGEST_CODE - 1.0).abs() < 1e-3 => {
                format!("× {r}: divide the codes by 255")
            }
            Some(_) => format!("× {r}"),
            None if self.offset != 0.0 => format!("× {r} {sign} {}", number(self.offset.abs())),
            None if self.exponent != 1.0 => {
                format!("to the power of {}, × {r}", number(self.exponent))
            }
            None => format!("× {r}, {g}, {b} in red, green and blue"),
        };
        format!("the image is the golden {map}")
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

/// The simplest map of the golden after which the gate of the case cannot tell it from `picture`.
fn simple_map(case: &Case, golden: &Film, picture: &Picture) -> Option<Map> {
    let is_sampled = case.sampling.is_some();
    let (test, is_of_codes) = (picture.film(case.exposure), picture.radiance().is_none());
    if !golden.is_comparable(&test) {
        return None;
    }
    let mut maps = maps(golden, &test)?;
    if is_of_codes {
        maps.truncate(1);
    } else if is_sampled {
        // The mean of a power is not the power of the mean: with noise there is no telling.
        maps.retain(|map| map.exponent == 1.0);
    }
    let mut maps = maps.into_iter().filter(Map::is_growing);
    if is_sampled && !is_of_codes {
        let blocks = Coarse::of_blocks(golden);
        let test = Coarse::of_blocks(&test).with_noise_spread_like(&blocks);
        let weights = blocks.weights(&test);
        let whole = blocks.distance(&test, &weights);
        return maps.find(|map| {
            let mapped = Coarse::of_blocks(&map.of(golden));
            let left = mapped.distance(&test, &weights);
            whole.at_least() > 0.0
                && left.is_explained(&whole, UNEXPLAINED_IN_NOISE)
                && mapped.agrees(&test)
        });
    }
    let colours = golden.clone().without_opacity();
    let agrees = |film: Film| {
        let film = Picture::Radiance(film);
        let conditions = Conditions {
            exposure: case.exposure,
            ..Conditions::default()
        };
        let (gate, _) = default_gate(&film, picture);
        judge(gate, &film, picture, &conditions).is_ok_and(|judgement| judgement.passed)
    };
    // No colour map is reported if colours agree, or if only a few pixels differ.
    let pixels = Coarse::of_pixels(&colours);
    let weights = pixels.clone().without_noise().weights(&pixels);
    let left = |prediction: &Film| {
        let nearest = Coarse::of_pixels(&test.nearest_to(prediction));
        Coarse::of_pixels(prediction)
            .distance(&nearest, &weights)
            .value
    };
    let whole = left(&colours);
    let holds = |map: &Map| {
        let mapped = map.of(&colours);
        let is_little = is_of_codes || left(&mapped) <= UNEXPLAINED * whole;
        is_little && map.shows(&colours, &test) && agrees(mapped)
    };
    let found = maps.find(holds).filter(|_| !agrees(colours.clone()))?;
    // Rounding leaves factors open that are 1.
    let is_open = found.factor().is_none() && test.quantisation().is_some();
    Some((0..3).filter(|_| is_open).fold(found, |map, c| {
        let mut factors = map.factors;
        factors[c] = 1.0;
        Some(Map { factors, ..map }).filter(holds).unwrap_or(map)
    }))
}

/// The maps of `golden` that are nearest to `test`, the simplest first: one factor, one for each channel, a factor and an
/// offset, a factor and an exponent.
fn maps(golden: &Film, test: &Film) -> Option<Vec<Map>> {
    let mean = golden.mean_magnitude().filter(|&mean| mean > 0.0)?;
    // A value that is cut off says nothing of a factor.
    let most = test.quantisation().map_or(f64::INFINITY, |it| it.largest());
    let [mut values, mut logarithms] = [[[0.0; 5]; 3]; 2];
    for (golden, test) in golden.radiance().iter().zip(test.radiance()) {
        for c in 0..3 {
            let (a, b) = (f64::from(golden[c]), f64::from(test[c]));
            if b < most * (1.0 - 1e-3) {
                let size = a.abs() + mean;
                add(&mut values[c], 1.0 / (size * size), [a, b]);
            }
            if a > 0.0 && b > 0.0 {
                // Relative differences again: those of the logarithms.
                let share = a / (a + mean);
                add(&mut logarithms[c], share * share, [a, b].map(math::ln));
            }
        }
    }
    let all = |sums: &[[f64; 5]; 3]| -> [f64; 5] {
        std::array::from_fn(|i| sums.iter().map(|sums| sums[i]).sum())
    };
    // A channel that is black in the golden stays so under any factor.
    let factor = |[_, _, _, aa, ab]: [f64; 5]| if aa > 0.0 { ab / aa } else { 1.0 };
    // An image of one value is shifted as well as scaled: that was tried.
    let [slope, offset] = line(all(&values));
    let [exponent, of_power] = line(all(&logarithms));
    Some(vec![
        Map::scaled([factor(all(&values)); 3]),
        Map::scaled(values.map(factor)),
        Map {
            offset,
            ..Map::scaled([slope; 3])
        },
        Map {
            exponent,
            ..Map::scaled([math::exp(of_power); 3])
        },
    ])
}

/// Adds a point to weighted sums of 1, x, y, x² and x y.
pub(super) fn add(sums: &mut [f64; 5], weight: f64, [x, y]: [f64; 2]) {
    for (sum, value) in sums.iter_mut().zip([1.0, x, y, x * x, x * y]) {
        *sum += weight * value;
    }
}

/// Slope and offset of the line nearest to points, by such sums.
pub(super) fn line([weights, x, y, xx, xy]: [f64; 5]) -> [f64; 2] {
    let slope = (weights * xy - x * y) / (weights * xx - x * x);
    [slope, (y - slope * x) / weights]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::flip::SrgbImage;
    use crate::film::Bits;
    use crate::suite::Suite;
    use std::path::Path;

    fn measured(case: &Case, golden: &Film, picture: &Picture) -> Vec<String> {
        let map = simple(case, golden, picture).map(|map| map.words);
        codes_in_words(picture).into_iter().chain(map).collect()
    }

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
            let radiance = Picture::Radiance(Picture::Codes(codes.clone()).film(case.exposure));
            let [said, of_radiance] = [Picture::Codes(codes), radiance].map(|picture| {
                let said = measured(&case, &golden, &picture).join("; ");
                let is_said = simple(&case, &golden, &picture).is_some_and(|map| map.is_gain);
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

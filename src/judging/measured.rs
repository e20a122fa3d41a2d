//! Measurements of a failed image, without rendering anything: the factor from the golden to it.
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

/// A sentence, without a full stop, on the factor, or one for each channel, after which the gate of the case cannot tell
/// the golden from `picture`, if there is one.
pub(crate) fn gain(case: &Case, golden: &Film, picture: &Picture) -> Option<String> {
    let (test, is_of_codes) = (picture.film(case.exposure), picture.radiance().is_none());
    if !golden.is_comparable(&test) {
        return None;
    }
    let mut tried = factors(golden, &test)?;
    // Looks do not tell the factors of channels apart.
    tried.truncate(if is_of_codes { 1 } else { 2 });
    tried.retain(|factors| factors.iter().all(|it| *it > 0.0 && it.is_finite()));
    let found = if case.sampling.is_some() && !is_of_codes {
        in_noise(tried, golden, &test)
    } else {
        without_noise(tried, (case, golden), picture, &test)
    };
    found.map(|factors| in_words(factors, is_of_png(picture)))
}

/// True of codes, and of radiance from those of a PNG image.
pub(crate) fn is_of_png(picture: &Picture) -> bool {
    let of_png = |codes: Quantisation| codes.origin == Origin::Png;
    let film = picture.radiance();
    film.is_none_or(|film| film.quantisation().is_some_and(of_png))
}

fn in_words(factors: [f64; 3], is_of_png: bool) -> String {
    let [r, g, b] = factors.map(|factor| format!("{factor:.4}"));
    let what = if factors != [factors[0]; 3] {
        format!("{r}, {g}, {b} in red, green and blue")
    } else if is_of_png {
        let stops = math::ln(factors[0]) / std::f64::consts::LN_2;
        format!("{r}, as at another exposure ({stops:+.2} stops)")
    } else if (factors[0] / LARGEST_CODE - 1.0).abs() < 1e-3 {
        format!("{r}: divide the codes by 255")
    } else {
        r
    };
    format!("the image is the golden × {what}")
}

fn scaled(film: &Film, factors: &[f64; 3]) -> Film {
    mapped(film, |x, channel| (factors[channel] * x, factors[channel]))
}

/// The first of these factors that leave little of the difference of means of samples.
fn in_noise(tried: Vec<[f64; 3]>, golden: &Film, test: &Film) -> Option<[f64; 3]> {
    let blocks = Coarse::of_blocks(golden);
    let test = Coarse::of_blocks(test).with_noise_spread_like(&blocks);
    let weights = blocks.weights(&test);
    let whole = blocks.distance(&test, &weights);
    let mut tried = tried.into_iter();
    tried.find(|factors| {
        let scaled = Coarse::of_blocks(&scaled(golden, factors));
        let left = scaled.distance(&test, &weights);
        whole.at_least() > 0.0
            && left.is_explained(&whole, UNEXPLAINED_IN_NOISE)
            && scaled.agrees(&test)
    })
}

/// The first of these factors by which the golden passes for `picture`, of this radiance, if it does not as it is.
fn without_noise(
    tried: Vec<[f64; 3]>,
    (case, golden): (&Case, &Film),
    picture: &Picture,
    test: &Film,
) -> Option<[f64; 3]> {
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
    let pixels = Coarse::of_pixels(&colours);
    let weights = pixels.clone().without_noise().weights(&pixels);
    let left = |prediction: &Film| {
        let nearest = Coarse::of_pixels(&test.nearest_to(prediction));
        Coarse::of_pixels(prediction)
            .distance(&nearest, &weights)
            .value
    };
    let whole = left(&colours);
    let black = scaled(&colours, &[0.0; 3]);
    let holds = |factors: &[f64; 3]| {
        let scaled = scaled(&colours, factors);
        let is_little = picture.radiance().is_none() || left(&scaled) <= UNEXPLAINED * whole;
        // A few codes, or less than the tolerance, are no measurement.
        is_little && makes_what_shows(&scaled, test, &black) && agrees(scaled)
    };
    // No factor is reported if colours agree, or if only a few pixels differ.
    let found = tried.into_iter().find(holds)?;
    (!agrees(colours.clone())).then_some(found)
}

/// The factors on `golden` that lead nearest to `test`, by relative differences: one, and one for each channel.
fn factors(golden: &Film, test: &Film) -> Option<Vec<[f64; 3]>> {
    let mean = golden.mean_magnitude().filter(|&mean| mean > 0.0)?;
    // A value that is cut off says nothing of a factor.
    let most = test.quantisation().map_or(f64::INFINITY, |it| it.largest());
    let [mut squares, mut products] = [[0.0; 3]; 2];
    for (golden, test) in golden.radiance().iter().zip(test.radiance()) {
        for c in 0..3 {
            let (a, b) = (f64::from(golden[c]), f64::from(test[c]));
            if b < most * (1.0 - 1e-3) {
                let size = a.abs() + mean;
                squares[c] += a * a / (size * size);
                products[c] += a * b / (size * size);
            }
        }
    }
    // A channel that is black in the golden stays so under any factor.
    let factor = |aa: f64, ab: f64| if aa > 0.0 { ab / aa } else { 1.0 };
    let of_all = factor(squares.iter().sum(), products.iter().sum());
    Some(vec![
        [of_all; 3],
        [0, 1, 2].map(|c| factor(squares[c], products[c])),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::flip::SrgbImage;
    use crate::suite::Suite;
    use std::path::Path;

    fn measured(case: &Case, golden: &Film, picture: &Picture) -> Vec<String> {
        let map = gain(case, golden, picture);
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
    fn gains_are_measured() {
        assert_eq!(said(|x, _| 1.3 * x), "the image is the golden × 1.3000");
        let codes = said(|x, _| 255.0 * x);
        assert!(codes.ends_with(": divide the codes by 255"), "{codes}");
        let tint = [1.1, 1.0, 0.9];
        assert_eq!(
            said(|x, c| tint[c] * x),
            "the image is the golden × 1.1000, 1.0000, 0.9000 in red, green and blue"
        );
        assert_eq!(said(|x, _| 0.0 * x), "");
        assert_eq!(said(|x, _| if x > 0.4 { 1.3 * x } else { x }), "");
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
                let is_said = gain(&case, &golden, &picture).is_some();
                assert_eq!(!said.is_empty(), is_said);
                said
            });
            assert_eq!(said.is_empty(), of_radiance.is_empty(), "{of_radiance}");
            said
        };
        // Codes are rounded: 0.1 % of a mean over 2304 values.
        assert!(said(&|x| 0.5 * x).starts_with("the image is the golden × 0.5"));
        assert!(said(&|x| 0.5 * x).ends_with(", as at another exposure (-1.00 stops)"));
        assert!(said(&|x| 4.0 * x).ends_with(", as at another exposure (+2.00 stops)"));
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

//! Quantisation of an image: values rounded to codes of 8 bits, linear or sRGB.
//!
//! A rounded value says that the value before lies within half a code of it, and of the largest code only
//! that the value lies there or above. So of all images that round to the given one, the gates take the one
//! [nearest](Film::nearest_to) to the golden.

use super::{CHANNELS, Film};
use crate::math;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

/// Curve from linear light to codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// In proportion.
    Linear,
    /// IEC 61966-2-1.
    Srgb,
}

impl Encoding {
    /// Name, as in profiles.
    pub fn name(self) -> &'static str {
        match self {
            Encoding::Linear => "linear",
            Encoding::Srgb => "srgb",
        }
    }
}

/// Bits of a channel, as declared for images: `8`, `8-linear` or `8-srgb`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bits {
    /// Curve of the codes; `None` where it is to be found from the image.
    pub encoding: Option<Encoding>,
    /// Colour and opacity are rounded each, before they are blended with the background and rounded again.
    pub blended: bool,
}

impl FromStr for Bits {
    type Err = String;

    fn from_str(text: &str) -> Result<Bits, String> {
        let encoding = match text {
            "8" => None,
            "8-linear" => Some(Encoding::Linear),
            "8-srgb" => Some(Encoding::Srgb),
            _ => {
                return Err(
                    "the bits of a channel are 8, 8-linear or 8-srgb; images of 16 or 32 bits need no --bits"
                        .to_owned(),
                );
            }
        };
        Ok(Bits {
            encoding,
            blended: false,
        })
    }
}

impl fmt::Display for Bits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.encoding {
            None => f.write_str("8"),
            Some(encoding) => write!(f, "8-{}", encoding.name()),
        }
    }
}

impl Bits {
    /// Bits that were `given` for images, beside those of a profile, which alone says how values were blended.
    pub(crate) fn of(given: Option<Bits>, of_profile: Option<Bits>) -> Option<Bits> {
        let blended = of_profile.is_some_and(|bits| bits.blended);
        given.map(|given| Bits { blended, ..given }).or(of_profile)
    }

    /// Codes of a curve that nobody stated.
    pub(crate) const UNKNOWN: Bits = Bits {
        encoding: None,
        blended: false,
    };

    /// Quantisation of `film`, radiance from a linear file: the first curve, at no exposure or at `exposure` stops,
    /// by which all its values are codes.
    ///
    /// Values of a mean of several renderings, and values blended from codes, are no codes themselves: the curve is
    /// then the declared one, or linear.
    ///
    /// # Errors
    ///
    /// If some values of any other image are no codes: they were not rounded, and half a code excuses nothing.
    pub fn of_radiance(self, film: &Film, exposure: f64) -> Result<Quantisation, String> {
        let curves = candidates(Origin::Declared, self.blended, exposure)
            .filter(|found| self.encoding.is_none_or(|of| of == found.encoding));
        let mut faults = Vec::new();
        for found in curves {
            let Some(at) = found.no_code(film) else {
                return Ok(found);
            };
            faults.push((at, found));
        }
        let is_mean = film.noise().is_some_and(|noise| noise.is_of_renderings());
        // The curve that holds longest is the one that was meant.
        let fault = faults.into_iter().max_by_key(|(at, _)| *at);
        if let Some((at, curve)) = fault.filter(|_| !is_mean && !self.blended) {
            return Err(curve.no_code_in_words(at, film));
        }
        // Pixels that all of the renderings cut off have the largest.
        let brightest = film.brightest();
        let is_cut_off = (brightest * math::exp2(exposure) - 1.0).abs() < CUT_OFF;
        let is_beyond = brightest > 1.0 || is_cut_off;
        Ok(Quantisation {
            encoding: self.encoding.unwrap_or(Encoding::Linear),
            exposure: if is_beyond { exposure } else { 0.0 },
            origin: Origin::Assumed,
            blended: self.blended,
        })
    }

    /// Quantisation of a PNG image at `exposure` stops.
    pub fn of_png(self, exposure: f64) -> Quantisation {
        Quantisation {
            encoding: self.encoding.unwrap_or(Encoding::Srgb),
            exposure,
            origin: Origin::Png,
            blended: self.blended,
        }
    }
}

/// Source of what is known about a quantisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Declared, and every value is a code.
    Declared,
    /// Declared, though not every value is a code: a mean, or blended from codes.
    Assumed,
    /// Not declared: every value is a code.
    Recognised,
    /// Codes of a PNG image.
    Png,
}

/// Rounding to 256 codes from black to a largest radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantisation {
    /// Curve of the codes.
    pub encoding: Encoding,
    /// Exposure at which radiance was encoded, in stops.
    pub exposure: f64,
    /// Source of this.
    pub origin: Origin,
    /// Values were blended from rounded colours and opacities.
    pub blended: bool,
}

/// The largest code.
const LARGEST: f64 = 255.0;

/// Error of arithmetic in single precision beside half a code, in codes.
const SINGLE_PRECISION: f64 = 0.001;

/// Fewest different values of an image that is recognised: each of them is within
/// [`OF_A_CODE`] of a code by chance once in five, all of them less than once in 10¹¹.
const FEWEST_VALUES: usize = 16;

/// Relative error of single precision of the largest code.
const CUT_OFF: f64 = 1e-5;

/// Largest distance of an 8-bit value from its code, in codes: half precision rounds to 2⁻¹²,
/// which is 0.06 codes of 255.
const OF_A_CODE: f64 = 0.1;

/// Share of the codes that are rounded down, if nearly all are: an image that is half a code too dark for
/// another reason has some of both.
const ROUNDED_DOWN: f64 = 0.95;

impl Quantisation {
    /// The quantisation by which all values of `film` are codes, seen at `exposure` stops or at none; of films
    /// with so many values that this is no chance.
    pub fn recognised(film: &Film, exposure: f64) -> Option<Quantisation> {
        let are_many = |it: &Quantisation| it.levels(film).is_some_and(|n| n >= FEWEST_VALUES);
        candidates(Origin::Recognised, false, exposure).find(are_many)
    }

    /// Number of different codes in `film`; `None` if a value is no code.
    fn levels(&self, film: &Film) -> Option<usize> {
        let (mut values, mut levels) = (BTreeSet::new(), BTreeSet::new());
        for value in film.radiance().as_flattened() {
            if values.insert(value.to_bits()) {
                levels.insert(self.level(*value)?);
            }
        }
        Some(levels.len())
    }

    /// The code of `value`, if it is one.
    fn level(&self, value: f32) -> Option<u8> {
        let code = self.code(value.into());
        let level = code.round();
        let is_code = (code - level).abs() <= OF_A_CODE && (0.0..=LARGEST).contains(&level);
        is_code.then_some(level as u8)
    }

    /// Place of the first finite value of `film` that is no code. The gates judge values that are not finite.
    fn no_code(&self, film: &Film) -> Option<usize> {
        let mut values = film.radiance().as_flattened().iter();
        values.position(|&value| value.is_finite() && self.level(value).is_none())
    }

    /// A sentence that says which value of `film`, at `index` of all its values, is no code.
    fn no_code_in_words(&self, index: usize, film: &Film) -> String {
        let value = film.radiance().as_flattened()[index];
        let (pixel, channel) = (index / CHANNELS.len(), CHANNELS[index % CHANNELS.len()]);
        format!(
            "--bits declares codes of 8 bits, but {channel} in column {} of row {} is {value}, which is {:.2} of 255; leave \
             --bits out for an image that was not rounded, or write codes divided by 255",
            pixel % film.width(),
            pixel / film.width(),
            self.code(value.into())
        )
    }

    /// Place of a radiance among the codes; above the largest where it is cut off.
    fn code(&self, radiance: f64) -> f64 {
        let light = radiance * math::exp2(self.exposure);
        LARGEST
            * match self.encoding {
                Encoding::Linear => light,
                Encoding::Srgb => math::linear_to_srgb(light),
            }
    }

    fn radiance(&self, code: f64) -> f64 {
        let light = match self.encoding {
            Encoding::Linear => code / LARGEST,
            Encoding::Srgb => math::srgb_to_linear(code / LARGEST),
        };
        light * math::exp2(-self.exposure)
    }

    /// Radiance of the largest code.
    pub fn largest(&self) -> f64 {
        self.radiance(LARGEST)
    }

    /// The least and the largest radiance that round to the code of `value`; infinite for the largest code, which
    /// holds all that is brighter.
    fn interval(&self, value: f64) -> [f64; 2] {
        let code = self.code(value);
        // A value above the largest code was not rounded to it.
        if code > LARGEST + 0.5 {
            return [value; 2];
        }
        let level = code.round();
        let is_code = (code - level).abs() <= OF_A_CODE;
        let code = if is_code { level } else { code };
        let hidden = self.hidden() + SINGLE_PRECISION;
        let most = match code + hidden {
            beyond if beyond > LARGEST => f64::INFINITY,
            most => self.radiance(most),
        };
        [self.radiance(code - hidden), most]
    }

    /// Largest difference that rounding makes, in codes: half a code; of blended values half a code each for colour,
    /// opacity and sum.
    fn hidden(&self) -> f64 {
        if self.blended { 1.5 } else { 0.5 }
    }

    /// Largest difference that rounding makes at this radiance.
    pub(crate) fn half_code(&self, radiance: f64) -> f64 {
        let code = self.code(radiance).clamp(0.0, LARGEST);
        self.hidden() * (self.radiance(code + 0.5) - self.radiance(code - 0.5))
    }

    /// The image of codes, row by row from the top, as radiance.
    ///
    /// # Panics
    /// If there is not one code triple per pixel.
    pub fn decoded(self, width: usize, height: usize, codes: &[[u8; 3]]) -> Film {
        let decode = |code: u8| self.radiance(code.into()) as f32;
        let pixels = codes.iter().map(|pixel| pixel.map(decode)).collect();
        Film::new(width, height, pixels).quantised(self)
    }

    /// The nearest codes of `film`.
    pub fn codes(self, film: &Film) -> Vec<[u8; 3]> {
        let code = |value: f32| self.code(value.into()).round().clamp(0.0, LARGEST) as u8;
        film.radiance()
            .iter()
            .map(|pixel| pixel.map(code))
            .collect()
    }

    /// `film`, whose values are these codes, as if the codes followed another curve.
    pub(crate) fn read_as(self, encoding: Encoding, film: &Film) -> Film {
        let other = Quantisation { encoding, ..self };
        other.decoded(film.width(), film.height(), &self.codes(film))
    }

    /// `film` half a code brighter, if nearly all its codes are those of `golden`, of the same size, rounded down in
    /// place of to the nearest; else `None`.
    pub(crate) fn rounded_down(self, golden: &Film, film: &Film) -> Option<Film> {
        let values = [golden, film].map(|film| film.radiance().as_flattened().iter());
        let [exact, codes] = values.map(|them| them.map(|&value| self.code(value.into())));
        let pairs = exact.zip(codes.map(f64::round));
        // To the nearest they would be the code above.
        let telling = pairs.filter(|(exact, _)| exact - exact.floor() > 0.5 && *exact < LARGEST);
        let is_down: Vec<bool> = telling.map(|(exact, code)| exact.floor() == code).collect();
        let down = is_down.iter().filter(|&&it| it).count();
        if down < FEWEST_VALUES || (down as f64) < ROUNDED_DOWN * is_down.len() as f64 {
            return None;
        }
        let half_more = |value: f32| match self.code(value.into()).round() {
            level if level < LARGEST => self.radiance(level + 0.5) as f32,
            _ => value,
        };
        let pixels = film.radiance().iter().map(|pixel| pixel.map(half_more));
        // Opacity is a code of its own, and linear.
        let opacity = film.opacity().map(|values| {
            let half_more = |value: &f32| (value + (0.5 / LARGEST) as f32).min(1.0);
            values.iter().map(half_more).collect()
        });
        Some(Film {
            radiance: pixels.collect(),
            opacity,
            ..film.clone().quantised(self)
        })
    }

    /// `film` divided by 255, and as sRGB codes, if its values are whole numbers from 0 to 255; `None` if others are
    /// among them, or so few different ones that they may be radiance.
    pub(crate) fn of_whole_numbers(film: &Film) -> Option<[Film; 2]> {
        let is_code = |value: &f32| value.fract() == 0.0 && (0.0..=255.0).contains(value);
        if !film.radiance().as_flattened().iter().all(is_code) {
            return None;
        }
        let divide = |pixel: &[f32; 3]| pixel.map(|value| value / LARGEST as f32);
        let divided = Film {
            radiance: film.radiance().iter().map(divide).collect(),
            ..film.clone()
        };
        let linear = Quantisation::recognised(&divided, 0.0)?;
        let of = |encoding| linear.read_as(encoding, &divided);
        Some([Encoding::Linear, Encoding::Srgb].map(of))
    }

    /// `film` rounded to these codes, without its noise.
    pub fn rounded(self, film: &Film) -> Film {
        self.decoded(film.width(), film.height(), &self.codes(film))
    }

    /// True if a channel of `pixel` is above the largest code.
    pub(crate) fn cuts_off(&self, pixel: [f32; 3]) -> bool {
        pixel
            .into_iter()
            .any(|value| f64::from(value) > self.largest() * (1.0 + 1e-6))
    }
}

impl fmt::Display for Quantisation {
    /// `8 bits, linear`, and how that is known.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let encoding = ["linear", "sRGB"][usize::from(self.encoding == Encoding::Srgb)];
        write!(f, "8 bits, {encoding}")?;
        if self.blended {
            f.write_str(", blended from rounded colours and opacities")?;
        }
        if self.exposure != 0.0 {
            write!(f, " at exposure {}", self.exposure)?;
        }
        match self.origin {
            Origin::Declared | Origin::Png => Ok(()),
            Origin::Recognised => f.write_str(" (recognised: every value is such a code)"),
            Origin::Assumed => f.write_str(" (declared, though not every value is such a code)"),
        }
    }
}

/// Quantisations that images have: by either curve, at no exposure and at `exposure` stops.
fn candidates(origin: Origin, blended: bool, exposure: f64) -> impl Iterator<Item = Quantisation> {
    let of = move |encoding, exposure| Quantisation {
        encoding,
        exposure,
        origin,
        blended,
    };
    [0.0, exposure]
        .into_iter()
        .flat_map(move |stops| [Encoding::Srgb, Encoding::Linear].map(|it| of(it, stops)))
}

impl Film {
    /// This image as one whose values were rounded: the gates allow for that.
    pub(crate) fn quantised(self, quantisation: Quantisation) -> Film {
        Film {
            quantisation: Some(quantisation),
            ..self
        }
    }

    /// The rounding of its values, if it is known to have one.
    pub(crate) fn quantisation(&self) -> Option<Quantisation> {
        self.quantisation
    }

    /// The image nearest to `golden`, of the same size, among those that round to this one; this image where it is
    /// not quantised.
    pub(crate) fn nearest_to(&self, golden: &Film) -> Cow<'_, Film> {
        let Some(quantisation) = self.quantisation else {
            return Cow::Borrowed(self);
        };
        let nearest = |golden: f32, value: f32| {
            let [least, most] = quantisation.interval(value.into());
            match f64::from(golden) {
                golden if golden < least => least as f32,
                golden if golden > most => most as f32,
                _ => golden,
            }
        };
        let pixels = golden.radiance.iter().zip(&self.radiance);
        let pixels = pixels.map(|(a, b)| [0, 1, 2].map(|c| nearest(a[c], b[c])));
        Cow::Owned(Film {
            radiance: pixels.collect(),
            ..self.clone()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use half::f16;

    /// Slopes of three colours, from next to black to 0.96.
    fn golden() -> Film {
        let value = |i: usize, c: usize| ((i % 32 * (c + 1) + i / 32) as f32 + 0.3) / 132.0;
        let pixels = (0..32 * 24).map(|i| std::array::from_fn(|c| value(i, c)));
        Film::new(32, 24, pixels.collect())
    }

    fn mapped(film: &Film, map: impl Fn(f32) -> f32) -> Film {
        let pixels = film.radiance().iter().map(|pixel| pixel.map(&map));
        Film::new(film.width(), film.height(), pixels.collect())
    }

    #[test]
    fn codes_are_recognised_and_what_is_none_is_not() {
        for exposure in [0.0, 1.5] {
            for made in candidates(Origin::Recognised, false, exposure) {
                let film = made.rounded(&golden());
                assert_eq!(Quantisation::recognised(&film, exposure), Some(made));
                let half = mapped(&film, |x| f16::from_f32(x).to_f32());
                let found = Quantisation::recognised(&half, exposure);
                assert_eq!(found.map(|it| it.encoding), Some(made.encoding));
            }
        }
        assert_eq!(Quantisation::recognised(&golden(), 0.0), None);
        // Few values tell nothing.
        let few = mapped(&golden(), |x| if x > 0.5 { 1.0 } else { 0.0 });
        assert_eq!(Quantisation::recognised(&few, 0.0), None);
        let declared = "8-linear".parse::<Bits>().unwrap();
        let origin = |film: &Film| declared.of_radiance(film, 0.0).map(|it| it.origin);
        assert_eq!(origin(&few), Ok(Origin::Declared));
        let refused = origin(&golden()).unwrap_err().to_string();
        assert!(
            refused.contains("red in column 0 of row 0 is 0.0022727274"),
            "{refused}"
        );
        // A mean of roundings is no code, and not taken for one.
        let mean = Film::from_replicates(&[few.clone(), mapped(&few, |x| 0.0 * x)]).unwrap();
        assert_eq!(origin(&mean), Ok(Origin::Assumed));
        let mut broken = few.clone();
        broken.radiance[3][1] = f32::NAN;
        assert_eq!(origin(&broken), Ok(Origin::Declared));
        assert!("16".parse::<Bits>().is_err());
        // Three roundings hide three times as much.
        let blended = Bits {
            blended: true,
            ..declared
        };
        let [blended, once] = [blended, declared].map(|bits| bits.of_png(0.0));
        assert_eq!(blended.half_code(0.5), 3.0 * once.half_code(0.5));
        let off = Film::new(1, 1, vec![[0.5 + 1.4 / 255.0; 3]]).quantised(blended);
        let right = Film::new(1, 1, vec![[0.5; 3]]);
        assert_eq!(off.nearest_to(&right).radiance(), right.radiance());
        let off = off.quantised(once);
        assert_ne!(off.nearest_to(&right).radiance(), right.radiance());
        for text in ["8", "8-linear", "8-srgb"] {
            assert_eq!(text.parse::<Bits>().unwrap().to_string(), text);
        }
    }

    /// Roundings are hidden, in range and out of it, and no more than that.
    #[test]
    fn a_rounded_image_is_as_near_as_its_codes_allow() {
        let golden = golden();
        for made in candidates(Origin::Recognised, false, 1.0) {
            let test = made.rounded(&golden);
            assert_eq!(test.nearest_to(&golden).radiance(), golden.radiance());
            let brighter = made.rounded(&mapped(&golden, |x| 1.1 * x));
            let nearest = brighter.nearest_to(&golden);
            for (right, found) in golden.radiance().iter().zip(nearest.radiance()) {
                for (&right, &found) in right.iter().zip(found) {
                    let [golden, found] = [right, found].map(f64::from);
                    let is_cut_off = 1.1 * golden > made.largest();
                    // A whole code: half of it is hidden, half made by the rounding.
                    let least = 0.1 * golden - 2.1 * made.half_code(1.1 * golden);
                    assert!(is_cut_off || found - golden >= least, "{golden} {found}");
                    assert!(found - golden <= 0.1 * golden + 1e-6, "{golden} {found}");
                }
            }
        }
    }
}

//! Several images in one EXR file, each as a layer. Values are rounded to their noise, which makes
//! files of derivatives ten times smaller.

use super::exr_file::{channel, part, pixels, read_file, written_parts};
use super::exr_layers::samples_of;
use super::noise::rounded_to;
use super::{Film, FilmError};
use exr::prelude::{AnyChannel, FlatSamples, LayerAttributes, Text};

/// Significant bits of standard errors, the first included: a relative rounding error of 1/64 at most.
const BITS_OF_ERRORS: u32 = 6;

/// Bits of a value below its standard error: it is rounded by an eighth of that at most.
const BITS_BELOW_ERROR: i32 = 2;

/// Significant bits of a value, at least and at most.
const BITS: [i32; 2] = [3, 14];

/// Part of a channel's name, behind the name of the layer, that marks standard errors.
const ERROR: &str = "error";

/// Images, each with a name, a mean and standard errors.
#[derive(Clone, Debug, PartialEq)]
pub struct LayeredFilm {
    /// Origin of the layers.
    pub comment: String,
    /// Names, and images with noise.
    pub layers: Vec<(String, Film)>,
}

impl LayeredFilm {
    /// The file: channels `NAME.R` and `NAME.error.R`, and so on, in a part for each size of images.
    ///
    /// # Errors
    ///
    /// If there is no layer, or the encoder fails.
    pub fn to_exr(&self) -> Result<Vec<u8>, FilmError> {
        let size = |film: &Film| [film.width(), film.height()];
        let mut sizes: Vec<[usize; 2]> = self.layers.iter().map(|(_, film)| size(film)).collect();
        sizes.sort_unstable();
        sizes.dedup();
        if sizes.is_empty() {
            return Err(FilmError::noise("there is no layer to be written"));
        }
        let parts = sizes.into_iter().map(|of| {
            let layers = self.layers.iter().filter(|(_, film)| size(film) == of);
            let channels = layers
                .flat_map(|(name, film)| channels(name, film))
                .collect();
            let attributes = LayerAttributes {
                layer_name: Text::new_or_none(format!("{}x{}", of[0], of[1])),
                comments: Text::new_or_none(&self.comment),
                ..LayerAttributes::default()
            };
            part(of, attributes, channels)
        });
        written_parts(parts.collect())
    }

    /// The layers of such a file.
    ///
    /// # Errors
    ///
    /// If it is no EXR file, or a layer has no standard errors.
    pub fn from_exr(bytes: &[u8]) -> Result<LayeredFilm, FilmError> {
        let file = read_file(bytes)?;
        let mut layers = Vec::new();
        let mut comment = String::new();
        for part in &file.layer_data {
            if let Some(text) = &part.attributes.comments {
                comment = text.to_string();
            }
            let [width, height] = [part.size.width(), part.size.height()];
            let names = part.channel_data.list.iter().filter_map(|channel| {
                let name = channel.name.to_string();
                let name = name.strip_suffix(".R")?;
                (!name.ends_with(ERROR)).then(|| name.to_owned())
            });
            for name in names {
                let colours = |prefix: &str| {
                    let [r, g, b] = ["R", "G", "B"]
                        .map(|letter| samples_of(part, &format!("{prefix}.{letter}")));
                    Some(pixels([r?, g?, b?]))
                };
                let (Some(means), Some(errors)) =
                    (colours(&name), colours(&format!("{name}.{ERROR}")))
                else {
                    return Err(FilmError::noise("a layer lacks a channel"));
                };
                let variance = errors
                    .into_iter()
                    .map(|pixel| pixel.map(|error| error * error));
                let film = Film::with_noise(width, height, means, variance.collect(), 2);
                layers.push((name, film));
            }
        }
        Ok(LayeredFilm { comment, layers })
    }
}

/// Means and standard errors of a layer.
fn channels(name: &str, film: &Film) -> Vec<AnyChannel<FlatSamples>> {
    let mut channels = Vec::new();
    for (c, letter) in ["R", "G", "B"].into_iter().enumerate() {
        let errors: Vec<f32> = match film.noise() {
            Some(noise) => noise.variance().iter().map(|v| v[c].sqrt()).collect(),
            None => vec![0.0; film.radiance().len()],
        };
        let means = film.radiance().iter().zip(&errors);
        let means = means.map(|(mean, &error)| rounded(mean[c], error));
        channels.push(channel(&format!("{name}.{letter}"), means.collect()));
        let errors = errors.iter().map(|&it| rounded_to(BITS_OF_ERRORS, it));
        let name = format!("{name}.{ERROR}.{letter}");
        channels.push(channel(&name, errors.collect()));
    }
    channels
}

/// A value with the bits that its standard error leaves it.
fn rounded(value: f32, error: f32) -> f32 {
    // Holds for numbers below 2⁻¹²⁶ too: they are 0 here as anywhere.
    let exponent = |of: f32| (of.to_bits() >> (f32::MANTISSA_DIGITS - 1) & 0xff) as i32;
    let [least, most] = BITS;
    let bits = exponent(value) - exponent(error) + 1 + BITS_BELOW_ERROR;
    rounded_to(bits.clamp(least, most) as u32, value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_come_back_within_their_digits() {
        let film = |factor: f32| {
            let means: Vec<[f32; 3]> = (0..12)
                .map(|i| [i as f32 * factor, -factor, 1e-30])
                .collect();
            let variance = means.iter().map(|m| m.map(|v| v * v * 0.01)).collect();
            Film::with_noise(4, 3, means, variance, 16)
        };
        let mean = vec![[1.0 / 3.0, -0.7, 0.0]; 2];
        let fine = Film::with_noise(1, 2, mean, vec![[1e-12; 3]; 2], 16);
        let written = LayeredFilm {
            comment: "scene 17".to_owned(),
            layers: vec![
                ("density".to_owned(), film(0.3)),
                ("lamp.x".to_owned(), film(7e5)),
                ("index".to_owned(), fine),
            ],
        };
        let read = LayeredFilm::from_exr(&written.to_exr().unwrap()).unwrap();
        assert_eq!(read.comment, "scene 17");
        assert_eq!(read.layers.len(), written.layers.len());
        for (name, film) in &read.layers {
            let of = written.layers.iter().find(|(of, _)| of == name);
            let (_, of) = of.unwrap();
            let errors = of.noise().unwrap().variance().as_flattened();
            let values = film.radiance().as_flattened().iter();
            for ((a, b), variance) in values.zip(of.radiance().as_flattened()).zip(errors) {
                let off = (a - b).abs();
                // Fourteen bits at most.
                let most = f32::max(0.125 * variance.sqrt(), b.abs() / 16384.0);
                assert!(off <= most, "{a} {b}");
            }
            // Squared, the relative error doubles; the variance of a film has eight bits itself.
            let [a, b] = [film, of].map(|film| film.noise().unwrap().variance().as_flattened());
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() <= b * 0.04, "{a} {b}");
            }
        }
        assert!(LayeredFilm::from_exr(b"no image").is_err());
    }
}

//! Several images of one size in one EXR file, each as a layer, with few digits: what is as noisy as
//! derivatives are takes a tenth of its bytes so.

use super::exr_file::{floats, read_file, written};
use super::exr_layers::samples_of;
use super::noise::rounded_to;
use super::{Film, FilmError};
use exr::prelude::{AnyChannel, FlatSamples, LayerAttributes, Text};

/// Significant bits of values and errors, the first included: a relative rounding error of 1/64 at
/// most.
const BITS: u32 = 6;

/// Between the name of a layer and those of the channels with its standard errors.
const ERROR: &str = "error";

/// Images of one size, each with a name, a mean and standard errors.
#[derive(Clone, Debug, PartialEq)]
pub struct LayeredFilm {
    /// Origin of the layers.
    pub comment: String,
    /// Names, and images with noise.
    pub layers: Vec<(String, Film)>,
}

impl LayeredFilm {
    /// The file: channels `NAME.R` and `NAME.error.R`, and so on, of 32 bits of which six are
    /// significant.
    ///
    /// # Errors
    ///
    /// If there is no layer, or the encoder fails.
    pub fn to_exr(&self) -> Result<Vec<u8>, FilmError> {
        let Some((_, first)) = self.layers.first() else {
            return Err(FilmError::Noise("there is no layer to be written"));
        };
        let mut channels = Vec::new();
        for (name, film) in &self.layers {
            for (c, letter) in ["R", "G", "B"].into_iter().enumerate() {
                let values = film.radiance().iter().map(|pixel| rounded(pixel[c]));
                let values = FlatSamples::F32(values.collect());
                channels.push(AnyChannel::new(format!("{name}.{letter}").as_str(), values));
                if let Some(noise) = film.noise() {
                    let errors = noise
                        .variance()
                        .iter()
                        .map(|pixel| rounded(pixel[c].sqrt()));
                    let errors = FlatSamples::F32(errors.collect());
                    let name = format!("{name}.{ERROR}.{letter}");
                    channels.push(AnyChannel::new(name.as_str(), errors));
                }
            }
        }
        let attributes = LayerAttributes {
            comments: Text::new_or_none(&self.comment),
            ..LayerAttributes::default()
        };
        written([first.width(), first.height()], attributes, channels)
    }

    /// The layers of such a file.
    ///
    /// # Errors
    ///
    /// If it is no EXR file, or a layer has no standard errors.
    pub fn from_exr(bytes: &[u8]) -> Result<LayeredFilm, FilmError> {
        let file = read_file(bytes)?;
        let Some(part) = file.layer_data.first() else {
            return Err(FilmError::Noise("there is no layer in it"));
        };
        let [width, height] = [part.size.width(), part.size.height()];
        let comment = part.attributes.comments.as_ref();
        let comment = comment.map_or(String::new(), |comment| comment.to_string());
        let names = part.channel_data.list.iter().filter_map(|channel| {
            let name = channel.name.to_string();
            let name = name.strip_suffix(".R")?;
            (!name.ends_with(ERROR)).then(|| name.to_owned())
        });
        let mut layers = Vec::new();
        for name in names {
            let colours = |prefix: &str| {
                let channels = ["R", "G", "B"]
                    .map(|letter| samples_of(part, &format!("{prefix}.{letter}")).map(floats));
                let [r, g, b] = channels;
                let (r, g, b) = (r?, g?, b?);
                Some(
                    (0..r.len())
                        .map(|at| [r[at], g[at], b[at]])
                        .collect::<Vec<_>>(),
                )
            };
            let (Some(means), Some(errors)) = (colours(&name), colours(&format!("{name}.{ERROR}")))
            else {
                return Err(FilmError::Noise("a layer lacks a channel"));
            };
            let variance = errors
                .into_iter()
                .map(|pixel| pixel.map(|error| error * error));
            let film = Film::with_noise(width, height, means, variance.collect(), 2);
            layers.push((name, film));
        }
        Ok(LayeredFilm { comment, layers })
    }
}

fn rounded(value: f32) -> f32 {
    rounded_to(BITS, value)
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
        let written = LayeredFilm {
            comment: "scene 17".to_owned(),
            layers: vec![
                ("density".to_owned(), film(0.3)),
                ("lamp.x".to_owned(), film(7e5)),
            ],
        };
        let read = LayeredFilm::from_exr(&written.to_exr().unwrap()).unwrap();
        assert_eq!(read.comment, "scene 17");
        for ((name, film), (expected, of)) in read.layers.iter().zip(&written.layers) {
            assert_eq!(name, expected);
            for (a, b) in film
                .radiance()
                .as_flattened()
                .iter()
                .zip(of.radiance().as_flattened())
            {
                assert!((a - b).abs() <= b.abs() / 64.0, "{a} {b}");
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

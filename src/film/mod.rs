//! Linear radiance on a grid of pixels, and the readers and writers of image files.

mod alpha;
mod depth;
mod error;
mod exr_completeness;
mod exr_file;
mod exr_layers;
mod exr_meaning;
mod format;
mod layered_file;
mod noise;
mod npy_file;
mod pfm_file;
mod png_file;
mod primaries;
mod quantisation;
mod replicates;

use crate::math::Moments;

pub use alpha::Alpha;
pub use depth::Depth;
pub use error::FilmError;
pub use format::FilmFormat;
pub use layered_file::LayeredFilm;
pub use noise::Noise;
use noise::is_sound;
pub use quantisation::{Bits, Encoding, Origin, Quantisation};

/// Names of the channels of a pixel.
pub const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Linear, scene-referred RGB radiance, top row first; with opacity for a volume, and with noise if
/// the radiance is a mean of random samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: usize,
    height: usize,
    radiance: Vec<[f32; 3]>,
    opacity: Option<Vec<f32>>,
    noise: Option<Noise>,
    samples: Option<u64>,
    depth: Option<Vec<f32>>,
    changes_on_reading: Vec<String>,
    /// The rounding of its values, where it is read or declared.
    quantisation: Option<Quantisation>,
}

impl Film {
    /// Largest image that is read: 16384².
    pub const MOST_PIXELS: usize = 1 << 28;

    /// An image of the given radiances, row by row from the top.
    ///
    /// # Panics
    /// If there is not one value per pixel.
    pub fn new(width: usize, height: usize, radiance: Vec<[f32; 3]>) -> Film {
        assert_eq!(radiance.len(), width * height, "one value per pixel");
        Film {
            width,
            height,
            radiance,
            opacity: None,
            noise: None,
            samples: None,
            depth: None,
            changes_on_reading: Vec::new(),
            quantisation: None,
        }
    }

    /// An image of red, green, blue and opacity.
    ///
    /// # Panics
    /// If there is not one value per pixel.
    pub fn with_opacity(width: usize, height: usize, pixels: Vec<[f32; 4]>) -> Film {
        let opacity = pixels.iter().map(|pixel| pixel[3]).collect();
        let radiance = pixels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect();
        Film {
            opacity: Some(opacity),
            ..Film::new(width, height, radiance)
        }
    }

    /// An image of means of `samples` random samples each, with the estimated variances of those
    /// means ([`Moments::variance_of_mean`](crate::math::Moments::variance_of_mean)), rounded to
    /// eight significant bits. A single sample has no variance: use [`Film::new`], without noise.
    ///
    /// # Panics
    /// If there is not one value per pixel, or fewer than two samples.
    pub fn with_noise(
        width: usize,
        height: usize,
        radiance: Vec<[f32; 3]>,
        variance: Vec<[f32; 3]>,
        samples: u32,
    ) -> Film {
        assert_eq!(variance.len(), width * height, "one variance per pixel");
        assert!(samples >= 2, "one sample has no variance");
        let variance = variance
            .into_iter()
            .map(|pixel| pixel.map(noise::rounded))
            .collect();
        Film {
            noise: Some(Noise::of_samples(variance, samples)),
            samples: Some(samples.into()),
            ..Film::new(width, height, radiance)
        }
    }

    /// An image of the means of `samples` random samples of each pixel, with the variances of those
    /// means if there are at least two samples.
    ///
    /// # Panics
    /// If there is not one value per pixel.
    pub fn of_moments([width, height]: [usize; 2], pixels: &[[Moments; 3]], samples: u32) -> Film {
        let mean = |pixel: &[Moments; 3]| pixel.map(|channel| channel.mean() as f32);
        let means = pixels.iter().map(mean).collect();
        if samples < 2 {
            return Film::new(width, height, means);
        }
        let variance = |channel: Moments| channel.variance_of_mean().unwrap_or(0.0) as f32;
        let variances = pixels.iter().map(|pixel| pixel.map(variance)).collect();
        Film::with_noise(width, height, means, variances, samples)
    }

    /// This image with noise: the radiances of `variance`, an image of the same size, are the
    /// variances of its means of `samples` samples each, at least two. They are used unchanged.
    pub fn with_variance_of(self, variance: &Film, samples: u32) -> Result<Film, FilmError> {
        if self.noise.is_some() {
            let both = "both the image and the file beside it state variances: leave one out";
            return Err(FilmError::noise(both));
        }
        if (self.width, self.height) != (variance.width, variance.height) {
            let other = "the image and the file of its variances differ in size";
            return Err(FilmError::noise(other));
        }
        let variance = variance.radiance.clone();
        Ok(Film {
            noise: Some(Noise::of_samples(variance, samples)),
            samples: Some(samples.into()),
            ..self
        })
    }

    /// This image with a noise of zero in every pixel, as of [`u32::MAX`] samples, so that means of
    /// samples can be compared with its known radiances. Files do not keep that.
    pub fn known(self) -> Film {
        Film {
            noise: Some(Noise::none(self.radiance.len())),
            samples: None,
            ..self
        }
    }

    /// This image with `samples` [per pixel](Film::samples) in each of its renderings, as requested
    /// from a renderer. A number that the image itself states is kept.
    pub fn with_samples(self, samples: u32) -> Film {
        let renderings = self.renderings().unwrap_or(1);
        let asked = u64::from(samples) * u64::from(renderings);
        Film {
            samples: self.samples.or(Some(asked)),
            ..self
        }
    }

    /// This image without the pixels that are `left_out`, which are black and without noise.
    pub(crate) fn without(&self, left_out: &[bool]) -> Film {
        let mut film = self.clone();
        for (index, _) in left_out.iter().enumerate().filter(|(_, is)| **is) {
            film.radiance[index] = [0.0; 3];
            if let Some(noise) = &mut film.noise {
                noise.variance[index] = [0.0; 3];
            }
        }
        film
    }

    /// The films side by side, from left to right. All must have the same height, and all or none
    /// opacity. The noise is kept if all have noise from the same number of samples.
    pub fn side_by_side<'f>(films: &'f [Film]) -> Film {
        let (width, height) = (films.iter().map(Film::width).sum(), films[0].height);
        let in_row = |row: usize| {
            let columns =
                move |film: &'f Film| (0..film.width).map(move |x| (film, x + row * film.width));
            films.iter().flat_map(columns)
        };
        let places: Vec<(&Film, usize)> = (0..height).flat_map(in_row).collect();
        let places = || places.iter().copied();
        let mut film = Film::new(
            width,
            height,
            places().map(|(of, i)| of.radiance[i]).collect(),
        );
        film.opacity = places().map(|(of, i)| Some(of.opacity()?[i])).collect();
        let samples = |film: &Film| film.noise.as_ref().map(Noise::samples);
        if let Some(count) = samples(&films[0])
            && films.iter().all(|film| samples(film) == Some(count))
        {
            let variance: Option<_> = places()
                .map(|(of, i)| Some(of.noise()?.variance[i]))
                .collect();
            film.noise = variance.map(|variance| Noise::of_samples(variance, count));
            film.samples = Some(count.into());
        }
        film
    }

    /// Columns of pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows of pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Red, green and blue of every pixel, row by row from the top.
    pub fn radiance(&self) -> &[[f32; 3]] {
        &self.radiance
    }

    /// The largest value of any channel, at least 0.
    pub fn brightest(&self) -> f64 {
        let values = self.radiance.as_flattened().iter();
        values.fold(0.0, |most, &value| most.max(value.into()))
    }

    /// Mean magnitude of all values; `None` if a value is NaN.
    pub(crate) fn mean_magnitude(&self) -> Option<f64> {
        let values = self.radiance.as_flattened();
        let sum: f64 = values.iter().map(|x| f64::from(x.abs())).sum();
        let mean = sum / values.len() as f64;
        mean.is_finite().then_some(mean)
    }

    /// True if both films have one size and every value is finite.
    pub(crate) fn is_comparable(&self, other: &Film) -> bool {
        let size = |film: &Film| (film.width(), film.height());
        let is_number = |film: &Film| film.radiance.as_flattened().iter().all(|x| x.is_finite());
        size(self) == size(other) && is_number(self) && is_number(other)
    }

    /// Red, green, blue and opacity of pixel `index`, counted row by row; opacity 1 where the
    /// image has none.
    pub fn pixel(&self, index: usize) -> [f32; 4] {
        let [r, g, b] = self.radiance[index];
        let opacity = self.opacity.as_ref();
        [r, g, b, opacity.map_or(1.0, |opacity| opacity[index])]
    }

    /// Opacity of every pixel, in [0, 1], if the image has any.
    pub fn opacity(&self) -> Option<&[f32]> {
        self.opacity.as_deref()
    }

    /// Depth of every pixel, world units, if the image has any: the distance of what it shows.
    pub fn depth(&self) -> Option<&[f32]> {
        self.depth.as_deref()
    }

    /// This image with a depth in each pixel.
    ///
    /// # Panics
    /// If there is not one value per pixel.
    pub fn with_depth(self, depth: Vec<f32>) -> Film {
        assert_eq!(depth.len(), self.radiance.len(), "one depth per pixel");
        Film {
            depth: Some(depth),
            ..self
        }
    }

    /// This image with the depths of `depth`, an image of grey.
    ///
    /// # Errors
    ///
    /// If sizes differ, or both state depths.
    pub(crate) fn with_depth_of(self, depth: &Film) -> Result<Film, FilmError> {
        let is_grey = |of: &[f32; 3]| of.map(f32::to_bits) == [of[0].to_bits(); 3];
        let fault = if self.depth.is_some() {
            "both the image and the file beside it state depths: leave one out"
        } else if (self.width, self.height) != (depth.width, depth.height) {
            "the image and the file of its depths differ in size"
        } else if !depth.radiance.iter().all(is_grey) {
            "depths are one number a pixel, of the shape (height, width), and this is a picture"
        } else {
            let depths = depth.radiance.iter().map(|of| of[0]).collect();
            return Ok(self.with_depth(depths));
        };
        let message = format!("the depth of the image cannot be read: {fault}");
        Err(FilmError(message))
    }

    /// Samples per pixel, of all renderings together; `None` if neither the image nor its caller
    /// states them.
    pub fn samples(&self) -> Option<u64> {
        self.samples
    }

    /// Number of independent renderings combined without a sample count
    /// ([`Film::from_replicates`]).
    pub fn renderings(&self) -> Option<u32> {
        let noise = self.noise.as_ref()?;
        noise.is_of_renderings().then_some(noise.samples)
    }

    /// Changes of the pixels on reading, as ends of a sentence about the image: the choice of a layer, a
    /// scale.
    pub fn changes_on_reading(&self) -> &[String] {
        &self.changes_on_reading
    }

    /// Noise of the radiance, if it is a mean of random samples.
    pub fn noise(&self) -> Option<&Noise> {
        self.noise.as_ref()
    }

    /// Variance of the mean of a channel of the pixel `index`, radiance squared; 0 where the image states none.
    pub(crate) fn variance_at(&self, index: usize, channel: usize) -> f64 {
        let noise = self.noise.as_ref();
        noise.map_or(0.0, |noise| noise.variance()[index][channel].into())
    }

    /// The colours alone.
    pub fn without_opacity(self) -> Film {
        Film {
            opacity: None,
            ..self
        }
    }

    /// The image with another opacity in each pixel; unchanged without any.
    pub fn map_opacity(mut self, map: impl Fn(f32) -> f32) -> Film {
        if let Some(opacity) = &mut self.opacity {
            opacity.iter_mut().for_each(|value| *value = map(*value));
        }
        self
    }

    /// The first pixel whose radiance or opacity is negative or not finite: [column, row] and its
    /// value. If there is none, the first such pixel by variance: its variances and opacity.
    pub fn first_without_radiance(&self) -> Option<([usize; 2], [f32; 4])> {
        let position = |index: usize| [index % self.width, index / self.width];
        let broken = |index: &usize| !self.pixel(*index).iter().all(is_sound);
        if let Some(index) = (0..self.radiance.len()).find(broken) {
            return Some((position(index), self.pixel(index)));
        }
        let noise = self.noise.as_ref()?;
        let index = noise.first_without_variance()?;
        let [r, g, b] = noise.variance[index];
        Some((position(index), [r, g, b, self.pixel(index)[3]]))
    }

    /// BLAKE3 hash of size, channels and the bits of every pixel, and of the noise if there is any:
    /// equal only for equal images.
    pub fn pixel_hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        let noise = self.noise.as_ref();
        let channels = 3 + u64::from(self.opacity.is_some()) + if noise.is_some() { 4 } else { 0 };
        for number in [self.width as u64, self.height as u64, channels] {
            hasher.update(&number.to_le_bytes());
        }
        for value in self
            .radiance
            .iter()
            .flatten()
            .chain(self.opacity.iter().flatten())
            .chain(noise.iter().flat_map(|n| n.variance.as_flattened()))
        {
            hasher.update(&value.to_le_bytes());
        }
        if let Some(noise) = noise {
            hasher.update(&noise.samples.to_le_bytes());
        }
        hasher.finalize().to_hex().to_string()
    }
}

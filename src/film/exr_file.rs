//! OpenEXR, through the `exr` crate.
//!
//! Noise is written as channels of a single part, `variance.R` … `samples.Y`: a layer, in the terms
//! of OpenEXR, is a prefix of channel names. Viewers show R, G and B, and those with layers offer
//! the others; of several parts many programs read only the first.

use super::error::{check_claim, check_size};
use super::exr_completeness::{check_blocks, unreadable};
use super::exr_layers::{Colours, ExrPart, ExrParts, main_layer, samples_of};
use super::exr_meaning::{check_opacity, check_part, check_primaries};
use super::{Film, FilmError, Noise};
use crate::files::decoder;
use exr::meta::MetaData;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, Layer, LayerAttributes,
    ReadChannels, ReadLayers, Vec2, WritableImage, read,
};
use std::io::Cursor;

/// Channels with the variance of the mean of red, green and blue. Lower case only: pbrt writes
/// `Variance.R` for the variance of one sample, another quantity.
const VARIANCE: [&str; 3] = ["variance.R", "variance.G", "variance.B"];
/// Channel with the number of samples, the same in every pixel.
const SAMPLES: &str = "samples.Y";
/// Without the number of samples a variance tells nothing about rare light that was missed.
const NO_COUNT: &str = "there are variances, but no channel samples.Y: write the number of samples per pixel into \
it, the same everywhere; or give several renderings with different seeds in place of variances";

impl Film {
    /// The image as EXR, 32-bit float, lossless: R, G and B; A if there is opacity; Z if there is depth; if there is
    /// noise, the variances of the means as layer `variance` and the number of samples as layer
    /// `samples`.
    pub fn to_exr(&self) -> Result<Vec<u8>, FilmError> {
        let colour = |c: usize| self.radiance().iter().map(|pixel| pixel[c]).collect();
        let mut channels = vec![
            channel("R", colour(0)),
            channel("G", colour(1)),
            channel("B", colour(2)),
        ];
        if let Some(opacity) = self.opacity() {
            channels.push(channel("A", opacity.to_vec()));
        }
        if let Some(depth) = self.depth() {
            channels.push(channel("Z", depth.to_vec()));
        }
        if let Some(noise) = self.noise().filter(|noise| !noise.is_known()) {
            for (c, name) in VARIANCE.into_iter().enumerate() {
                let values = noise.variance().iter().map(|pixel| pixel[c]).collect();
                channels.push(channel(name, values));
            }
            // As whole numbers: a float has none above 2²⁴.
            let samples = FlatSamples::U32(vec![noise.samples(); self.radiance().len()]);
            channels.push(AnyChannel::new(SAMPLES, samples));
        }
        let size = [self.width(), self.height()];
        written_parts(vec![part(size, LayerAttributes::default(), channels)])
    }

    /// Reads an EXR image. The image is the display window: pixels outside are cut off, and pixels
    /// without data are black and transparent.
    ///
    /// Colours are the channels R, G and B, in upper or lower case, of half, float or integer type,
    /// with A if present; without any colours a channel Y is grey. They may be in a layer, either a
    /// part of the file with that name or channels such as `beauty.R`: the only layer with colours,
    /// else the one without a name, else the only one called `rgba`, `beauty` or `combined`. All
    /// else is ignored, except for noise: the layers `variance` (of the means; R, G, B) and
    /// `samples` (Y).
    ///
    /// Deep data, subsampled channels, luminance with chroma, colours that are not linear RGB with the primaries of Rec.709,
    /// environment maps, pixels that are not square, opacity that colours are not multiplied by, the compressions DWAA
    /// and DWAB and, of half floats, B44 and B44A, and files with a missing block of pixels in any part or resolution are
    /// refused. Values that are not finite are kept.
    pub fn from_exr(bytes: &[u8]) -> Result<Film, FilmError> {
        let file = read_file(bytes)?;
        picture(&file, &main_layer(&file)?)
    }

    /// Reads the file of variances beside an image: an EXR whose colours are variances of the
    /// mean, and whose channel `samples.Y` is the number of samples; for
    /// [`Film::with_variance_of`].
    pub fn variance_from_exr(bytes: &[u8]) -> Result<(Film, u32), FilmError> {
        let file = read_file(bytes)?;
        let colours = main_layer(&file)?;
        let samples = samples_of(colours.part, SAMPLES).ok_or(FilmError::noise(NO_COUNT))?;
        Ok((picture(&file, &colours)?, count(samples)?))
    }
}

/// A channel of these values.
pub(super) fn channel(name: &str, values: Vec<f32>) -> AnyChannel<FlatSamples> {
    AnyChannel::new(name, FlatSamples::F32(values))
}

/// A part of a file.
pub(super) fn part(
    [width, height]: [usize; 2],
    attributes: LayerAttributes,
    channels: Vec<AnyChannel<FlatSamples>>,
) -> Layer<AnyChannels<FlatSamples>> {
    Layer::new(
        (width, height),
        attributes,
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels.into()),
    )
}

/// The file of these parts. Where there are several, each has a name.
pub(super) fn written_parts(
    parts: Vec<Layer<AnyChannels<FlatSamples>>>,
) -> Result<Vec<u8>, FilmError> {
    let mut bytes = Cursor::new(Vec::new());
    let largest = |size: fn(&Layer<AnyChannels<FlatSamples>>) -> usize| {
        parts.iter().map(size).max().unwrap_or(0)
    };
    let size = Vec2(largest(|part| part.size.0), largest(|part| part.size.1));
    let attributes = ImageAttributes::with_size(size);
    Image::from_layers(attributes, parts)
        .write()
        .to_buffered(&mut bytes)
        .map_err(unreadable)?;
    Ok(bytes.into_inner())
}

fn picture(file: &ExrParts, colours: &Colours) -> Result<Film, FilmError> {
    let frame = PixelWindow::of(colours.part, file)?;
    check_opacity(colours)?;
    check_primaries(colours, file)?;
    let layer = colours.unusual_layer.iter();
    let changes_on_reading = layer
        .map(|layer| format!("was read from the layer {layer}"))
        .collect();
    let radiance = pixels(colours.rgb);
    let noise = noise(colours)?;
    let samples = match &noise {
        Some(noise) => Some(noise.samples),
        // Without variances the count is only used for advice, so a malformed one is ignored.
        None => samples_of(colours.part, SAMPLES).and_then(|samples| count(samples).ok()),
    };
    Ok(Film {
        width: frame.size[0],
        height: frame.size[1],
        radiance: frame.cut(radiance),
        opacity: colours.opacity.map(|opacity| frame.cut(floats(opacity))),
        noise: noise.map(|noise| Noise {
            variance: frame.cut(noise.variance),
            ..noise
        }),
        samples: samples.map(u64::from),
        changes_on_reading,
        quantisation: None,
        depth: colours.depth.map(|depth| frame.cut(floats(depth))),
    })
}

/// The colours of the pixels, given their channels.
pub(super) fn pixels(rgb: [&FlatSamples; 3]) -> Vec<[f32; 3]> {
    let [r, g, b] = rgb.map(floats);
    (0..r.len()).map(|i| [r[i], g[i], b[i]]).collect()
}

/// All parts of a file that is neither too large nor of a kind that cannot be used.
///
/// On some broken files the crate panics (chunks of another resolution than their table says, for
/// one). In one of its own threads a panic would end the process, so it is to use none.
pub(super) fn read_file(bytes: &[u8]) -> Result<ExrParts, FilmError> {
    let parts = decoder::run(|| read_parts(bytes));
    parts.map_err(|stopped| FilmError::stopped("EXR", stopped))?
}

fn read_parts(bytes: &[u8]) -> Result<ExrParts, FilmError> {
    // The size is checked in the header, before anything of that size is allocated.
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(unreadable)?;
    let mut claimed = 0_u64;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        check_size(width, height)?;
        // PXR24 drops one byte of four before it deflates.
        let pixel = header.channels.bytes_per_pixel as u64 * 3 / 4;
        claimed = claimed.saturating_add((width * height) as u64 * pixel);
    }
    check_claim(claimed, bytes.len())?;
    meta.headers.iter().try_for_each(check_part)?;
    check_blocks(bytes)?;
    read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(unreadable)
}

fn floats(samples: &FlatSamples) -> Vec<f32> {
    samples.values_as_f32().collect()
}

/// The noise of the image with the channels `colours`.
fn noise(colours: &Colours) -> Result<Option<Noise>, FilmError> {
    let channels = VARIANCE.map(|name| samples_of(colours.part, name));
    if channels.iter().all(Option::is_none) {
        return Ok(None);
    }
    let [Some(r), Some(g), Some(b)] = channels else {
        return Err(FilmError::noise("the layer variance lacks R, G or B"));
    };
    let samples = samples_of(colours.part, SAMPLES).ok_or(FilmError::noise(NO_COUNT))?;
    Ok(Some(Noise::of_samples(pixels([r, g, b]), count(samples)?)))
}

/// Where the pixels of an image lie among the pixels of a part of its file.
struct PixelWindow {
    /// Columns and rows of the image.
    size: [usize; 2],
    /// Column and row in the image of the first pixel of the part.
    first: [i64; 2],
    /// Columns and rows of the part.
    part: [usize; 2],
}

impl PixelWindow {
    /// Pixels without data cost a file nothing, so their number needs a bound of its own: 4096².
    const MOST_UNCOVERED: usize = 1 << 24;

    fn of(part: &ExrPart, file: &ExrParts) -> Result<PixelWindow, FilmError> {
        let display = file.attributes.display_window;
        let [width, height] = [display.size.width(), display.size.height()];
        check_size(width, height)?;
        let data = part.attributes.layer_position;
        let position = |at: i32, origin: i32| i64::from(at) - i64::from(origin);
        let frame = PixelWindow {
            size: [width, height],
            first: [
                position(data.x(), display.position.x()),
                position(data.y(), display.position.y()),
            ],
            part: [part.size.width(), part.size.height()],
        };
        let covered = |axis: usize| {
            let inside = |at: i64| at.clamp(0, frame.size[axis] as i64) as usize;
            inside(frame.first[axis] + frame.part[axis] as i64) - inside(frame.first[axis])
        };
        let covered = covered(0) * covered(1);
        if covered == 0 || width * height - covered > PixelWindow::MOST_UNCOVERED {
            return Err(FilmError::unsuited(
                format!(
                    "the data of this EXR cover {covered} of the {width} × {height} pixels of its display window"
                ),
                "make both windows equal",
            ));
        }
        Ok(frame)
    }

    /// The image, from the values of the part: zero where there are none.
    fn cut<T: Copy + Default>(&self, values: Vec<T>) -> Vec<T> {
        let ([width, height], [columns, rows]) = (self.size, self.part);
        let value = |index: usize| {
            let [x, y] = [(0, index % width), (1, index / width)]
                .map(|(axis, at)| usize::try_from(at as i64 - self.first[axis]).ok());
            let (x, y) = (x.filter(|x| *x < columns)?, y.filter(|y| *y < rows)?);
            Some(values[x + y * columns])
        };
        (0..width * height)
            .map(|index| value(index).unwrap_or_default())
            .collect()
    }
}

/// The number of samples, the same in every pixel.
fn count(samples: &FlatSamples) -> Result<u32, FilmError> {
    let counts: Vec<f64> = match samples {
        FlatSamples::U32(counts) => counts.iter().map(|&count| count.into()).collect(),
        _ => samples.values_as_f32().map(f64::from).collect(),
    };
    let first = counts.first().copied().unwrap_or(0.0);
    let is_number = first >= 2.0 && first <= f64::from(u32::MAX) && first.fract() == 0.0;
    match is_number && counts.iter().all(|&count| count == first) {
        true => Ok(first as u32),
        false => Err(FilmError::noise(
            "the number of samples must be a whole number of at least 2, the same in every pixel",
        )),
    }
}

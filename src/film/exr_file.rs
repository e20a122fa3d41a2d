//! OpenEXR, through the `exr` crate.
//!
//! Noise is written as channels of the one part, `variance.R` … `samples.Y`: a layer, in the
//! words of OpenEXR, is a prefix of channel names. Viewers show R, G and B, and those that know
//! layers offer the others; of several parts many programs read the first only.

use super::{Film, FilmError, Noise, check_claim};
use exr::meta::MetaData;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, ReadChannels,
    ReadLayers, WritableImage, read,
};
use std::io::Cursor;

/// Channels with the variance of the mean of red, green and blue. Only in small letters:
/// pbrt writes `Variance.R` for the variance of one sample, another quantity.
const VARIANCE: [&str; 3] = ["variance.R", "variance.G", "variance.B"];
/// Channel with the number of samples, the same in every pixel.
const SAMPLES: &str = "samples.Y";

fn unreadable(error: exr::error::Error) -> FilmError {
    let reason = match error.to_string().as_str() {
        // The words of the crate for the end of a file before the end of the image.
        "invalid: reference to missing bytes" => "the file ends too early".to_owned(),
        "invalid: file identifier missing" => "it does not begin like one".to_owned(),
        other => other.to_owned(),
    };
    FilmError::Unreadable {
        format: "EXR",
        reason,
    }
}

pub(super) fn encode(film: &Film) -> Result<Vec<u8>, FilmError> {
    let channel = |name: &str, values: Vec<f32>| AnyChannel::new(name, FlatSamples::F32(values));
    let colour = |c: usize| film.radiance().iter().map(|pixel| pixel[c]).collect();
    let mut channels = vec![
        channel("R", colour(0)),
        channel("G", colour(1)),
        channel("B", colour(2)),
    ];
    if let Some(opacity) = film.opacity() {
        channels.push(channel("A", opacity.to_vec()));
    }
    if let Some(noise) = film.noise() {
        for (c, name) in VARIANCE.into_iter().enumerate() {
            let values = noise.variance().iter().map(|pixel| pixel[c]).collect();
            channels.push(channel(name, values));
        }
        // As whole numbers: a float has none above 2²⁴.
        let samples = FlatSamples::U32(vec![noise.samples(); film.radiance().len()]);
        channels.push(AnyChannel::new(SAMPLES, samples));
    }
    let layer = Layer::new(
        (film.width(), film.height()),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels.into()),
    );
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(unreadable)?;
    Ok(bytes.into_inner())
}

pub(super) fn decode(bytes: &[u8]) -> Result<Film, FilmError> {
    // The size is checked in the header, before anything of that size is allocated.
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(unreadable)?;
    let mut claimed = 0_u64;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        if width.saturating_mul(height) > Film::MOST_PIXELS {
            return Err(FilmError::TooLarge { width, height });
        }
        // PXR24 drops one byte of four before it deflates.
        let pixel = header.channels.bytes_per_pixel as u64 * 3 / 4;
        claimed = claimed.saturating_add((width * height) as u64 * pixel);
    }
    check_claim(claimed, bytes.len())?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(unreadable)?;
    for layer in &image.layer_data {
        if name_of(layer) == "variance" {
            continue;
        }
        if let [Some(r), Some(g), Some(b)] = ["R", "G", "B"].map(|name| floats(layer, name)) {
            let radiance = (0..r.len()).map(|i| [r[i], g[i], b[i]]).collect();
            let (width, height) = (layer.size.width(), layer.size.height());
            return Ok(Film {
                width,
                height,
                radiance,
                opacity: floats(layer, "A"),
                noise: noise(layer, &image.layer_data)?,
            });
        }
    }
    let found = image.layer_data.iter().flat_map(|layer| {
        let layer_name = layer.attributes.layer_name.as_ref();
        let prefix = layer_name.map_or(String::new(), |name| format!("{name}."));
        let channels = layer.channel_data.list.iter();
        channels.map(move |channel| format!("{prefix}{}", channel.name))
    });
    let found = found.collect::<Vec<_>>().join(", ");
    Err(FilmError::Channels { found })
}

type AnyLayer = Layer<AnyChannels<FlatSamples>>;

fn name_of(layer: &AnyLayer) -> String {
    let name = layer.attributes.layer_name.as_ref();
    name.map_or(String::new(), |name| name.to_string())
}

fn samples_of<'l>(layer: &'l AnyLayer, name: &str) -> Option<&'l FlatSamples> {
    let mut channels = layer.channel_data.list.iter();
    channels
        .find(|channel| channel.name == *name)
        .map(|channel| &channel.sample_data)
}

fn floats(layer: &AnyLayer, name: &str) -> Option<Vec<f32>> {
    samples_of(layer, name).map(|samples| samples.values_as_f32().collect())
}

/// The noise of the image in `colours`, from its own channels or from other layers of its size.
fn noise(colours: &AnyLayer, layers: &[AnyLayer]) -> Result<Option<Noise>, FilmError> {
    let find = |full_name: &str| {
        let (layer_name, name) = full_name.split_once('.').expect("a name of ours");
        samples_of(colours, full_name).or_else(|| {
            let mut layers = layers.iter().filter(|layer| layer.size == colours.size);
            layers.find_map(|layer| match name_of(layer) == layer_name {
                true => samples_of(layer, name),
                false => samples_of(layer, full_name),
            })
        })
    };
    let channels = VARIANCE.map(find);
    if channels.iter().all(Option::is_none) {
        return Ok(None);
    }
    let [Some(r), Some(g), Some(b)] = channels else {
        return Err(FilmError::Noise("the layer variance lacks R, G or B"));
    };
    let [r, g, b]: [Vec<f32>; 3] = [r, g, b].map(|samples| samples.values_as_f32().collect());
    let Some(samples) = find(SAMPLES) else {
        return Err(FilmError::Noise(
            "there are variances, but no channel samples.Y: of how many samples?",
        ));
    };
    Ok(Some(Noise {
        variance: (0..r.len()).map(|i| [r[i], g[i], b[i]]).collect(),
        samples: count(samples)?,
    }))
}

/// The one number of samples that every pixel states.
fn count(samples: &FlatSamples) -> Result<u32, FilmError> {
    let counts: Vec<f64> = match samples {
        FlatSamples::U32(counts) => counts.iter().map(|&count| count.into()).collect(),
        _ => samples.values_as_f32().map(f64::from).collect(),
    };
    let first = counts.first().copied().unwrap_or(0.0);
    if counts.iter().any(|&count| count != first) {
        return Err(FilmError::Noise("not every pixel has as many samples"));
    }
    if !(first >= 2.0 && first <= f64::from(u32::MAX) && first.fract() == 0.0) {
        return Err(FilmError::Noise(
            "the number of samples is no whole number of at least 2",
        ));
    }
    Ok(first as u32)
}

//! OpenEXR, through the `exr` crate.

use super::{Film, FilmError, check_claim};
use exr::meta::MetaData;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, ReadChannels,
    ReadLayers, WritableImage, read,
};
use std::io::Cursor;

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
    let find = |layer: &Layer<AnyChannels<FlatSamples>>, name: &str| -> Option<Vec<f32>> {
        let channel = layer
            .channel_data
            .list
            .iter()
            .find(|channel| channel.name == *name)?;
        Some(channel.sample_data.values_as_f32().collect())
    };
    for layer in &image.layer_data {
        if let (Some(r), Some(g), Some(b)) = (find(layer, "R"), find(layer, "G"), find(layer, "B"))
        {
            let radiance = (0..r.len()).map(|i| [r[i], g[i], b[i]]).collect();
            let (width, height) = (layer.size.width(), layer.size.height());
            return Ok(Film {
                width,
                height,
                radiance,
                opacity: find(layer, "A"),
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

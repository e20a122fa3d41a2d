//! PNG, through the `image` crate.

use super::{Film, FilmError, check_claim};
use crate::math;
use image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder};
use std::io::Cursor;

pub(super) fn srgb_codes(radiance: &[[f32; 3]], exposure: f64) -> Vec<[u8; 3]> {
    let scale = math::exp2(exposure);
    let code = |value: f32| {
        let linear = (f64::from(value) * scale).clamp(0.0, 1.0);
        // A cast saturates and turns NaN into 0.
        (math::linear_to_srgb(linear) * 255.0 + 0.5) as u8
    };
    radiance.iter().map(|pixel| pixel.map(code)).collect()
}

pub(super) fn encode(codes: &[[u8; 3]], width: usize, height: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive)
        .write_image(
            codes.as_flattened(),
            width as u32,
            height as u32,
            ExtendedColorType::Rgb8,
        )
        .expect("the codes fill the image, and a vector takes every byte");
    bytes
}

pub(super) fn decode(bytes: &[u8]) -> Result<(usize, usize, Vec<[u8; 3]>), FilmError> {
    let unreadable = |error: image::ImageError| FilmError::Unreadable {
        format: "PNG",
        reason: error.to_string(),
    };
    let decoder = PngDecoder::new(Cursor::new(bytes)).map_err(unreadable)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    if width.saturating_mul(height) > Film::MOST_PIXELS {
        return Err(FilmError::TooLarge { width, height });
    }
    check_claim(decoder.total_bytes(), bytes.len())?;
    let codes = DynamicImage::from_decoder(decoder)
        .map_err(unreadable)?
        .into_rgb8();
    Ok((width, height, codes.pixels().map(|pixel| pixel.0).collect()))
}

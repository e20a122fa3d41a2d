//! PNG: pixels by the `image` crate, their encoding by the `png` crate below it, since `image` does
//! not report gamma.
//!
//! The codes must be sRGB. A file with other primaries, another gamma or profile is refused: converting
//! 8 bits would lose digits.

use super::error::{check_claim, check_size};
use super::primaries::are_rec709;
use super::{Bits, Film, FilmError};
use crate::files::decoder;
use image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, Limits};
use std::fmt::Display;
use std::io::Cursor;

/// Memory for a row, a chunk and a profile, in bytes: a profile can be a decompression bomb, too.
const MOST_MEMORY: u64 = 1 << 28;

/// Gamma of a file that does not state it: 1/2.2, which stands for sRGB if stated.
const SRGB_GAMMA: f64 = 0.45455;

/// Stated gammas within this distance are roundings of that one. A code is `255·vᵞ`, whose slope in
/// γ is `255·vᵞ·|ln v|`, at most `255/(e·γ)` = 206: this moves it by a tenth.
const GAMMA_ROUNDING: f64 = 0.0005;

impl Film {
    /// 8-bit sRGB codes of the radiance times 2^`exposure`, clipped to [0, 1], rounded to the
    /// nearest code. NaN becomes black.
    pub fn srgb_codes(&self, exposure: f64) -> Vec<[u8; 3]> {
        Bits::UNKNOWN.of_png(exposure).codes(self)
    }

    /// A PNG preview at `exposure` stops.
    pub fn to_png(&self, exposure: f64) -> Vec<u8> {
        Film::codes_to_png(&self.srgb_codes(exposure), self.width, self.height)
    }

    /// 8-bit sRGB codes as a PNG image.
    ///
    /// # Panics
    /// If there is not one code triple per pixel.
    pub fn codes_to_png(codes: &[[u8; 3]], width: usize, height: usize) -> Vec<u8> {
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

    /// Reads 8-bit sRGB codes from a PNG image: colour, grey or palette; 16-bit values become the
    /// nearest codes (v/257). Returns width, height and the codes.
    ///
    /// Transparent pixels, animations, and codes that are not sRGB (other primaries, another gamma or profile) are refused.
    pub fn codes_from_png(bytes: &[u8]) -> Result<(usize, usize, Vec<[u8; 3]>), FilmError> {
        decoder::run(|| read(bytes)).map_err(|stopped| FilmError::stopped("PNG", stopped))?
    }
}

fn read(bytes: &[u8]) -> Result<(usize, usize, Vec<[u8; 3]>), FilmError> {
    let limits = png::Limits {
        bytes: MOST_MEMORY as usize,
    };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    let header = decoder.read_header_info().map_err(damaged)?;
    check_size(header.width as usize, header.height as usize)?;
    // In 64 bits: `raw_bytes` overflows words of 32.
    let claimed = u64::from(header.height) * header.raw_row_length() as u64;
    check_claim(claimed, bytes.len())?;
    check_meaning(decoder.read_info().map_err(damaged)?.info())?;

    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MOST_MEMORY);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    check_claim(decoder.total_bytes(), bytes.len())?;
    let image = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    let image = image.into_rgba16();
    let mut pixels = image.pixels();
    if let Some(index) = pixels.position(|pixel| pixel.0[3] < u16::MAX) {
        let (column, row) = (index % width, index / width);
        return Err(FilmError::unsuited(
            format!("the pixel ({column}, {row}) is transparent"),
            "composite the image over the background of the scene in linear light, before it is \
             encoded as sRGB (codes that are mixed or premultiplied are other colours), or write \
             linear, premultiplied radiance as .exr",
        ));
    }
    // The nearest of 16 bits, and 8 as they were.
    let code = |wide: u16| ((u32::from(wide) + 128) / 257) as u8;
    let codes = image
        .pixels()
        .map(|pixel| [0, 1, 2].map(|c| code(pixel.0[c])));
    Ok((width, height, codes.collect()))
}

/// The error for a file that a crate refuses.
fn damaged(error: impl Display) -> FilmError {
    let reason = format!("it is broken ({error}): copy it or write it again");
    FilmError::unreadable("PNG", reason)
}

/// Fails if the file is not a single image of sRGB codes.
fn check_meaning(info: &png::Info) -> Result<(), FilmError> {
    if info.animation_control.is_some() {
        let what = "this PNG is animated";
        return Err(FilmError::unsuited(what, "write a single image"));
    }
    match other_codes(info) {
        Some(what) => Err(FilmError::unsuited(
            format!("the codes of this PNG are not sRGB: {what}"),
            "encode them as sRGB and state nothing else, or write linear radiance as .exr",
        )),
        None => Ok(()),
    }
}

/// The stated encoding, if it is not sRGB. The first present of four chunks counts; a file with none of them is
/// sRGB.
///
/// Source: PNG, third edition, 4.3 and 11.3.2.
fn other_codes(info: &png::Info) -> Option<String> {
    /// ITU-T H.273: primaries of BT.709, which are those of sRGB, and its curve.
    const SRGB: (u8, u8) = (1, 13);
    if let Some(points) = info.coding_independent_code_points {
        let found = (points.color_primaries, points.transfer_function);
        return (found != SRGB).then(|| format!("its cICP says {} and {}", found.0, found.1));
    }
    if let Some(profile) = &info.icc_profile {
        // By its texts, of 8 or 16 bits a letter.
        let letters = profile.iter().filter(|byte| byte.is_ascii_graphic());
        let text: String = letters.map(|&byte| char::from(byte)).collect();
        let is_srgb = text.contains("sRGB") && !text.to_ascii_lowercase().contains("linear");
        return (!is_srgb).then(|| "they have a colour profile of their own".to_owned());
    }
    if info.srgb.is_some() {
        return None;
    }
    if let Some(stated) = info.chrm_chunk {
        let points = [stated.red, stated.green, stated.blue, stated.white];
        let number = |scaled: png::ScaledFloat| f64::from(scaled.into_scaled()) / 1e5;
        if !are_rec709(&points.map(|(x, y)| [number(x), number(y)])) {
            return Some("its cHRM states other primaries".to_owned());
        }
    }
    let gamma = f64::from(info.gama_chunk?.into_scaled()) / 1e5;
    let is_srgb = (gamma - SRGB_GAMMA).abs() <= GAMMA_ROUNDING;
    (!is_srgb).then(|| format!("its gAMA says {gamma}"))
}

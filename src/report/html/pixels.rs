//! Images as text within a page, small enough for a whole suite in one file.
//!
//! A float keeps sign, exponent and eleven significant bits, and so does a difference: neither is
//! off by more than 2⁻¹¹ of itself, 0.05 %. Differences are stored beside the golden, and not the
//! test image, because that rounding would drown small ones. The numbers are split into planes of
//! bytes, deflated, and written in base 64; `page.js` undoes all this where a case is opened.

use crate::report::template::image_address;
use flate2::{Compression, write::ZlibEncoder};
use std::io::Write;

/// Bits of an `f32` that are dropped.
const DROPPED: u32 = 13;

/// Longest side of a thumbnail in a list.
pub(super) const THUMBNAIL: usize = 44;

/// Largest of the whole numbers that stand for fractions. In finer steps, which no eye sees, FLIP maps would fill an
/// eighth of a page of noisy images.
pub(super) const WHOLE: u8 = 63;

/// Numbers that change little from pixel to pixel, `width` pixels to a row: stored as steps along
/// the row.
pub(super) fn smooth_floats(pixels: &[[f32; 3]], width: usize) -> String {
    let mut before = 0;
    let codes = in_rows(pixels, width).map(|value| {
        let code = significant(value);
        // Modulo 2¹⁹, as many bits as are kept, and signed.
        let step = (code.wrapping_sub(before) << DROPPED) as i32 >> DROPPED;
        before = code;
        // Small steps of either sign to small numbers: 0, -1, 1, -2, … to 0, 1, 2, 3, …
        ((step << 1) ^ (step >> 31)) as u32
    });
    planes(&codes.collect::<Vec<_>>())
}

/// Numbers of either sign without order, `width` pixels to a row.
pub(super) fn floats(pixels: &[[f32; 3]], width: usize) -> String {
    planes(&in_rows(pixels, width).map(significant).collect::<Vec<_>>())
}

/// Bytes, `width` pixels to a row.
pub(super) fn codes(pixels: &[[u8; 3]], width: usize) -> String {
    deflated(&in_rows(pixels, width).collect::<Vec<_>>())
}

/// Numbers in [0, 1], as the nearest of [`WHOLE`] equal steps.
pub(super) fn fractions(values: &[f64]) -> String {
    let steps = |value: &f64| (value * f64::from(WHOLE)).round() as u8;
    deflated(&values.iter().map(steps).collect::<Vec<_>>())
}

/// The image made small, at most `side` long, as the address of a PNG image. `srgb` are its codes, row by row, `width`
/// to a row.
pub(in crate::report) fn thumbnail(srgb: &[[u8; 3]], width: usize, side: usize) -> String {
    let height = srgb.len() / width;
    let step = width.max(height).div_ceil(side);
    let (columns, rows) = (width.div_ceil(step), height.div_ceil(step));
    let mean = |column: usize, row: usize| {
        let mut sums = [0_usize; 3];
        let mut count = 0;
        for y in row * step..height.min((row + 1) * step) {
            for x in column * step..width.min((column + 1) * step) {
                for (sum, code) in sums.iter_mut().zip(srgb[y * width + x]) {
                    *sum += usize::from(code);
                }
                count += 1;
            }
        }
        sums.map(|sum| (sum / count) as u8)
    };
    let small: Vec<_> = (0..columns * rows)
        .map(|index| mean(index % columns, index / columns))
        .collect();
    image_address(&small, columns, rows)
}

/// Row by row, and each row channel by channel: where the channels are equal, as in grey images,
/// they are then near enough for the compressor to see it.
fn in_rows<T: Copy>(pixels: &[[T; 3]], width: usize) -> impl Iterator<Item = T> {
    pixels
        .chunks(width)
        .flat_map(|row| (0..3).flat_map(move |channel| row.iter().map(move |pixel| pixel[channel])))
}

/// The upper bits of the nearest `f32` of eleven significant bits, ties to even; infinities and
/// NaN are kept, and no finite number becomes infinite.
fn significant(value: f32) -> u32 {
    if value.is_nan() {
        return f32::NAN.to_bits() >> DROPPED;
    }
    let bits = value.to_bits();
    let nearest = (bits + 0xfff + ((bits >> DROPPED) & 1)) >> DROPPED;
    let overflows = value.is_finite() && f32::from_bits(nearest << DROPPED).is_infinite();
    if overflows { bits >> DROPPED } else { nearest }
}

/// All highest bytes, all middle ones, all lowest: bytes of one kind are alike.
fn planes(codes: &[u32]) -> String {
    let bytes: Vec<u8> = [16, 8, 0]
        .into_iter()
        .flat_map(|shift| codes.iter().map(move |code| (code >> shift) as u8))
        .collect();
    deflated(&bytes)
}

fn deflated(bytes: &[u8]) -> String {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    data_encoding::BASE64.encode(&written.expect("a vector takes every byte"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Film;
    use std::io::Read;

    fn inflated(text: &str) -> Vec<u8> {
        let bytes = data_encoding::BASE64.decode(text.as_bytes()).unwrap();
        let mut out = Vec::new();
        flate2::read::ZlibDecoder::new(&bytes[..])
            .read_to_end(&mut out)
            .unwrap();
        out
    }

    fn joined(text: &str) -> Vec<u32> {
        let bytes = inflated(text);
        let count = bytes.len() / 3;
        (0..count)
            .map(|i| {
                [0, 1, 2].iter().fold(0, |code, plane| {
                    code << 8 | u32::from(bytes[plane * count + i])
                })
            })
            .collect()
    }

    /// A few of every kind, with their neighbours.
    fn odd_numbers() -> Vec<f32> {
        let mut numbers = vec![
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN,
        ];
        for exponent in 0..255 {
            let power = f32::from_bits(exponent << 23);
            numbers.push(f32::from_bits(1 << (exponent % 23)));
            numbers.extend([
                power,
                -power,
                power * 1.234_567,
                -power * 1.999_999,
                0.0,
                -0.0,
            ]);
        }
        numbers
    }

    #[test]
    fn eleven_significant_bits_are_kept() {
        for value in odd_numbers() {
            let kept = f32::from_bits(significant(value) << DROPPED);
            if value.is_finite() {
                assert!(kept.is_finite());
                let smallest_normal = f64::from(f32::MIN_POSITIVE);
                let error = (f64::from(kept) - f64::from(value)).abs();
                // Half a step of 2⁻¹⁰; twice that at the largest number, which is not rounded up.
                let share = if value.abs() > 3.4e38 { 1.0 } else { 0.5 } / 1024.0;
                let limit = share * f64::from(value).abs().max(smallest_normal);
                assert!(error <= limit, "{value:e} became {kept:e}");
            } else {
                assert_eq!(kept.is_nan(), value.is_nan());
                assert_eq!(kept.is_sign_negative(), value.is_sign_negative());
            }
        }
    }

    #[test]
    fn steps_add_up_to_the_numbers() {
        let numbers = odd_numbers();
        let pixels: Vec<_> = numbers.windows(3).map(|w| [w[0], w[1], w[2]]).collect();
        let width = 7;
        let plain = joined(&floats(&pixels, width));
        let steps = joined(&smooth_floats(&pixels, width));
        let mut code = 0_u32;
        for (step, expected) in steps.into_iter().zip(&plain) {
            let step = if step & 1 == 0 {
                step >> 1
            } else {
                !(step >> 1)
            };
            code = code.wrapping_add(step) & ((1 << 19) - 1);
            assert_eq!(code, *expected);
        }
        assert_eq!(plain.len(), 3 * pixels.len());
        // The second of the first row's blues.
        assert_eq!(plain[2 * width + 1], significant(pixels[1][2]));
    }

    #[test]
    fn a_thumbnail_is_small_and_has_the_shape() {
        for (width, height, small) in [(256, 128, (43, 22)), (1, 1, (1, 1)), (1000, 1, (44, 1))] {
            let url = thumbnail(&vec![[200, 100, 0]; width * height], width, THUMBNAIL);
            let text = url.strip_prefix("data:image/png;base64,").unwrap();
            let png = data_encoding::BASE64.decode(text.as_bytes()).unwrap();
            let (columns, rows, codes) = Film::codes_from_png(&png).unwrap();
            assert_eq!((columns, rows), small);
            assert!(codes.iter().all(|code| *code == [200, 100, 0]));
        }
    }
}

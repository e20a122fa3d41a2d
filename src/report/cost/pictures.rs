//! Signed errors as images: one scale for all settings, from too dark to too bright.
//!
//! Errors of neighbouring settings differ by factors, so the scale is logarithmic on either side of
//! zero: [`DECADES`] decades below the largest error, and nothing is nearly white.

use super::words;
use crate::cost::results::ErrorPicture;
use crate::film::Film;
use crate::math::log10;
use serde::Serialize;

/// Errors that are smaller than the largest by more have the colour of none.
const DECADES: f64 = 4.0;

/// Columns of the image of the scale.
const SCALE: usize = 257;

/// Images of more pixels are left out: a browser could not open the page.
const MOST_PIXELS: usize = 1 << 22;

/// Pictures of one study, and their scale.
#[derive(Serialize)]
pub(super) struct ErrorMaps {
    pictures: Vec<Shown>,
    /// Address of an image of the scale.
    scale: String,
    /// What is written below it, at equal distances.
    ticks: Vec<String>,
    largest: String,
    notes: Vec<String>,
}

#[derive(Serialize)]
struct Shown {
    setting: String,
    /// Address of the image.
    image: String,
    columns: usize,
    rows: usize,
    root_mean_square: String,
    largest: String,
    mean: String,
}

/// The pictures; none where there are none that can be shown.
pub(super) fn pictures(pictures: &[ErrorPicture]) -> Option<ErrorMaps> {
    let mut notes = Vec::new();
    let (shown, left_out): (Vec<_>, Vec<_>) = pictures.iter().partition(|picture| {
        let pixels = picture.size[0] * picture.size[1];
        pixels > 0 && pixels <= MOST_PIXELS && pixels == picture.errors.len()
    });
    if !left_out.is_empty() {
        let settings: Vec<_> = left_out.iter().map(|p| p.setting.as_str()).collect();
        notes.push(format!("Too large to be shown: {}.", settings.join(", ")));
    }
    if shown.is_empty() {
        return None;
    }
    let finite = |picture: &ErrorPicture| -> Vec<f64> {
        let errors = picture.errors.iter().copied();
        errors.filter(|error| error.is_finite()).collect()
    };
    let largest_of = |errors: &[f64]| errors.iter().map(|error| error.abs()).fold(0.0, f64::max);
    let largest = shown
        .iter()
        .map(|picture| largest_of(&finite(picture)))
        .fold(0.0, f64::max);
    let odd = shown.iter().flat_map(|picture| &picture.errors);
    let odd = odd.filter(|error| !error.is_finite()).count();
    if odd > 0 {
        notes.push(format!(
            "Black: {odd} pixels whose error is no finite number."
        ));
    }
    let views = shown.iter().map(|picture| {
        let errors = finite(picture);
        let count = errors.len().max(1) as f64;
        let squares: f64 = errors.iter().map(|error| error * error).sum();
        let codes: Vec<_> = picture
            .errors
            .iter()
            .map(|error| colour(*error, largest))
            .collect();
        let [columns, rows] = picture.size;
        Shown {
            setting: picture.setting.clone(),
            image: address(&codes, columns, rows),
            columns,
            rows,
            root_mean_square: words::error((squares / count).sqrt()),
            largest: words::error(largest_of(&errors)),
            mean: words::error(errors.iter().sum::<f64>() / count),
        }
    });
    let views = views.collect();
    let scale: Vec<_> = (0..SCALE)
        .map(|at| code(2.0 * at as f64 / (SCALE - 1) as f64 - 1.0))
        .collect();
    let tick = |share: f64| words::error(largest * share);
    Some(ErrorMaps {
        pictures: views,
        scale: address(&scale, SCALE, 1),
        ticks: vec![
            format!("−{}", tick(1.0)),
            format!("−{}", tick(1e-2)),
            format!("within ±{}", tick(1e-4)),
            format!("+{}", tick(1e-2)),
            format!("+{}", tick(1.0)),
        ],
        largest: words::error(largest),
        notes,
    })
}

fn address(codes: &[[u8; 3]], columns: usize, rows: usize) -> String {
    let png = Film::codes_to_png(codes, columns, rows);
    format!(
        "data:image/png;base64,{}",
        data_encoding::BASE64.encode(&png)
    )
}

/// The colour of an error: black if it is no finite number.
fn colour(error: f64, largest: f64) -> [u8; 3] {
    if !error.is_finite() {
        return [0; 3];
    }
    code(shade(error, largest))
}

/// Where an error is on the scale from −1 to 1.
fn shade(error: f64, largest: f64) -> f64 {
    if error == 0.0 || largest == 0.0 {
        return 0.0;
    }
    let decades = log10(error.abs() / largest);
    (1.0 + decades / DECADES).clamp(0.0, 1.0) * error.signum()
}

/// The colour at a place on the scale: blue is too dark, red too bright.
fn code(shade: f64) -> [u8; 3] {
    colorous::RED_BLUE
        .eval_continuous(0.5 - 0.5 * shade)
        .into_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_signed_and_logarithmic() {
        assert_eq!(shade(1.0, 1.0), 1.0);
        assert_eq!(shade(-1e-2, 1.0), -0.5);
        assert_eq!(shade(1e-9, 1.0), 0.0);
        assert_eq!(shade(0.0, 0.0), 0.0);
        let [red, _, blue] = colour(1.0, 1.0);
        assert!(red > blue);
        let [red, _, blue] = colour(-1.0, 1.0);
        assert!(red < blue);
        assert_eq!(colour(f64::NAN, 1.0), [0; 3]);
    }

    #[test]
    fn only_what_has_pixels_is_shown() {
        let picture = |size: [usize; 2], count: usize| ErrorPicture {
            setting: "s".to_owned(),
            size,
            errors: vec![0.0; count],
        };
        assert!(pictures(&[]).is_none());
        assert!(pictures(&[picture([2, 2], 3)]).is_none());
        let shown = pictures(&[picture([2, 2], 4), picture([0, 0], 0)]).unwrap();
        assert_eq!((shown.pictures.len(), shown.notes.len()), (1, 1));
    }
}

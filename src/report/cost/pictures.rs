//! Signed errors as images: one scale for all settings, from too dark to too bright.
//!
//! Errors of neighbouring settings differ by factors, so the scale is logarithmic on either side of
//! zero: [`DECADES`] decades below the largest error, and nothing is nearly white.

use super::words;
use crate::cost::results::ErrorPicture;
use crate::math::log10;
use crate::report::template::{blue_to_red, image_address};
use minijinja::{Value, context};

/// Errors that are smaller than the largest by more have the colour of none.
const DECADES: f64 = 4.0;

/// Columns of the image of the scale.
const SCALE: usize = 257;

/// Images of more pixels are left out: a browser could not open the page.
const MOST_PIXELS: usize = 1 << 22;

/// The pictures of a study and their scale, for the template; none where none can be shown.
pub(super) fn pictures(pictures: &[ErrorPicture]) -> Option<Value> {
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
    let all = || shown.iter().flat_map(|picture| &picture.errors).copied();
    let largest = largest_of(all());
    let odd = all().filter(|error| !error.is_finite()).count();
    if odd > 0 {
        notes.push(format!(
            "Black: {odd} pixels whose error is not a finite number."
        ));
    }
    let pictures = shown.iter().map(|picture| {
        let finite = || {
            picture
                .errors
                .iter()
                .copied()
                .filter(|error| error.is_finite())
        };
        let count = finite().count().max(1) as f64;
        let squares: f64 = finite().map(|error| error * error).sum();
        let errors = picture.errors.iter();
        let codes: Vec<_> = errors.map(|error| colour(*error, largest)).collect();
        let [columns, rows] = picture.size;
        context! {
            setting => picture.setting,
            image => image_address(&codes, columns, rows),
            columns,
            rows,
            root_mean_square => words::error((squares / count).sqrt()),
            largest => words::error(largest_of(finite())),
            mean => words::error(finite().sum::<f64>() / count),
        }
    });
    let pictures: Vec<Value> = pictures.collect();
    let scale: Vec<_> = (0..SCALE)
        .map(|at| blue_to_red(2.0 * at as f64 / (SCALE - 1) as f64 - 1.0))
        .collect();
    let tick = |share: f64| words::error(largest * share);
    Some(context! {
        pictures,
        scale => image_address(&scale, SCALE, 1),
        // Written below it, at equal distances.
        ticks => [
            format!("−{}", tick(1.0)),
            format!("−{}", tick(1e-2)),
            format!("within ±{}", tick(1e-4)),
            format!("+{}", tick(1e-2)),
            format!("+{}", tick(1.0)),
        ],
        largest => words::error(largest),
        notes,
    })
}

/// The largest size of the errors that are finite.
fn largest_of(errors: impl Iterator<Item = f64>) -> f64 {
    let sizes = errors.filter(|error| error.is_finite()).map(f64::abs);
    sizes.fold(0.0, f64::max)
}

/// The colour of an error: black if it is not a finite number.
fn colour(error: f64, largest: f64) -> [u8; 3] {
    if !error.is_finite() {
        return [0; 3];
    }
    blue_to_red(shade(error, largest))
}

/// Position of an error on the scale from −1 to 1.
fn shade(error: f64, largest: f64) -> f64 {
    if error == 0.0 || largest == 0.0 {
        return 0.0;
    }
    let decades = log10(error.abs() / largest);
    (1.0 + decades / DECADES).clamp(0.0, 1.0) * error.signum()
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
        let len = |key: &str| shown.get_attr(key).unwrap().len();
        assert_eq!((len("pictures"), len("notes")), (Some(1), Some(1)));
    }
}

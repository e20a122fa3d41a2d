//! Reasons why no gate can compare two images: different sizes, pixels that are not finite.
//!
//! Checked first, because `error > limit` is false for NaN.

use super::gate::{Gate, Metric};
use super::judgement::Judgement;
use super::picture::Picture;
use crate::film::Film;

/// The metric of images that are not finite.
pub(crate) const NON_FINITE: Metric = (
    "non_finite_pixels",
    "Pixels with NaN or infinity; none are allowed.",
);

/// A failed judgement where two images cannot be compared.
pub(super) fn pictures(gate: Gate, reference: &Picture, test: &Picture) -> Option<Judgement> {
    let sizes = size_differs(gate, reference.size(), test.size());
    sizes.or_else(|| {
        let [reference, test] = [reference, test].map(Picture::radiance);
        let broken = reference.and_then(|film| not_finite(gate, REFERENCE, film));
        broken.or_else(|| test.and_then(|film| not_finite(gate, TEST, film)))
    })
}

/// [`pictures`], of images that are radiance; a variance must be one, too.
pub(super) fn films(gate: Gate, reference: &Film, test: &Film) -> Option<Judgement> {
    let [size, test_size] = [reference, test].map(|film| (film.width(), film.height()));
    size_differs(gate, size, test_size)
        .or_else(|| not_finite(gate, REFERENCE, reference))
        .or_else(|| not_finite(gate, TEST, test))
        .or_else(|| no_variance(gate, REFERENCE, reference))
        .or_else(|| no_variance(gate, TEST, test))
}

/// The names of the two images in a reason.
pub(super) const REFERENCE: &str = "reference";
pub(super) const TEST: &str = "test image";

fn size_differs(
    gate: Gate,
    (width, height): (usize, usize),
    (test_width, test_height): (usize, usize),
) -> Option<Judgement> {
    if (width, height) == (test_width, test_height) {
        return None;
    }
    // A list of pixels is read as a grey image.
    let shape = if matches!(test_width, 3 | 4) && test_width != width {
        " (a NumPy array of pixels needs the shape (height, width, 3))"
    } else {
        ""
    };
    let reason = format!(
        "size differs: the reference has {width} × {height} pixels, \
         the test image {test_width} × {test_height}; render it at {width} × {height}{shape}"
    );
    Some(Judgement::new(gate, false, reason, &[]))
}

/// Pixels that are named, at most.
const MOST_NAMED: usize = 8;

fn not_finite(gate: Gate, name: &str, film: &Film) -> Option<Judgement> {
    let (width, height) = (film.width(), film.height());
    let broken = |&index: &usize| film.pixel(index).iter().any(|value| !value.is_finite());
    let broken: Vec<usize> = (0..width * height).filter(broken).collect();
    let &first = broken.first()?;
    let pixel = |&index: &usize| format!("({}, {})", index % width, index / width);
    let named: Vec<String> = broken.iter().take(MOST_NAMED).map(pixel).collect();
    let reason = format!(
        "{} of {} pixels of the {name} are not finite: {}; the first has red, green, blue, opacity {:?}; look for a \
         division by 0, a vector of length 0 that is normalised, or a value beyond the range of the file: half floats \
         end at 65504",
        broken.len(),
        width * height,
        named.join(", "),
        film.pixel(first),
    );
    let metrics = [(NON_FINITE.0, broken.len() as f64)];
    Some(Judgement::new(gate, false, reason, &metrics))
}

fn no_variance(gate: Gate, name: &str, film: &Film) -> Option<Judgement> {
    let noise = film.noise()?;
    let first = noise.first_without_variance()?;
    let reason = format!(
        "a variance of the {name} is negative or not finite; the first is ({}, {}) with red, green, \
         blue {:?}",
        first % film.width(),
        first / film.width(),
        noise.variance()[first]
    );
    Some(Judgement::new(gate, false, reason, &[]))
}

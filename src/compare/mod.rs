//! Two images to a judgement.
//!
//! First what makes images incomparable: another size, pixels that are no numbers. Then a gate:
//! [exact](Gate::Exact), [deterministic](Gate::Deterministic), [perceptual](Gate::Perceptual) or
//! [stochastic](Gate::Stochastic), each in its own file with its limits and their reasons.

pub mod deterministic;
mod exact;
pub mod flip;
pub mod perceptual;
mod picture;
pub mod significance;
pub mod stochastic;

pub use picture::{Picture, PictureError};

use crate::film::Film;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// The rule by which two images are judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Gate {
    /// Every bit of every pixel.
    Exact,
    /// Linear radiance within a tolerance, for renderings without noise.
    Deterministic,
    /// 8-bit images that look the same.
    Perceptual,
    /// Means of random samples, by the noise they state.
    Stochastic,
    /// A known answer and a bound. Not for pairs of images.
    Analytic,
}

impl Gate {
    /// The gates that a pair of images can be judged by.
    pub const ALL: [Gate; 4] = [
        Gate::Exact,
        Gate::Deterministic,
        Gate::Perceptual,
        Gate::Stochastic,
    ];
}

impl fmt::Display for Gate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Gate::Exact => "exact",
            Gate::Deterministic => "deterministic",
            Gate::Perceptual => "perceptual",
            Gate::Stochastic => "stochastic",
            Gate::Analytic => "analytic",
        })
    }
}

impl std::str::FromStr for Gate {
    type Err = String;

    fn from_str(name: &str) -> Result<Gate, String> {
        Gate::ALL
            .into_iter()
            .find(|gate| gate.to_string() == name)
            .ok_or_else(|| {
                let names = Gate::ALL.map(|gate| gate.to_string()).join(", ");
                format!("unknown gate {name:?}; the gates are: {names}")
            })
    }
}

/// What a comparison found.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Whether the images agree under the gate.
    pub passed: bool,
    /// The rule applied.
    pub gate: Gate,
    /// Numbers by name, all finite.
    pub metrics: BTreeMap<String, f64>,
    /// The deciding number in words.
    pub reason: String,
    /// Under the stochastic gate: the bias of a block that would have been seen, relative to the
    /// mean of the block plus [`stochastic::DARK`]. A pass says nothing about smaller ones.
    pub resolution: Option<f64>,
    /// Under the stochastic gate: the bias of the mean of the image that would have been seen,
    /// relative to that mean plus [`stochastic::DARK`].
    pub mean_resolution: Option<f64>,
    /// Under the stochastic gate, of a pass that could not have seen the bias that was
    /// [promised](stochastic::judge_case): the verdict is *inconclusive*, and this would decide.
    pub undecided: Option<stochastic::Undecided>,
}

impl Judgement {
    fn new(gate: Gate, passed: bool, reason: String, metrics: &[(&str, f64)]) -> Judgement {
        let metrics = metrics
            .iter()
            .map(|&(name, value)| (name.to_owned(), value))
            .collect();
        Judgement {
            passed,
            gate,
            metrics,
            reason,
            resolution: None,
            mean_resolution: None,
            undecided: None,
        }
    }
}

/// Judges `test` by `reference`. 8-bit images are only ever judged by the perceptual gate, at
/// `exposure` stops for the side that is radiance; other gates refuse them.
pub fn judge(
    gate: Gate,
    reference: &Picture,
    test: &Picture,
    exposure: f64,
) -> Result<Judgement, PictureError> {
    if let Some(difference) = incomparable(gate, reference, test) {
        return Ok(difference);
    }
    match (gate, reference, test) {
        (Gate::Perceptual, _, _) => Ok(perceptual::judge(
            &reference.srgb(exposure)?,
            &test.srgb(exposure)?,
        )),
        (Gate::Exact, Picture::Radiance(reference), Picture::Radiance(test)) => {
            Ok(exact::judge(reference, test))
        }
        (Gate::Deterministic, Picture::Radiance(reference), Picture::Radiance(test)) => {
            Ok(deterministic::judge(reference, test))
        }
        (Gate::Stochastic, Picture::Radiance(reference), Picture::Radiance(test)) => {
            stochastic::judge(reference, test, 1)
        }
        _ => Err(PictureError::NeedsRadiance(gate)),
    }
}

/// [`incomparable`], of images that are radiance; a variance must be one, too.
fn incomparable_films(gate: Gate, reference: &Film, test: &Film) -> Option<Judgement> {
    let [a, b] = [reference, test].map(|film| Picture::Radiance(film.clone()));
    if let Some(difference) = incomparable(gate, &a, &b) {
        return Some(difference);
    }
    for (name, film) in [("reference", reference), ("test image", test)] {
        if let Some(noise) = film.noise()
            && let Some(first) = noise.first_without_variance()
        {
            let reason = format!(
                "a variance of the {name} is negative or not finite; the first is ({}, {}) with \
                 red, green, blue {:?}",
                first % film.width(),
                first / film.width(),
                noise.variance()[first]
            );
            return Some(Judgement::new(gate, false, reason, &[]));
        }
    }
    None
}

/// Pixels that are named where something is wrong with single ones.
const MOST_PLACES: usize = 8;

/// A failed judgement where no gate can be applied: sizes differ, or a pixel is no number.
/// Looked for first, because `error > limit` is false for NaN.
fn incomparable(gate: Gate, reference: &Picture, test: &Picture) -> Option<Judgement> {
    let (width, height) = reference.size();
    let (test_width, test_height) = test.size();
    if (width, height) != (test_width, test_height) {
        let reason = format!(
            "size differs: the reference has {width} × {height} pixels, \
             the test image {test_width} × {test_height}"
        );
        return Some(Judgement::new(gate, false, reason, &[]));
    }
    for (name, picture) in [("reference", reference), ("test image", test)] {
        let Picture::Radiance(film) = picture else {
            continue;
        };
        let broken = |&index: &usize| film.pixel(index).iter().any(|value| !value.is_finite());
        let broken: Vec<usize> = (0..width * height).filter(broken).collect();
        if let Some(&first) = broken.first() {
            let place = |&index: &usize| format!("({}, {})", index % width, index / width);
            let mut places: Vec<String> = broken.iter().take(MOST_PLACES).map(place).collect();
            if broken.len() > MOST_PLACES {
                places.push("…".to_owned());
            }
            let reason = format!(
                "{} of {} pixels of the {name} are not finite: {}; the first has red, green, blue, \
                 opacity {:?}",
                broken.len(),
                width * height,
                places.join(", "),
                film.pixel(first)
            );
            return Some(Judgement::new(
                gate,
                false,
                reason,
                &[("non_finite_pixels", broken.len() as f64)],
            ));
        }
    }
    None
}

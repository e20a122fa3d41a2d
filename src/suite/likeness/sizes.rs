//! Sizes that may be off: numbers of the scene, fitted to an image that no mistake explains.
//!
//! A mistake of the catalogue is one edit; a volume that is a tenth too dense is none. Of the few
//! numbers that are easily off by a factor, that factor is found which brings the prediction nearest
//! to the image, by Gauss and Newton's method with secants in place of derivatives. It is said if it
//! leaves little of the difference: a measurement, not a name.

use super::clock::SearchClock;
use super::compared_case::ComparedCase;
use crate::math;
use crate::scene::{Model, Panel, Scene};

/// The share of the squared difference that a factor may leave unexplained, if it is said: a third
/// of the difference, root mean square. The sentence states what it leaves.
const LEFT: f64 = 0.1;

/// The shares beyond which the first steps are given up: a size that is the one leaves less after
/// one, one that is not about as much as there was.
const HOPEFUL: [f64; 2] = [0.8, 0.5];

/// Renderings for each size beside that without a change.
const STEPS: usize = 8;

/// A step that is smaller than this part of the first one ends the search: what is said has no more
/// digits.
const CLOSE: f64 = 0.002;

/// A number of the scene.
struct Size {
    /// In keys of predictions.
    name: &'static str,
    /// Edits a panel; whether it has such a number. Nothing changes at 0.
    edit: fn(&mut Panel, f64) -> bool,
    /// The first change that is tried: small beside what changes the image altogether, large beside
    /// the noise of a prediction.
    first: f64,
    /// The largest change that is looked for.
    most: f64,
    words: fn(&Scene, f64) -> String,
}

/// Factors are natural logarithms: up to 4, and its inverse.
const FARTHEST: f64 = 2.0 * std::f64::consts::LN_2;

/// Factors on the step that are tried: fractions of small numbers, and what another unit makes. Others
/// cannot be approached: samples lie elsewhere at each, so that no step is near another.
const STEP_FACTORS: [f64; 14] = [
    0.1,
    0.2,
    1.0 / 3.0,
    0.4,
    2.0 / 3.0,
    0.75,
    0.8,
    1.25,
    4.0 / 3.0,
    1.5,
    2.5,
    3.0,
    5.0,
    10.0,
];

const SIZES: [Size; 4] = [
    Size {
        name: "density",
        edit: |panel, logarithm| denser(&mut panel.model, math::exp(logarithm)),
        first: 0.2,
        most: FARTHEST,
        words: |_, logarithm| format!("a density {:.3} times as large", math::exp(logarithm)),
    },
    Size {
        name: "field of view",
        edit: |panel, logarithm| {
            panel.edit_view(|camera, _| {
                if camera.is_orthographic() {
                    camera.with_image_scaled(math::exp(logarithm))
                } else {
                    camera.with_vertical_fov(angle(camera.vertical_fov(), logarithm))
                }
            })
        },
        first: 0.01,
        most: 0.5,
        words: |scene, logarithm| {
            let camera = scene.panels.iter().find_map(|panel| panel.model.camera());
            if let Some(height) = camera.and_then(|camera| camera.orthographic_height()) {
                let height = height * math::exp(logarithm);
                return format!("an orthographic height of {height:.4}");
            }
            let fov = camera.map_or(0.0, |camera| camera.vertical_fov());
            let angle = angle(fov, logarithm).to_degrees();
            format!("a field of view of {angle:.2} degrees")
        },
    },
    Size {
        name: "shift to the right",
        edit: |panel, pixels| {
            panel.edit_view(|camera, pixel| camera.with_image_moved([pixels * pixel, 0.0]))
        },
        first: 0.25,
        most: 4.0,
        words: |_, pixels| moved(pixels, ["right", "left"]),
    },
    Size {
        name: "shift down",
        edit: |panel, pixels| {
            panel.edit_view(|camera, pixel| camera.with_image_moved([0.0, pixels * pixel]))
        },
        first: 0.25,
        most: 4.0,
        words: |_, pixels| moved(pixels, ["down", "up"]),
    },
];

fn moved(pixels: f64, sides: [&str; 2]) -> String {
    let side = sides[usize::from(pixels < 0.0)];
    format!(
        "an image that lies {:.2} pixels further {side}",
        pixels.abs()
    )
}

/// The angle whose image plane is larger by a factor of this logarithm.
fn angle(angle: f64, logarithm: f64) -> f64 {
    2.0 * math::atan2(math::exp(logarithm) * math::tan(0.5 * angle), 1.0)
}

fn denser(model: &mut Model, factor: f64) -> bool {
    match model {
        Model::Classified(scene) => {
            scene.transfer_function.reference_length /= factor;
            true
        }
        Model::Radiative(scene) => {
            for body in &mut scene.media {
                // What leaves the range of numbers stays as it is.
                let _ = body.make_denser(factor);
            }
            !scene.media.is_empty()
        }
        Model::Curve(_) => false,
    }
}

impl ComparedCase {
    /// Sentences on the sizes that would explain the image, and whether one explains it as well as a
    /// mistake would have to.
    pub fn fitted_sizes(&self, clock: &SearchClock<'_>) -> (Vec<String>, bool) {
        let (mut sentences, mut is_explained) = (Vec::new(), false);
        let fitted = SIZES.iter().filter_map(|size| {
            let (change, left, is_all) = self.fitted(size, clock)?;
            Some(((size.words)(self.scene(), change), left, is_all))
        });
        for (would, left, is_all) in fitted.chain(self.fitted_step(clock)) {
            let left = match 100.0 * left {
                percent if percent < 0.1 => "less than 0.1 %".to_owned(),
                percent => format!("{percent:.1} %"),
            };
            sentences.push(format!(
                "{would} would explain all but {left} of the squared difference"
            ));
            is_explained |= is_all;
        }
        (sentences, is_explained)
    }

    /// Of the [factors](STEP_FACTORS) on the step that which is nearest to the image, in words, and as
    /// in [`fitted`](ComparedCase::fitted).
    fn fitted_step(&self, clock: &SearchClock<'_>) -> Option<(String, f64, bool)> {
        let predicted = |factor: f64| {
            if clock.is_late() {
                return None;
            }
            let mut edited = self.scene().clone();
            let mut occurs = false;
            for panel in &mut edited.panels {
                if let Model::Classified(scene) = &mut panel.model
                    && !scene.is_continuous()
                {
                    scene.step *= factor;
                    occurs = true;
                }
            }
            let label = format!("step {factor}");
            occurs
                .then(|| self.predicted_with(&edited, &label, clock))
                .flatten()
        };
        let tried = STEP_FACTORS.into_iter().filter_map(|factor| {
            let predicted = predicted(factor)?;
            Some((factor, self.share_left(&predicted)?, predicted))
        });
        let (factor, left, nearest) = tried.min_by(|(_, a, _), (_, b, _)| a.total_cmp(b))?;
        let worth_saying = self.is_explained_but_for(&nearest, LEFT)?;
        let is_all = self.is_explained_but_for(&nearest, self.may_leave())?;
        worth_saying.then(|| {
            let words = format!("steps {factor:.2} times as long");
            (words, left.max(0.0), is_all)
        })
    }

    /// The change of `size` that is nearest to the image, the share that it leaves, and whether that
    /// is as little as a mistake may leave; nothing if it leaves more than is worth saying.
    fn fitted(&self, size: &Size, clock: &SearchClock<'_>) -> Option<(f64, f64, bool)> {
        let predicted = |change: f64| {
            if clock.is_late() {
                return None;
            }
            let mut edited = self.scene().clone();
            let mut occurs = false;
            for panel in &mut edited.panels {
                occurs |= (size.edit)(panel, change);
            }
            let label = format!("{} {change}", size.name);
            occurs
                .then(|| self.predicted_with(&edited, &label, clock))
                .flatten()
        };
        let (mut from, mut at) = (0.0, size.first);
        let (mut before, mut now) = (predicted(from)?, predicted(at)?);
        let mut best = None::<(f64, f64)>;
        for step_index in 0..STEPS {
            let [along, length] = self.along(&now, &before)?;
            // One step from `now`, in units of the last.
            let step = along / length * (at - from);
            if !step.is_finite() {
                return None;
            }
            let next = (at + step).clamp(-size.most, size.most);
            if (next - at).abs() < CLOSE * size.first {
                break;
            }
            (from, before) = (at, now);
            at = next;
            now = predicted(at)?;
            let left = self.share_left(&now)?;
            let hopeful = HOPEFUL.get(step_index).copied().unwrap_or(HOPEFUL[1]);
            if left > hopeful {
                return None;
            }
            if best.is_none_or(|(_, least)| left < least) {
                best = Some((at, left));
            } else {
                break;
            }
        }
        let (at, _) = best?;
        let nearest = predicted(at)?;
        let left = self.share_left(&nearest)?;
        let worth_saying = self.is_explained_but_for(&nearest, LEFT)?;
        let is_all = self.is_explained_but_for(&nearest, self.may_leave())?;
        worth_saying.then(|| (at, left.max(0.0), is_all))
    }
}

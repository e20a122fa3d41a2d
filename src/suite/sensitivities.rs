//! Sensitivities stored with goldens: derivatives of blocks by all numbers of a scene.
//!
//! `golden/sensitivities/FAMILY/CASE.exr` has a layer for each number, of blocks of 8 × 8 pixels or, of a
//! number that shows in smaller details, of pixels. What a layer was computed from stands in the comment of
//! the file, and its hash in the record of the golden.

use super::golden::{input_hashes, scene_hash};
use super::name_hash;
use crate::compare::Sensitivity;
use crate::compare::stochastic::BLOCK;
use crate::film::{Film, LayeredFilm};
use crate::render::{Detail, Plan, plans};
use crate::scene::Scene;
use crate::sensitivity::{Dependence, Differences, derivative, numbers};

/// Share of a step by which a number is changed to test if it can change.
const SLIGHT: f64 = 1e-3;

/// Samples for a derivative of pixels over those for one of blocks.
const TIMES_FOR_FINE: u32 = 16;

/// Radius in pixels of the neighbourhood that decides if the derivative of a pixel is more than
/// noise.
const AROUND: usize = 2;

/// Smallest mean of squares over variances in that neighbourhood: half of the squares is then more
/// than noise.
const KNOWN: f64 = 2.0;

/// The derivatives of blocks of `scene` by its numbers, from `spp` samples a pixel on each side, in
/// `pairs` pairs of renderings. A fine parameter has derivatives of pixels, from 16 times as many samples.
/// Numbers that change nothing are left out.
///
/// # Errors
///
/// If the scene cannot be rendered in blocks, or not at all; the reason in words.
pub(crate) fn sensitivities_of(
    scene: &Scene,
    spp: u32,
    pairs: u32,
    seed: u64,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Result<LayeredFilm, String> {
    if !plans(scene).iter().all(Plan::is_sampled) {
        return Err(
            "this scene is rendered without random numbers: no image of it has noise that \
                    derivatives of blocks could be weighed by; ask for one parameter with --of"
                .to_owned(),
        );
    }
    let mut layers = Vec::new();
    for number in &numbers(scene) {
        let (detail, samples) = if number.is_fine {
            (Detail::Whole, spp.saturating_mul(TIMES_FOR_FINE))
        } else {
            let pixels = (BLOCK * BLOCK) as u32;
            (Detail::Blocks(BLOCK), spp.saturating_mul(pixels))
        };
        let differences = Differences {
            detail,
            samples,
            pairs,
            // None in common with another number, whatever numbers there are: errors are independent.
            seed: seed.wrapping_add(name_hash(&number.name())),
            step: None,
        };
        let found = derivative(scene, number, &differences, stopped);
        let found = found.map_err(|error| error.to_string())?;
        let changes = |film: &Film| film.radiance().as_flattened().iter().any(|&d| d != 0.0);
        if let Some(found) = found.filter(|found| changes(&found.film)) {
            let film = if number.is_fine {
                where_known(&found.film)
            } else {
                found.film
            };
            layers.push((number.name(), film));
        }
    }
    Ok(LayeredFilm {
        comment: origin(scene),
        layers,
    })
}

/// `derivative` where it is more than noise, and 0 elsewhere: most of a derivative of pixels would add
/// its noise to a sum and nothing else. The pixels around each pixel decide, so that its own noise has no part in
/// it.
fn where_known(derivative: &Film) -> Film {
    let (width, height) = (derivative.width(), derivative.height());
    let Some(noise) = derivative.noise() else {
        return derivative.clone();
    };
    let square = |at: usize| -> [f64; 2] {
        let sum = |values: [f32; 3]| values.map(f64::from).iter().sum();
        [
            sum(derivative.radiance()[at].map(|d| d * d)),
            sum(noise.variance()[at]),
        ]
    };
    let is_known = |at: usize| {
        let (x, y) = (at % width, at / width);
        let rows = y.saturating_sub(AROUND)..(y + AROUND + 1).min(height);
        let columns = x.saturating_sub(AROUND)..(x + AROUND + 1).min(width);
        let around = rows.flat_map(|row| columns.clone().map(move |column| row * width + column));
        let squares = around.filter(|&other| other != at).map(square);
        let [squares, noise] = squares.fold([0.0; 2], |sum, it| [sum[0] + it[0], sum[1] + it[1]]);
        squares > KNOWN * noise
    };
    let pixels = (0..width * height).map(|at| {
        let is_known = is_known(at);
        let only = |of: [f32; 3]| if is_known { of } else { [0.0; 3] };
        (only(derivative.radiance()[at]), only(noise.variance()[at]))
    });
    let (means, variances) = pixels.unzip();
    Film::with_noise(width, height, means, variances, noise.samples())
}

/// Origin of derivatives, as the comment of their file.
fn origin(scene: &Scene) -> String {
    let inputs = format!("{:?}", input_hashes(scene));
    let inputs = blake3::hash(inputs.as_bytes()).to_hex();
    format!("scene {} files {inputs}", scene_hash(scene))
}

/// The sensitivities in the `bytes` of a file.
///
/// # Errors
///
/// If it cannot be read, or is not of `scene`; as the end of a sentence.
pub(crate) fn decoded(bytes: &[u8], scene: &Scene) -> Result<Vec<Sensitivity>, String> {
    let layered =
        LayeredFilm::from_exr(bytes).map_err(|error| format!("cannot be read: {error}"))?;
    if layered.comment != origin(scene) {
        return Err("was made from another scene, or from other files".to_owned());
    }
    let mut layers = layered.layers;
    let kept = numbers(scene).into_iter().filter_map(|number| {
        let name = number.name();
        let at = layers.iter().position(|(of, _)| *of == name)?;
        let (_, derivative) = layers.swap_remove(at);
        Some(Sensitivity {
            name,
            words: number.words(),
            unit: number.quantity.unit.name().map(str::to_owned),
            step: match number.quantity.dependence {
                Dependence::Linear => f64::INFINITY,
                Dependence::Smooth => number.step,
            },
            can_be: [-1.0, 1.0]
                .map(|sign| number.changed(scene, sign * SLIGHT * number.step).is_some()),
            derivative,
        })
    });
    Ok(kept.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::stochastic::FINE_BLOCK;
    use crate::math::rng::{Purpose, Stream};
    use crate::suite::Suite;
    use crate::suite::golden::Golden;
    use crate::suite::golden::SENSITIVITIES;
    use std::path::Path;

    /// Kept derivatives belong to the scenes as they are, and to some case.
    #[test]
    fn kept_sensitivities_are_of_their_scenes() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let suite = Suite::open(root).unwrap();
        let store = suite.store();
        let mut files = 0;
        for folder in std::fs::read_dir(root.join("golden").join(SENSITIVITIES)).unwrap() {
            files += std::fs::read_dir(folder.unwrap().path()).unwrap().count();
        }
        let mut used = 0;
        for case in suite.cases().iter().filter(|case| case.sampling.is_some()) {
            let Some(bytes) = Golden::read(&store, case).unwrap().sensitivities else {
                continue;
            };
            used += 1;
            let scene = case.load_scene().unwrap();
            let kept = decoded(&bytes, &scene).unwrap();
            let name = &case.name;
            assert!(!kept.is_empty(), "{name}");
            for sensitivity in &kept {
                let edge = match &*sensitivity.name {
                    "index" => FINE_BLOCK,
                    _ => BLOCK,
                };
                let blocks = (scene.panels[0].width / edge) * (scene.panels[0].height / edge);
                assert_eq!(sensitivity.derivative.radiance().len(), blocks, "{name}");
            }
        }
        assert_eq!(used, files, "a file of no case");
        assert!(used >= 20, "{used}");
    }

    /// A disc of derivatives in noise: the noise is gone, the disc is not, and no pixel decides on itself.
    #[test]
    fn noise_of_fine_derivatives_is_left_out() {
        let (side, error) = (40, 0.1_f32);
        let is_in_disc = |at: usize, radius: f64| {
            let [x, y] = [at % side, at / side].map(|i| i as f64 - 20.0);
            x * x + y * y < radius * radius
        };
        let pixel = |at: usize| {
            let noise = Stream::new(7, at as u32, 0).uniform(0, Purpose::Camera, 0) - 0.5;
            let derivative = if is_in_disc(at, 8.0) { 1.0 } else { 0.0 };
            [derivative + noise as f32 * error * 12_f32.sqrt(); 3]
        };
        let mut pixels: Vec<[f32; 3]> = (0..side * side).map(pixel).collect();
        // One wild pixel far from the disc.
        pixels[3 * side + 3] = [50.0; 3];
        let variances = vec![[error * error; 3]; pixels.len()];
        let known = where_known(&Film::with_noise(side, side, pixels.clone(), variances, 16));
        let kept = |at: usize| known.radiance()[at] != [0.0; 3];
        for (at, pixel) in pixels.iter().enumerate() {
            if is_in_disc(at, 8.0) {
                assert_eq!(known.radiance()[at], *pixel);
            }
        }
        assert!(!kept(3 * side + 3));
        let far = (0..side * side).filter(|&at| !is_in_disc(at, 12.0));
        let (far, noise): (Vec<usize>, Vec<usize>) = far.partition(|&at| at < 8 * side);
        assert!(!far.is_empty());
        // 72 squares of noise: their mean is 2 once in millions.
        assert!(noise.into_iter().all(|at| !kept(at)));
    }
}

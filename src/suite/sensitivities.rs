//! Sensitivities that travel with goldens: derivatives of blocks by all numbers of a scene.
//!
//! `golden/sensitivities/FAMILY/CASE.exr` has a layer for each number. What a layer was computed from
//! stands in the comment of the file: a file of another scene is not used.

use super::golden::{input_hashes, scene_hash};
use super::{Case, Store};
use crate::compare::Sensitivity;
use crate::compare::stochastic::BLOCK;
use crate::film::{Film, LayeredFilm};
use crate::render::{Detail, Plan, plans};
use crate::scene::Scene;
use crate::sensitivity::{Dependence, Differences, Unit, derivative, numbers};
use std::path::PathBuf;

/// The part of a step by which a number is changed to see whether it can be.
const SLIGHT: f64 = 1e-3;

/// The cosine between two derivatives up to which an image tells their numbers apart: a third of each
/// is then across the other.
const TOLD_APART: f64 = 0.8;

/// Folder among the goldens.
pub(super) const FOLDER: &str = "sensitivities";

/// The derivatives of blocks of 8 × 8 pixels of `scene` by its numbers, from `spp` samples a pixel on
/// each side, in `pairs` pairs of renderings. Numbers that change nothing are left out.
///
/// # Errors
///
/// If the scene cannot be rendered in blocks, or not at all; the reason in words.
pub fn sensitivities_of(
    scene: &Scene,
    spp: u32,
    pairs: u32,
    seed: u64,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Result<LayeredFilm, String> {
    if !plans(scene).iter().all(Plan::is_sampled) {
        return Err(
            "this scene is rendered without random numbers: no image of it has noise that \
                    derivatives of blocks could be weighed by; ask for one number with --of"
                .to_owned(),
        );
    }
    let mut layers = Vec::new();
    for (at, number) in numbers(scene).iter().enumerate() {
        let differences = Differences {
            detail: Detail::Blocks(BLOCK),
            samples: spp.saturating_mul((BLOCK * BLOCK) as u32),
            pairs,
            // None in common with another number: their errors are independent.
            seed: seed.wrapping_add(at as u64 * u64::from(pairs)),
            step: None,
        };
        let found = derivative(scene, number, &differences, stopped);
        let found = found.map_err(|error| error.to_string())?;
        let changes = |film: &Film| film.radiance().as_flattened().iter().any(|&d| d != 0.0);
        if let Some(found) = found.filter(|found| changes(&found.film)) {
            layers.push((number.name(), found.film));
        }
    }
    Ok(LayeredFilm {
        comment: origin(scene),
        layers,
    })
}

/// Origin of derivatives, as the comment of their file.
fn origin(scene: &Scene) -> String {
    let inputs = format!("{:?}", input_hashes(scene));
    let inputs = blake3::hash(inputs.as_bytes()).to_hex();
    format!("scene {} files {inputs}", scene_hash(scene))
}

/// The sensitivities kept for `case`, whose scene is `scene`: none if there are none, or none of this
/// scene.
pub(super) fn kept(case: &Case, scene: &Scene, store: &Store) -> Vec<Sensitivity> {
    let path = PathBuf::from(FOLDER).join(format!("{}.exr", case.name));
    let Ok(Some(bytes)) = store.read(&path) else {
        return Vec::new();
    };
    let Ok(layered) = LayeredFilm::from_exr(&bytes) else {
        return Vec::new();
    };
    if layered.comment != origin(scene) {
        return Vec::new();
    }
    let mut layers = layered.layers;
    let kept = numbers(scene).into_iter().filter_map(|number| {
        let name = number.name();
        let at = layers.iter().position(|(of, _)| *of == name)?;
        let (_, derivative) = layers.swap_remove(at);
        Some(Sensitivity {
            name,
            words: number.words(),
            unit: match number.quantity.unit {
                Unit::Share => None,
                Unit::Absolute(unit) => Some(unit.to_owned()),
            },
            step: match number.dependence {
                Dependence::Linear => f64::INFINITY,
                Dependence::Smooth => number.step,
            },
            can_be: [-1.0, 1.0]
                .map(|sign| number.changed(scene, sign * SLIGHT * number.step).is_some()),
            derivative,
        })
    });
    kept.collect()
}

/// The case whose image tells the numbers called `names` apart best, if any does: where their
/// derivatives are least alike.
pub fn telling_case<'c>(cases: &'c [Case], store: &Store, names: [&str; 2]) -> Option<&'c Case> {
    let likeness = |case: &Case| {
        case.sampling?;
        let known = kept(case, &case.load_scene().ok()?, store);
        let [a, b] = names.map(|name| known.iter().find(|it| it.name == name));
        let [a, b] = [&a?.derivative, &b?.derivative];
        let shared = |a: &Film, b: &Film, is_same: bool| {
            let mut sum = 0.0;
            for (at, (of_a, of_b)) in a.radiance().iter().zip(b.radiance()).enumerate() {
                for c in 0..3 {
                    let noise = a
                        .noise()
                        .map_or(0.0, |noise| noise.variance()[at][c].into());
                    let noise = if is_same { noise } else { 0.0 };
                    sum += f64::from(of_a[c]) * f64::from(of_b[c]) - noise;
                }
            }
            sum
        };
        let [of_a, of_b] = [shared(a, a, true), shared(b, b, true)];
        let likeness = shared(a, b, false).abs() / (of_a * of_b).sqrt();
        (of_a > 0.0 && of_b > 0.0 && likeness <= TOLD_APART).then_some(likeness)
    };
    let likely = cases
        .iter()
        .filter_map(|case| Some((case, likeness(case)?)));
    let least = likely.min_by(|(_, a), (_, b)| a.total_cmp(b));
    least.map(|(case, _)| case)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::suite::Suite;
    use std::path::Path;

    /// Those that are kept belong to the scenes as they are, and to some case.
    #[test]
    fn kept_sensitivities_are_of_their_scenes() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let suite = Suite::open(root).unwrap();
        let store = suite.store();
        let mut files = 0;
        for folder in std::fs::read_dir(root.join("golden").join(FOLDER)).unwrap() {
            files += std::fs::read_dir(folder.unwrap().path()).unwrap().count();
        }
        let mut used = 0;
        for case in suite.cases().iter().filter(|case| case.sampling.is_some()) {
            let path = PathBuf::from(FOLDER).join(format!("{}.exr", case.name));
            if store.read(&path).unwrap().is_none() {
                continue;
            }
            used += 1;
            let scene = case.load_scene().unwrap();
            let kept = kept(case, &scene, &store);
            let name = &case.name;
            assert!(
                !kept.is_empty(),
                "{name}: of another scene; run scripts/regenerate-sensitivities.sh {name}"
            );
            for sensitivity in &kept {
                let blocks = (scene.panels[0].width / BLOCK) * (scene.panels[0].height / BLOCK);
                assert_eq!(sensitivity.derivative.radiance().len(), blocks, "{name}");
            }
        }
        assert_eq!(used, files, "a file of no case");
        assert!(used >= 20, "{used}");
    }

    /// Density changes what lies behind a medium, the lamp everything; a shifted image is an eye
    /// that moved in every case.
    #[test]
    fn a_case_tells_numbers_apart_or_none_does() {
        let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
        let store = suite.store();
        let telling = |names| telling_case(suite.cases(), &store, names);
        assert!(telling(["density", "lamp"]).is_some());
        assert!(telling(["camera.x", "camera.right"]).is_none());
        assert!(telling(["density", "no number"]).is_none());
    }
}

//! Sensitivities stored with goldens: derivatives of blocks by all numbers of a scene.
//!
//! `golden/sensitivities/FAMILY/CASE.exr` has a layer for each number, of blocks of 8 × 8 pixels. Layers of single
//! pixels, which older files have, are of no use. What a layer was computed from stands in the comment of
//! the file, and its hash in the record of the golden.

use super::golden::{hash, input_hashes, scene_hash};
use super::name_hash;
use crate::compare::Sensitivity;
use crate::compare::stochastic::BLOCK;
use crate::film::{Film, LayeredFilm};
use crate::render::{Detail, Plan, plans};
use crate::scene::Scene;
use crate::sensitivity::{Differences, derivative, numbers};

/// Share of a step by which a number is changed to test if it can change.
const SLIGHT: f64 = 1e-3;

/// The derivatives of blocks of `scene` by its numbers, from `spp` samples a pixel on each side, in
/// `pairs` pairs of renderings.
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
        let differences = Differences {
            detail: Detail::Blocks(BLOCK),
            samples: spp.saturating_mul((BLOCK * BLOCK) as u32),
            pairs,
            // None in common with another number, whatever numbers there are: errors are independent.
            seed: seed.wrapping_add(name_hash(&number.name())),
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
    let inputs = hash(inputs.as_bytes());
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
            unit: number.unit.map(str::to_owned),
            step: match number.is_linear {
                true => f64::INFINITY,
                false => number.step,
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
            let blocks = (scene.panels[0].width / BLOCK) * (scene.panels[0].height / BLOCK);
            for sensitivity in kept.iter().filter(|it| it.name != "index") {
                assert_eq!(sensitivity.derivative.radiance().len(), blocks, "{name}");
            }
        }
        assert_eq!(used, files, "a file of no case");
        assert!(used >= 20, "{used}");
    }
}

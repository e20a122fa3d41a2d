//! Sensitivities that travel with goldens: derivatives of blocks by all numbers of a scene.
//!
//! `golden/sensitivities/FAMILY/CASE.exr` has a layer for each number. What a layer was computed from
//! stands in the comment of the file: a file of another scene is not used.

use super::golden::{input_hashes, scene_hash};
use super::{Case, Store};
use crate::compare::Sensitivity;
use crate::compare::stochastic::BLOCK;
use crate::film::LayeredFilm;
use crate::render::{Detail, Plan, plans};
use crate::scene::Scene;
use crate::sensitivity::{Differences, Unit, derivative, numbers};
use std::path::PathBuf;

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
        let changes =
            |film: &crate::film::Film| film.radiance().as_flattened().iter().any(|&d| d != 0.0);
        if let Some(found) = found.filter(|found| changes(&found.film)) {
            layers.push((number.name(), found.film));
        }
    }
    Ok(LayeredFilm {
        comment: origin(scene),
        layers,
    })
}

/// What derivatives depend on, as the comment of their file.
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
            derivative,
        })
    });
    kept.collect()
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
}

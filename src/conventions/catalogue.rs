//! Conventions as edits of a scene: the candidates of the search behind a failed image.

use crate::scene::{ALTERNATIVES, Alternative, Classified, Scene};
use std::sync::LazyLock;

/// A convention other than volref's.
#[derive(Clone, Copy, Debug)]
pub struct Convention {
    /// In a sentence about the renderer: "it …".
    pub words: &'static str,
    /// The choice it answers: no two of one choice apply together.
    pub choice: &'static str,
    /// It is claimed by itself; one that is also a mistake of the catalogue is not.
    pub stands_alone: bool,
    edit: Edit,
}

#[derive(Clone, Copy, Debug)]
enum Edit {
    Convention(&'static Alternative),
    EndRaysAt(f64),
    StepTimes(f64),
}

impl Convention {
    /// Makes it the convention of `volume`, if it is about anything there.
    pub fn apply(&self, volume: &mut Classified) {
        match self.edit {
            Edit::EndRaysAt(transmittance) => volume.end_rays_at(transmittance),
            // An exact integral has no step: a step is how a renderer approaches it, and no choice.
            Edit::StepTimes(factor) if !volume.continuous => volume.step *= factor,
            Edit::StepTimes(_) => {}
            Edit::Convention(other) => {
                let has_shadow = volume.shadow.is_some() || !other.in_shadow;
                let has_shading = volume.phong.is_some() || !other.shaded;
                if has_shadow && has_shading {
                    (other.set)(&mut volume.conventions);
                }
            }
        }
    }
}

/// The choice of a step, which is no convention: a scene states it.
pub const STEP: &str = "step";
/// Transmittances at which rays end, and factors on steps, which scenes state beside the table of conventions.
const ENDS: [(f64, &str); 4] = [
    (0.001, "ends rays at a transmittance of 0.001"),
    (1.0 / 255.0, "ends rays at a transmittance of 1/255"),
    (0.01, "ends rays at a transmittance of 0.01"),
    (0.05, "ends rays at a transmittance of 0.05"),
];
const STEPS: [(f64, &str); 4] = [
    (0.5, "takes steps of half the length"),
    (0.25, "takes steps of a quarter of the length"),
    (0.125, "takes steps of an eighth of the length"),
    (2.0, "takes steps of twice the length"),
];

/// Conventions tried by the search. Sample placement follows `last_step`.
pub static CATALOGUE: LazyLock<Vec<Convention>> = LazyLock::new(|| {
    let mut all = Vec::new();
    for (key, alternatives) in ALTERNATIVES {
        all.extend(alternatives.iter().map(|other| Convention {
            words: other.words,
            choice: other.instead_of.unwrap_or(key),
            stands_alone: other.stands_alone,
            edit: Edit::Convention(other),
        }));
        if *key == "last_step" {
            all.extend(ENDS.map(|(transmittance, words)| Convention {
                words,
                choice: "early_termination",
                stands_alone: true,
                edit: Edit::EndRaysAt(transmittance),
            }));
            all.extend(STEPS.map(|(factor, words)| Convention {
                words,
                choice: STEP,
                stands_alone: factor < 1.0,
                edit: Edit::StepTimes(factor),
            }));
        }
    }
    all
});

/// Indices in the [`CATALOGUE`], rising.
pub(crate) type ConventionSet = Vec<usize>;

/// `scene` under the conventions of `set`.
pub fn under(scene: &Scene, set: &[usize]) -> Scene {
    scene.with_volumes(|volume| {
        for &index in set {
            CATALOGUE[index].apply(volume);
        }
    })
}

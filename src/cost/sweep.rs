//! Sweeps of a parameter: every setting is tried once for its error and its work, then all are timed
//! by turns.

use super::norms::{Norms, norms};
use super::order::{ConvergenceOrder, ExpectedOrder, order};
use super::reference::{Truth, values};
use super::timing::{Clock, Times};
use super::work::measured;
use super::{CostError, MeanWork, Parameter, Reference, effects, thumbnail};
use crate::optics::Appearance;
use crate::render::Plan;
use crate::scene::{Classified, Conventions, Mode, Model, Panel, Scene};
use crate::volume::Interpolation;
use serde::Serialize;

/// Settings of one parameter, from coarse to fine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sweep {
    /// `step`, `step without light`, `shadow step` or `samples`.
    pub name: &'static str,
    /// The parameter that is varied.
    pub parameter: Parameter,
    /// The setting of the scene itself.
    pub own: f64,
    /// Columns and rows of the small image that is compared.
    pub size: [usize; 2],
    /// The reference of the errors.
    pub reference: Reference,
    /// The settings.
    pub levels: Vec<Level>,
    /// Order of convergence, expected and measured.
    pub order: ConvergenceOrder,
    /// Reason for ending early, if it did.
    pub cut: Option<String>,
}

/// One setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// The setting in words: "0.25 voxels", "16 samples".
    pub setting: String,
    /// The setting as a number: voxels, or samples.
    pub value: f64,
    /// Work of each pixel, mean over them.
    pub work: MeanWork,
    /// Error, relative to the root mean square of the reference.
    pub error: Norms,
    /// Wall time of each pixel, on one thread; preparing the image is part of it.
    pub time: Option<Times>,
}

/// Steps along rays and shadow rays, in voxels.
const STEPS: [f64; 9] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625];
/// Samples per pixel.
const SAMPLES: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];

/// Pixels of the larger side of the small image: some thousand rays tell an order as well as all do, and some hundred
/// where each takes long.
const SIDE: usize = 48;
const SIDE_WITH_SHADOW: usize = 16;
const SIDE_SAMPLED: usize = 16;

/// A sweep before it is run.
pub(super) struct Planned {
    pub name: &'static str,
    /// The small image.
    panel: Panel,
    parameter: Parameter,
    settings: &'static [f64],
    expected: ExpectedOrder,
}

/// The sweeps that say what accuracy costs in `panel`; none of a scene without parameters. The first one has the
/// advice.
pub(super) fn planned(panel: &Panel) -> Vec<Planned> {
    match &panel.model {
        Model::Classified(scene) => {
            let side = match scene.shadow {
                None => SIDE,
                Some(_) => SIDE_WITH_SHADOW,
            };
            let of = |name, scene: &Classified, side, parameter| Planned {
                name,
                panel: thumbnail(panel, Model::from(scene.clone()), side),
                parameter,
                settings: &STEPS,
                expected: expected(scene),
            };
            let mut planned = vec![of("step", scene, side, Parameter::Step)];
            // A highlight may be narrower than any step; emission and absorption show the order of the rule.
            if let Some(unlit) = effects::unlit(scene) {
                planned.push(of("step without light", &unlit, SIDE, Parameter::Step));
            }
            if scene.shadow.is_some() {
                planned.push(of("shadow step", scene, side, Parameter::ShadowStep));
            }
            planned
        }
        Model::Radiative(_) if Plan::new(panel).is_sampled() => vec![Planned {
            name: "samples",
            panel: thumbnail(panel, panel.model.clone(), SIDE_SAMPLED),
            parameter: Parameter::Samples,
            settings: &SAMPLES,
            expected: ExpectedOrder::OF_SAMPLES,
        }],
        Model::Radiative(_) | Model::Curve(_) => vec![],
    }
}

/// The order of the midpoint rule: 2, and 1 across jumps. Conventions, modes and objects have no order that is known.
fn expected(scene: &Classified) -> ExpectedOrder {
    let is_plain = scene.mode == Mode::Composited
        && scene.conventions == Conventions::default()
        && !scene.has_objects();
    if !is_plain {
        return ExpectedOrder::NOTHING;
    }
    let has_jumps = scene.interpolation == Interpolation::Nearest
        || match &scene.transfer_function.appearance {
            Appearance::Formula { .. } => false,
            Appearance::Points(points) => {
                let mut pairs = points.points().windows(2);
                pairs.any(|pair| pair[0].value == pair[1].value)
            }
        };
    ExpectedOrder::of_step(if has_jumps { 1.0 } else { 2.0 })
}

impl Planned {
    /// Tries the settings until the time limit, and times them.
    pub fn run(&self, seed: u64, clock: &Clock) -> Result<Sweep, CostError> {
        let (parameter, panel) = (self.parameter, &self.panel);
        let size = [panel.width, panel.height];
        let finest = *self.settings.last().expect("some settings");
        let truth = Truth::of(panel, parameter, finest, seed)?;
        let settings = self.settings.iter();
        let scenes = settings.map(|value| Ok(Scene::of(parameter.set(panel, *value)?)));
        let scenes: Vec<Scene> = scenes.collect::<Result<_, CostError>>()?;
        let images = measured(&scenes, None, seed, clock)?;
        let cut = (images.len() < scenes.len()).then(|| {
            let [tried, all] = [images.len(), scenes.len()];
            format!("the budget was used up after {tried} of {all} settings")
        });
        let levels = images
            .into_iter()
            .zip(self.settings)
            .map(|(image, &value)| {
                let errors = values(&image.film).into_iter().zip(&truth.values);
                let errors = errors.map(|(value, right)| value - right);
                Level {
                    setting: parameter.words(value),
                    value,
                    work: image.work,
                    error: norms(errors, truth.scale),
                    time: image.time,
                }
            });
        let levels: Vec<Level> = levels.collect();
        let last = levels.last();
        let (value, error) = last.map_or((finest, 0.0), |level| (level.value, level.error.l2));
        let reference = truth.reference(value, error);
        let points = levels.iter().map(|level| (level.value, level.error));
        Ok(Sweep {
            name: self.name,
            parameter,
            own: parameter.of(panel),
            size,
            order: order(points.collect(), self.expected, reference.bound),
            reference,
            levels,
            cut,
        })
    }
}

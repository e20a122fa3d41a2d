//! The parameters that are varied, and their settings.

use super::CostError;
use crate::scene::{Length, Model, Panel};
use serde::Serialize;

/// A parameter that is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Parameter {
    /// Distance between samples along a ray, voxels.
    Step,
    /// Distance between samples along a shadow ray, voxels.
    ShadowStep,
    /// Samples per pixel.
    Samples,
}

impl Parameter {
    /// `panel` with this setting: voxels of each volume, or samples per pixel.
    pub(super) fn set(self, panel: &Panel, value: f64) -> Result<Panel, CostError> {
        let mut panel = panel.clone();
        let set = match (&mut panel.model, self) {
            (Model::Classified(scene), Parameter::Step) => scene.set_step(Length::Voxels(value)),
            (Model::Classified(scene), Parameter::ShadowStep) => {
                scene.edit_volumes(|alone| {
                    let step = value * alone.voxel();
                    let shadow = alone.shadow.iter_mut();
                    shadow.for_each(|shadow| shadow.step = step);
                    true
                });
                scene.check_samples()
            }
            (Model::Radiative(scene), Parameter::Samples) => {
                scene.samples = value as u32;
                Ok(())
            }
            _ => Ok(()),
        };
        set.map(|()| panel).map_err(CostError::Setting)
    }

    /// The setting of `panel` itself.
    pub(super) fn of(self, panel: &Panel) -> f64 {
        match &panel.model {
            Model::Classified(scene) => {
                let step = match (self, scene.shadow) {
                    (Parameter::ShadowStep, Some(shadow)) => shadow.step,
                    _ => scene.step,
                };
                // Six digits: a length in voxels became a product, which is rounded.
                (step / scene.voxel() * 1e6).round() / 1e6
            }
            Model::Radiative(scene) => f64::from(scene.samples),
            Model::Curve(_) => 0.0,
        }
    }

    /// A setting in words: `0.25 voxels`, `16 samples`.
    pub fn words(self, value: f64) -> String {
        let plural = if value == 1.0 { "" } else { "s" };
        format!("{value} {}{plural}", self.unit())
    }

    /// The unit in which a setting is given, in the singular.
    pub fn unit(self) -> &'static str {
        match self {
            Parameter::Step | Parameter::ShadowStep => "voxel",
            Parameter::Samples => "sample",
        }
    }
}

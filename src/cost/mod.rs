//! Cost of accuracy: error against work and time.
//!
//! A scene approximates by the step along its rays, by that along its shadow rays, or by samples. Each such
//! [`Parameter`] is swept from coarse to fine: [`render`](crate::render::render) makes the image with every setting, and a
//! [reference](Reference) whose own error is stated judges it. [`order`] fits the order of convergence. Errors and
//! counts repeat to the last bit; wall time ([`timing`]) is reported and decides nothing.

pub mod advice;
pub mod effects;
pub mod norms;
pub mod order;
mod parameter;
mod reference;
mod sweep;
pub mod timing;
mod work;

pub use crate::render::Event;
pub use parameter::Parameter;
pub use reference::Reference;
pub use sweep::{Level, Sweep};
pub use work::MeanWork;

use crate::render::RenderError;
use crate::scene::{Compositing, Model, Panel, Scene};
use advice::Recommendation;
use effects::EffectPrice;
use serde::Serialize;
use thiserror::Error;
use timing::Clock;

/// The cost of accuracy in one scene, or in one panel of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Cost {
    /// The scene, as named by the user: a file, or a case.
    pub scene: String,
    /// Title of the panel, where the scene has several.
    pub panel: Option<String>,
    /// Error and work by setting, one sweep for each parameter.
    pub sweeps: Vec<Sweep>,
    /// The cost of each effect by itself.
    pub effects: Vec<EffectPrice>,
    /// Recommended settings.
    pub recommendations: Vec<Recommendation>,
    /// What was measured otherwise than the scene says, or not at all, with the reason.
    pub notes: Vec<String>,
}

/// Options of the measurement.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Time measurement and time limit.
    pub clock: Clock,
    /// Chooses the random numbers.
    pub seed: u64,
}

/// Errors that leave nothing measured.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CostError {
    /// The scene has no parameter to vary.
    #[error("this scene has no parameter to vary: {0}")]
    NoParameter(&'static str),
    /// A setting of the sweep is refused.
    #[error("a setting cannot be tried: {0}")]
    Setting(String),
    /// The scene cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Cost of accuracy in `scene`, panel by panel; results and commands call it `name`. `report` is called with what
/// is done next.
pub fn cost(
    scene: &Scene,
    name: &str,
    options: &Options,
    report: &dyn Fn(&str),
) -> Result<Vec<Cost>, CostError> {
    let several = scene.panels.len() > 1;
    let panels = scene.panels.iter().enumerate();
    let costs = panels.map(|(index, panel)| {
        let title = || {
            let number = || format!("panel {}", index + 1);
            panel.title.clone().unwrap_or_else(number)
        };
        let mut cost = Cost {
            scene: name.to_owned(),
            panel: several.then(title),
            ..Cost::default()
        };
        cost.measure(panel, options, report)?;
        Ok(cost)
    });
    costs.collect()
}

/// `panel` with another `model`, its larger side at most `most` pixels: costs are per pixel.
pub fn thumbnail(panel: &Panel, model: Model, most: usize) -> Panel {
    let larger = panel.width.max(panel.height);
    let most = most.min(larger);
    let size = [panel.width, panel.height].map(|side| (side * most).div_ceil(larger).max(1));
    Panel::of(model, size)
}

impl Cost {
    fn measure(
        &mut self,
        panel: &Panel,
        options: &Options,
        report: &dyn Fn(&str),
    ) -> Result<(), CostError> {
        let Options { clock, seed } = *options;
        let panel = &self.sampled_to_the_end(panel);
        let sweeps = sweep::planned(panel);
        if sweeps.is_empty() {
            return Err(CostError::NoParameter(match &panel.model {
                Model::Curve(_) => "a plot of a transfer function is not sampled",
                _ => "nothing in it is sampled, every pixel is a closed form or an integral",
            }));
        }
        for planned in &sweeps {
            if clock.is_over() {
                let name = planned.name;
                self.notes
                    .push(format!("{name}: not measured, the budget was used up"));
                continue;
            }
            report(planned.name);
            self.sweeps.push(planned.run(seed, &clock)?);
        }
        report("effects");
        self.effects = effects::prices(panel, seed, &clock)?;
        if self.effects.is_empty() {
            let note = "the price of effects: not measured, the budget was used up";
            self.notes.push(note.to_owned());
        }
        if let Some(sweep) = self.sweeps.first() {
            self.recommendations = advice::recommendations(sweep, &self.scene);
        }
        Ok(())
    }

    /// `panel`, but an integral is sampled, and rays that are ended early go on to their ends: each parameter is
    /// measured by itself. Notes what was changed.
    fn sampled_to_the_end(&mut self, panel: &Panel) -> Panel {
        let mut panel = panel.clone();
        let Model::Classified(scene) = &mut panel.model else {
            return panel;
        };
        if scene.continuous {
            let note = "the scene is an integral without samples; here it is sampled";
            self.notes.push(note.to_owned());
            scene.sample();
        }
        if let Compositing::EarlyTermination(_) = scene.compositing {
            let note = "`early_termination` is left out: here every ray is followed to its end";
            self.notes.push(note.to_owned());
            scene.compositing = Compositing::FrontToBack;
        }
        panel
    }
}

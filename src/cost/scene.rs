//! All that can be found out about one scene.

use super::estimators;
use super::jitter::Jitter;
use super::results::{Cost, JitterSplit, Study};
use super::timing::Clock;
use super::transmittance::{self, Crossings, RayThroughMedia};
use super::{advice, data, effects, image, pixels, samples};
use crate::render::radiative::effects::Everything;
use crate::render::radiative::scene_context::SceneContext;
use crate::render::{Plan, RenderError};
use crate::scene::{Classified, Compositing, Model, Panel, Radiative, Scene};
use std::path::Path;
use thiserror::Error;

/// How a scene is looked into.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Who measures time, and when it is over.
    pub clock: Clock,
    /// Chooses the random numbers.
    pub seed: u64,
}

/// Why nothing was found out.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CostError {
    /// There is nothing to be varied.
    #[error("this scene has no parameter to vary: {0}")]
    NoParameter(&'static str),
    /// The scene cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Cost of accuracy in `scene`, panel by panel. `report` is called with what is done next.
pub fn cost(
    scene: &Scene,
    options: &Options,
    report: &dyn Fn(&str),
) -> Result<Vec<Cost>, CostError> {
    let several = scene.panels.len() > 1;
    let panels = scene.panels.iter().enumerate();
    let costs = panels.map(|(index, panel)| {
        let mut cost = panel_cost(panel, &scene.path, options, report)?;
        if several {
            let title = panel.title.clone();
            cost.panel = Some(title.unwrap_or_else(|| format!("panel {}", index + 1)));
        }
        Ok(cost)
    });
    costs.collect()
}

/// A reference that knows less than this is said to.
const SURE: f64 = 1e-8;

fn panel_cost(
    panel: &Panel,
    path: &Path,
    options: &Options,
    report: &dyn Fn(&str),
) -> Result<Cost, CostError> {
    let mut cost = Cost {
        scene: path.display().to_string(),
        panel: None,
        studies: vec![],
        estimators: None,
        thickness: None,
        jitter: None,
        effects: vec![],
        recommendations: vec![],
        notes: vec![],
    };
    // Rays are followed to their ends here: what is measured is a scene's parameters, each by itself.
    let whole = to_the_end(panel);
    if whole.is_some() {
        let note = "`early_termination` is left out: every ray is followed to its end here";
        cost.notes.push(note.to_owned());
    }
    let panel = whole.as_ref().unwrap_or(panel);
    match &panel.model {
        Model::Curve(_) => {
            return Err(CostError::NoParameter(
                "a plot of a transfer function is not sampled",
            ));
        }
        Model::Classified(scene) => of_classified(&mut cost, scene, panel, options, report),
        Model::Radiative(scene) => of_radiative(&mut cost, scene, panel, options, report)?,
    }
    if cost.studies.is_empty() && (cost.notes.is_empty() || whole.is_some()) {
        return Err(CostError::NoParameter(
            "nothing in it is marched, tracked or sampled, every pixel is a closed form",
        ));
    }
    let missing = "the prices of effects were not measured";
    if has_time(&mut cost, options, report, "effects", missing) {
        match effects::prices(panel, &options.clock) {
            Ok(effects) => cost.effects = effects,
            Err(error) => {
                let note = format!("the prices of effects could not be measured: {error}");
                cost.notes.push(note);
            }
        }
    }
    let unsure = cost.studies.iter();
    let unsure = unsure.filter(|study| study.reference.bound > SURE);
    cost.notes.extend(unsure.map(|study| {
        let known = study.sweeps.iter().map(|sweep| sweep.order.known);
        format!(
            "{}: the reference itself may be off by {:.1e}; no order and no price is claimed below \
             {:.1e}",
            study.name,
            study.reference.bound,
            known.fold(0.0, f64::max)
        )
    }));
    let timed = cost.studies.iter().flat_map(|study| &study.sweeps);
    let mut levels = timed.flat_map(|sweep| &sweep.levels);
    if options.clock.runs > 0 && levels.all(|level| level.time.is_none()) {
        let note = "times were not taken: the time given was over";
        cost.notes.push(note.to_owned());
    }
    cost.recommendations = advice::recommendations(&cost, panel, path);
    Ok(cost)
}

/// Whether there is time for the next `step`, with which `report` is called; if not, what is `missing` is
/// noted.
fn has_time(
    cost: &mut Cost,
    options: &Options,
    report: &dyn Fn(&str),
    step: &str,
    missing: &str,
) -> bool {
    let is_over = options.clock.is_over();
    if is_over {
        cost.notes
            .push(format!("{missing}: the time given was over"))
    } else {
        report(step)
    }
    !is_over
}

/// `panel` without early termination, if it asks for that.
fn to_the_end(panel: &Panel) -> Option<Panel> {
    let Model::Classified(scene) = &panel.model else {
        return None;
    };
    let Compositing::EarlyTermination(_) = scene.compositing else {
        return None;
    };
    let mut scene = scene.clone();
    scene.compositing = Compositing::FrontToBack;
    Some(Panel {
        model: Model::Classified(scene),
        ..panel.clone()
    })
}

fn of_classified(
    cost: &mut Cost,
    scene: &Classified,
    panel: &Panel,
    options: &Options,
    report: &dyn Fn(&str),
) {
    let size = [panel.width, panel.height];
    let clock = &options.clock;
    report("steps");
    cost.studies.push(image::steps(scene, size, clock));
    let note = "the reference renderer's own ray caster leaps over empty space, the other schemes \
                look everywhere: compare their look-ups with that in mind";
    cost.notes.push(note.to_owned());
    let mut later = |name: &str, study: &dyn Fn() -> Option<Study>| {
        if has_time(
            cost,
            options,
            report,
            name,
            &format!("{name} were not tried"),
        ) {
            cost.studies.extend(study());
        }
    };
    later("steps without light", &|| {
        image::unlit_steps(scene, size, clock)
    });
    if scene.shadow.is_some() {
        later("shadow steps", &|| image::shadow_steps(scene, size, clock));
    }
    later("coarser data", &|| data::study(scene, size, clock));
    later("pixels", &|| Some(pixels::study(scene, size, clock)));
}

fn of_radiative(
    cost: &mut Cost,
    scene: &Radiative,
    panel: &Panel,
    options: &Options,
    report: &dyn Fn(&str),
) -> Result<(), CostError> {
    let size = [panel.width, panel.height];
    let clock = &options.clock;
    let around: SceneContext<'_, Everything> = SceneContext::new(scene, false);
    if let Some(crossings) = transmittance::crossings(&around, size) {
        report("transmittance");
        let study = transmittance::study(&crossings, options.seed, clock);
        cost.studies.push(study);
        of_one_ray(cost, &crossings, options, report);
        let missing = "coarser data were not tried";
        if has_time(cost, options, report, "coarser data", missing) {
            cost.studies.extend(data::of_grids(&crossings, clock));
        }
    }
    if Plan::new(panel).is_sampled() {
        let missing = "samples per pixel were not tried";
        if has_time(cost, options, report, "samples per pixel", missing) {
            cost.studies
                .push(samples::study(panel, options.seed, clock)?);
        }
    }
    Ok(())
}

/// An optical depth at which all estimators have something to tell.
const TYPICAL_DEPTH: f64 = 2.0;

/// Steps of jittered marching on one ray, as shares of its length.
const JITTER_STEPS: [f64; 8] = [
    0.25,
    0.125,
    0.0625,
    0.031_25,
    0.015_625,
    0.007_812_5,
    0.003_906_25,
    0.001_953_125,
];

/// Tables about a single ray: the one whose optical depth is nearest to [`TYPICAL_DEPTH`].
fn of_one_ray(
    cost: &mut Cost,
    crossings: &Crossings<'_>,
    options: &Options,
    report: &dyn Fn(&str),
) {
    let far = |ray: &&RayThroughMedia<'_>| (ray.depth - TYPICAL_DEPTH).abs();
    let rays = crossings.rays.iter();
    let Some(ray) = rays
        .filter(|ray| ray.depth > 0.0)
        .min_by(|a, b| far(a).total_cmp(&far(b)))
    else {
        return;
    };
    let name = format!(
        "pixel ({}, {}) of {} × {}, of optical depth {:.6}",
        ray.pixel[0], ray.pixel[1], crossings.size[0], crossings.size[1], ray.depth
    );
    let Options { clock, seed } = options;
    let missing = "estimators were not compared on one ray";
    if !has_time(cost, options, report, "estimators on one ray", missing)
        || ray.profile.majorant_depth() > transmittance::MOST_DEPTHS
    {
        return;
    }
    let (profile, depth) = (&ray.profile, ray.depth);
    cost.estimators = Some(estimators::table(
        name.clone(),
        profile,
        depth,
        *seed,
        clock,
    ));
    cost.thickness = Some(estimators::sweep(
        name.clone(),
        profile,
        depth,
        *seed,
        clock,
    ));
    let length = profile.span().length();
    let steps = JITTER_STEPS.map(|share| share * length);
    cost.jitter = Some(JitterSplit {
        ray: name,
        curves: [Jitter::Comb, Jitter::Stratified]
            .map(|jitter| jitter.curve(profile, &steps, crossings.rough))
            .into(),
    });
}

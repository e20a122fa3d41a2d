//! All studies of one scene.

use super::estimators;
use super::jitter::Jitter;
use super::results::{Cost, JitterSplit, Study};
use super::study::halved;
use super::timing::Clock;
use super::transmittance::{self, Crossings, RayThroughMedia};
use super::{advice, data, effects, image, pixels, samples};
use crate::render::radiative::effects::Everything;
use crate::render::radiative::scene_context::SceneContext;
use crate::render::{Plan, RenderError};
use crate::scene::{Classified, Compositing, Mode, Model, Panel, Radiative, Scene};
use thiserror::Error;

/// Options of the studies.
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
        let mut cost = panel_cost(panel, name, options, report)?;
        if several {
            let title = panel.title.clone();
            cost.panel = Some(title.unwrap_or_else(|| format!("panel {}", index + 1)));
        }
        Ok(cost)
    });
    costs.collect()
}

/// Largest bound of a reference that is not noted.
const SURE: f64 = 1e-8;

/// Results of the studies of a panel so far, and their options.
struct Inquiry<'a> {
    cost: Cost,
    panel: &'a Panel,
    options: &'a Options,
    report: &'a dyn Fn(&str),
}

/// Reason why a panel has no study.
fn unstudied(model: &Model) -> Option<&'static str> {
    let Model::Classified(scene) = model else {
        return matches!(model, Model::Curve(_))
            .then_some("a plot of a transfer function is not sampled");
    };
    if scene.mode != Mode::Composited {
        Some(
            "projections and isosurfaces (`mode`) composite no samples; their cost is that of the step, or of \
             the cells on a ray: see `volref plan --counters`",
        )
    } else if scene.objects.are_modulation_alone() {
        Some("modulated opacities have no study yet; measure the scene without `modulation`")
    } else if scene.has_objects() {
        Some("several volumes, surfaces and clips have no study yet; measure a scene of one volume")
    } else {
        None
    }
}

fn panel_cost(
    panel: &Panel,
    name: &str,
    options: &Options,
    report: &dyn Fn(&str),
) -> Result<Cost, CostError> {
    if let Some(reason) = unstudied(&panel.model) {
        return Err(CostError::NoParameter(reason));
    }
    // Rays are followed to their ends here: what is measured is a scene's parameters, each by itself.
    let whole = to_the_end(panel);
    let panel = whole.as_ref().map_or(panel, |(panel, _)| panel);
    let mut inquiry = Inquiry {
        cost: Cost {
            scene: name.to_owned(),
            ..Cost::default()
        },
        panel,
        options,
        report,
    };
    if let Some((_, note)) = whole {
        inquiry.note(note);
    }
    match &panel.model {
        Model::Curve(_) => {}
        Model::Classified(scene) => inquiry.classified(scene),
        Model::Radiative(scene) => inquiry.radiative(scene)?,
    }
    let cost = &inquiry.cost;
    if cost.studies.is_empty() && (cost.notes.is_empty() || whole.is_some()) {
        return Err(CostError::NoParameter(
            "nothing in it is marched, tracked or sampled, every pixel is a closed form",
        ));
    }
    if inquiry.has_time("effects", "the cost of each effect was not measured") {
        match effects::prices(panel, &options.clock) {
            Ok(effects) => inquiry.cost.effects = effects,
            Err(error) => {
                inquiry.note(&format!(
                    "the cost of each effect could not be measured: {error}"
                ));
            }
        }
    }
    let mut cost = inquiry.cost;
    for study in cost
        .studies
        .iter()
        .filter(|study| study.reference.bound > SURE)
    {
        let known = study.sweeps.iter().map(|sweep| sweep.order.known);
        cost.notes.push(format!(
            "{}: the reference itself may be off by {:.1e}; no order and no cost is claimed below \
             {:.1e}",
            study.name,
            study.reference.bound,
            known.fold(0.0, f64::max)
        ));
    }
    let timed = cost.studies.iter().flat_map(|study| &study.sweeps);
    let mut levels = timed.flat_map(|sweep| &sweep.levels);
    if options.clock.runs > 0 && levels.all(|level| level.time.is_none()) {
        let note = "times were not measured: the budget was used up";
        cost.notes.push(note.to_owned());
    }
    cost.recommendations = advice::recommendations(&cost, panel);
    Ok(cost)
}

/// `panel` without early termination or sampled, if it asks for the one or is an integral; and the note
/// on that.
fn to_the_end(panel: &Panel) -> Option<(Panel, &'static str)> {
    let Model::Classified(scene) = &panel.model else {
        return None;
    };
    let note = match scene.compositing {
        _ if scene.is_continuous() => {
            "the scene is an integral without samples; here it is sampled, front to back"
        }
        Compositing::FrontToBack | Compositing::BackToFront => return None,
        Compositing::EarlyTermination(_) => {
            "`early_termination` is left out: every ray is followed to its end here"
        }
    };
    let mut scene = scene.clone();
    scene.sample();
    scene.compositing = Compositing::FrontToBack;
    let panel = Panel {
        model: Model::Classified(scene),
        ..panel.clone()
    };
    Some((panel, note))
}

/// Optical depth at which all estimators can be compared.
const TYPICAL_DEPTH: f64 = 2.0;

/// Steps of jittered marching on one ray, as shares of its length.
const JITTER_STEPS: [f64; 8] = halved(0.25);

impl Inquiry<'_> {
    fn note(&mut self, note: &str) {
        self.cost.notes.push(note.to_owned());
    }

    /// True if there is time for the next `step`, which is reported; else notes that `missing` was
    /// left out.
    fn has_time(&mut self, step: &str, missing: &str) -> bool {
        let is_over = self.options.clock.is_over();
        if is_over {
            self.note(&format!("{missing}: the budget was used up"));
        } else {
            (self.report)(step);
        }
        !is_over
    }

    fn classified(&mut self, scene: &Classified) {
        let size = [self.panel.width, self.panel.height];
        let clock = &self.options.clock;
        (self.report)("steps");
        self.cost.studies.push(image::steps(scene, size, clock));
        self.note(
            "the reference renderer's own ray caster leaps over empty space, the other schemes \
             look everywhere: compare their lookups with that in mind",
        );
        type StudyOf = fn(&Classified, [usize; 2], &Clock) -> Option<Study>;
        let later: [(&str, bool, StudyOf); 4] = [
            ("steps without light", true, image::unlit_steps),
            ("shadow steps", scene.shadow.is_some(), image::shadow_steps),
            ("coarser data", true, data::study),
            ("pixels", true, |scene, size, clock| {
                Some(pixels::study(scene, size, clock))
            }),
        ];
        for (name, is_wanted, study) in later {
            if is_wanted && self.has_time(name, &format!("{name} were not tried")) {
                self.cost.studies.extend(study(scene, size, clock));
            }
        }
    }

    fn radiative(&mut self, scene: &Radiative) -> Result<(), CostError> {
        let Options { clock, seed } = self.options;
        let around: SceneContext<'_, Everything> = SceneContext::new(scene, false);
        let size = [self.panel.width, self.panel.height];
        if let Some(crossings) = transmittance::crossings(&around, size) {
            (self.report)("transmittance");
            let study = transmittance::study(&crossings, *seed, clock);
            self.cost.studies.push(study);
            self.one_ray(&crossings);
            if self.has_time("coarser data", "coarser data were not tried") {
                self.cost.studies.extend(data::of_grids(&crossings, clock));
            }
        }
        let is_sampled = Plan::new(self.panel).is_sampled();
        if is_sampled && self.has_time("samples per pixel", "samples per pixel were not tried") {
            let study = samples::study(self.panel, *seed, clock)?;
            self.cost.studies.push(study);
        }
        Ok(())
    }

    /// Tables about a single ray: the one whose optical depth is nearest to [`TYPICAL_DEPTH`].
    fn one_ray(&mut self, crossings: &Crossings<'_>) {
        let far = |ray: &&RayThroughMedia<'_>| (ray.depth - TYPICAL_DEPTH).abs();
        let rays = crossings.rays.iter().filter(|ray| ray.depth > 0.0);
        let Some(ray) = rays.min_by(|a, b| far(a).total_cmp(&far(b))) else {
            return;
        };
        let missing = "estimators were not compared on one ray";
        if !self.has_time("estimators on one ray", missing)
            || ray.profile.majorant_depth() > transmittance::MOST_DEPTHS
        {
            return;
        }
        let ([column, row], [width, height]) = (ray.pixel, crossings.size);
        let name = format!(
            "pixel ({column}, {row}) of {width} × {height}, of optical depth {:.6}",
            ray.depth
        );
        let Options { clock, seed } = self.options;
        let (profile, depth) = (&ray.profile, ray.depth);
        let table = estimators::table(name.clone(), profile, depth, *seed, clock);
        let thickness = estimators::sweep(name.clone(), profile, depth, *seed, clock);
        let length = profile.span().length();
        let steps = JITTER_STEPS.map(|share| share * length);
        self.cost.estimators = Some(table);
        self.cost.thickness = Some(thickness);
        self.cost.jitter = Some(JitterSplit {
            ray: name,
            curves: [Jitter::Comb, Jitter::Stratified]
                .map(|jitter| jitter.curve(profile, &steps, crossings.rough))
                .into(),
        });
    }
}

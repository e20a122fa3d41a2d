//! `volref plan SCENE`

use super::failure::{Failure, bad_input};
use super::output::{self, Json};
use super::render::warnings_of_all;
use super::suite::scene_file;
use super::{Outcome, progress};
use crate::render::counters::Event;
use crate::render::plan::{Approximation, Decision, Estimator, PlanError, Reason};
use crate::render::{self, Counters, Effect, Footprint, Memory, Plan, Sampling};
use crate::report::widest;
use crate::scene::{Classified, Model, Origin, Panel, Scene};
use indicatif::HumanBytes;
use serde::Serialize;
use std::path::PathBuf;

/// Show how a scene is rendered: effects and why, kernel, defaults
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene file (TOML), or a case of the suite
    scene: PathBuf,
    /// Render the scene and count its work
    #[arg(long)]
    counters: bool,
    /// Simulate an elided effect: same bits, more work. May be given several times; `all` for all
    /// elided effects
    #[arg(long, value_name = "EFFECT", value_parser = forced)]
    force: Vec<Forced>,
    #[command(flatten)]
    json: Json,
}

/// The elided effects to simulate nevertheless: one, or all.
type Forced = Option<Effect>;

fn forced(name: &str) -> Result<Forced, String> {
    if name == "all" {
        return Ok(None);
    }
    let effect = name.parse().map(Some);
    effect.map_err(|error: String| format!("{error}; or all, for all elided effects"))
}

/// The plan for `panel` with the `forced` effects.
fn plan_for<'s>(panel: &'s Panel, forced: &[Forced]) -> Result<Plan<'s>, PlanError> {
    let effects = forced.iter().flat_map(|forced| match forced {
        None => Plan::null_effects(panel),
        Some(effect) => vec![*effect],
    });
    Plan::forcing(panel, &effects.collect::<Vec<_>>())
}

#[derive(Serialize)]
struct PlanJson<'s> {
    schema: &'static str,
    scene: &'s PathBuf,
    image: ImageJson,
    /// Memory of the values of all volumes, bytes.
    volume_bytes: u64,
    panels: Vec<PanelJson<'s>>,
}

/// The whole image, all panels together.
#[derive(Serialize)]
struct ImageJson {
    width: usize,
    height: usize,
    /// Memory of the finished image, bytes.
    bytes: u64,
    /// Peak memory while it is rendered and written, bytes.
    most_bytes: u64,
}

#[derive(Serialize)]
struct PanelJson<'s> {
    title: Option<&'s str>,
    kernel: String,
    estimator: &'s Estimator,
    effects: &'s [Decision],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    approximations: &'s [Approximation],
    warnings: &'s [Reason],
    #[serde(skip_serializing_if = "Option::is_none")]
    volume: Option<VolumeJson>,
    /// Further volumes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    further_volumes: Vec<VolumeJson>,
    /// Numbers of surfaces and of clips among volumes.
    #[serde(skip_serializing_if = "Option::is_none")]
    surfaces: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    clips: Option<usize>,
    defaults: Vec<DefaultJson<'s>>,
    /// Rays from the eye.
    rays: u64,
    memory: Vec<Memory>,
    /// Work of all rays.
    #[serde(skip_serializing_if = "Option::is_none")]
    counters: Option<Counters>,
}

impl<'s> PanelJson<'s> {
    fn of(plan: &'s Plan<'s>, counters: Option<Counters>) -> PanelJson<'s> {
        let panel = plan.panel;
        let mut volumes = volumes(panel).into_iter();
        let objects = panel.classified().filter(|it| !it.objects.is_empty());
        let objects = objects.map(|it| &it.objects);
        PanelJson {
            title: panel.title.as_deref(),
            kernel: plan.kernel.to_string(),
            estimator: &plan.estimator,
            effects: &plan.decisions,
            approximations: &plan.approximations,
            warnings: &plan.warnings,
            volume: volumes.next(),
            further_volumes: volumes.collect(),
            surfaces: objects.map(|objects| objects.surfaces.len()),
            clips: objects.map(|objects| objects.clips.len()),
            defaults: defaults(panel).collect(),
            rays: rays(plan),
            memory: plan.memory(),
            counters,
        }
    }

    /// The same for people.
    fn in_words(&self) -> String {
        let mut text = format!("kernel     {}\n", self.kernel);
        let Estimator { method, why } = self.estimator;
        text.push_str(&format!("estimator  {method}: {why}\n"));
        for volume in self.volume.iter().chain(&self.further_volumes) {
            let ([nx, ny, nz], [x, y, z], [u, v, w]) = (volume.nodes, volume.min, volume.max);
            text.push_str(&format!(
            "volume     {nx} × {ny} × {nz} nodes, voxel size {}, from ({x}, {y}, {z}) to ({u}, {v}, {w})\n",
            volume.voxel
        ));
        }
        if !self.warnings.is_empty() {
            text.push_str("\nwarnings\n");
            for warning in self.warnings {
                text.push_str(&format!("  {}\n", warning));
            }
        }
        text.push_str("\neffects\n");
        for decision in self.effects {
            text.push_str(&format!(
                "  {:<7}  {:<22}  {}\n",
                decision.state, decision.effect, decision.why
            ));
        }
        if !self.approximations.is_empty() {
            text.push_str("\napproximations requested\n");
        }
        for of in self.approximations {
            let line = of
                .line
                .map_or(String::new(), |line| format!(", line {line}"));
            text.push_str(&format!(
                "  without {}: pixels are off by less than {:.3e}  ({}{line})\n",
                of.without, of.bias, of.field
            ));
        }
        text.push_str("\ndefaults filled in\n");
        if self.defaults.is_empty() {
            text.push_str("  none\n");
        }
        let widest = widest(self.defaults.iter().map(|default| default.key));
        for DefaultJson { key, value, rule } in &self.defaults {
            let rule = rule.map_or(String::new(), |rule| format!("  ({rule})"));
            text.push_str(&format!("  {key:<widest$}  {value}{rule}\n"));
        }
        if let Some(work) = &self.counters {
            text.push('\n');
            text.push_str(&describe_work(self.rays, work));
        }
        text.push_str("\nmemory besides the scene and the image\n");
        if self.memory.is_empty() {
            text.push_str("  none\n");
        }
        for Memory { what, bytes } in &self.memory {
            text.push_str(&format!(
                "  {:>10}  {what}\n",
                HumanBytes(*bytes as u64).to_string()
            ));
        }
        text.push('\n');
        text
    }
}

#[derive(Serialize)]
struct DefaultJson<'s> {
    key: &'s str,
    value: &'s str,
    #[serde(skip_serializing_if = "Option::is_none")]
    rule: Option<&'static str>,
}

/// Position of the grid, world units.
#[derive(Serialize)]
struct VolumeJson {
    nodes: [usize; 3],
    voxel: f64,
    min: [f64; 3],
    max: [f64; 3],
    /// Rows of the map of the grid into the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    to_world: Option<[[f64; 4]; 3]>,
}

fn volumes(panel: &Panel) -> Vec<VolumeJson> {
    match &panel.model {
        Model::Classified(classified) => classified
            .each_alone()
            .map(|alone| volume(&alone))
            .collect(),
        Model::Radiative(_) | Model::Curve(_) => vec![],
    }
}

fn volume(classified: &Classified) -> VolumeJson {
    let lattice = classified.grid.lattice();
    let bounds = classified.extent().world_bounds();
    VolumeJson {
        nodes: lattice.nodes(),
        voxel: classified.voxel(),
        min: bounds.min.to_array(),
        max: bounds.max.to_array(),
        to_world: classified.to_world.map(|map| map.rows()),
    }
}

/// Runs the command.
pub fn run(mut arguments: Arguments) -> Result<Outcome, Failure> {
    arguments.scene = scene_file(&arguments.scene)?;
    let outputs = [arguments.json.file()];
    output::check(&outputs, &[&arguments.scene])?;
    let read = || Scene::load(&arguments.scene);
    let scene = progress::during("reading the scene", read)?;
    output::check(&outputs, &[])?;
    let plans = scene
        .panels
        .iter()
        .map(|panel| plan_for(panel, &arguments.force))
        .collect::<Result<Vec<_>, _>>()
        .map_err(bad_input)?;
    let work = if arguments.counters {
        counted(&plans)?
    } else {
        vec![None; plans.len()]
    };
    let (width, height) = (scene.width(), scene.height());
    let Footprint { image, most } = render::footprint(&plans, Sampling::default());
    let mut text = format!(
        "image      {width} × {height} pixels, {}; at most {} while it is rendered and written\n",
        HumanBytes(image),
        HumanBytes(most)
    );
    let volume_bytes = scene.volume_bytes();
    if volume_bytes > 0 {
        text.push_str(&format!(
            "volumes    {} of values\n",
            HumanBytes(volume_bytes)
        ));
    }
    let panels = plans.iter().zip(work);
    let panels: Vec<PanelJson<'_>> = panels
        .map(|(plan, work)| PanelJson::of(plan, work))
        .collect();
    for (index, panel) in panels.iter().enumerate() {
        if plans.len() > 1 {
            let title = panel.title.unwrap_or("untitled");
            text.push_str(&format!("panel {}: {title}\n", index + 1));
        }
        text.push_str(&panel.in_words());
    }
    let value = PlanJson {
        schema: "volref/plan/1",
        scene: &arguments.scene,
        image: ImageJson {
            width,
            height,
            bytes: image,
            most_bytes: most,
        },
        volume_bytes,
        panels,
    };
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

/// Work of each plan, counted while it is rendered.
fn counted(plans: &[Plan]) -> Result<Vec<Option<Counters>>, Failure> {
    let bar = progress::image("counting", &warnings_of_all(plans));
    let rendering = render::render_counted(plans, Sampling::default(), &bar);
    bar.finish_and_clear();
    let work = rendering.map_err(bad_input)?.work;
    Ok(work.into_iter().map(Some).collect())
}

fn defaults(panel: &Panel) -> impl Iterator<Item = DefaultJson<'_>> {
    panel.readings.iter().filter_map(|reading| {
        let rule = match reading.origin {
            Origin::Given => return None,
            Origin::Default => None,
            Origin::Derived(rule) => Some(rule),
        };
        Some(DefaultJson {
            key: &reading.key,
            value: &reading.value,
            rule,
        })
    })
}

/// Rays from the eye.
fn rays(plan: &Plan<'_>) -> u64 {
    let pixels = (plan.panel.width * plan.panel.height) as u64;
    pixels.saturating_mul(plan.samples(Sampling::default()).into())
}

/// The work of `rays`, per ray and in all.
fn describe_work(rays: u64, work: &Counters) -> String {
    let mut text = format!(
        "work {:<23}  {:>12}  {:>14}\n",
        format!("({rays} rays)"),
        "per ray",
        "total"
    );
    for event in Event::ALL {
        let (name, count) = (event.key().replace('_', " "), work[event]);
        let per_ray = short(count as f64 / rays.max(1) as f64);
        text.push_str(&format!("  {name:<26}  {per_ray:>12}  {count:>14}\n"));
    }
    text
}

/// Four digits, without an exponent.
fn short(number: f64) -> String {
    let decimals = match number {
        _ if number == number.trunc() => 0,
        _ if number >= 1000.0 => 0,
        _ if number >= 100.0 => 1,
        _ if number >= 10.0 => 2,
        _ if number >= 1.0 => 3,
        _ => 4,
    };
    format!("{number:.decimals$}")
}

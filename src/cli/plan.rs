//! `volref plan SCENE`

use super::failure::{Failure, bad_input};
use super::output::{self, Json};
use super::suite::named_scene;
use super::{Outcome, progress};
use crate::render::counters::Event;
use crate::render::plan::{Estimator, PlanError};
use crate::render::{self, Counters, Effect, Footprint, Plan, Sampling};
use crate::report::widest;
use crate::scene::{Origin, Panel, Reading, Scene};
use clap::builder::PossibleValuesParser;
use indicatif::HumanBytes;
use serde_json::{Value, json};
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
    #[arg(long, value_name = "EFFECT", value_parser = effects())]
    force: Vec<String>,
    #[command(flatten)]
    json: Json,
}

/// All that `all` stands for.
const ALL: &str = "all";

fn effects() -> PossibleValuesParser {
    PossibleValuesParser::new(Effect::ALL.iter().map(|it| it.name()).chain([ALL]))
}

/// The plan for `panel` with the effects of these names.
fn plan_for<'s>(panel: &'s Panel, names: &[String]) -> Result<Plan<'s>, PlanError> {
    let named = |effect: &Effect| names.iter().any(|name| name == effect.name());
    let mut forced: Vec<Effect> = Effect::ALL.into_iter().filter(named).collect();
    if names.iter().any(|name| name == ALL) {
        forced.extend(Plan::null_effects(panel));
    }
    Plan::forcing(panel, &forced)
}

/// Runs the command.
pub fn run(mut arguments: Arguments) -> Result<Outcome, Failure> {
    arguments.scene = named_scene(&arguments.scene)?.file;
    let outputs = [arguments.json.file()];
    output::check(&outputs, &[&arguments.scene])?;
    let read = || Scene::load(&arguments.scene);
    let scene = progress::during("reading the scene", read)?;
    output::check(&outputs, &[])?;
    let plan = |panel| plan_for(panel, &arguments.force);
    let plans: Result<Vec<_>, _> = scene.panels.iter().map(plan).collect();
    let plans = plans.map_err(bad_input)?;
    let mut work = Vec::new();
    if arguments.counters {
        let bar = progress::image("counting");
        let rendering = render::render(&plans, Sampling::default(), &bar);
        work = rendering.map_err(bad_input)?.work;
    }
    let (width, height) = (scene.width(), scene.height());
    let Footprint { image, most } = render::footprint(&plans, Sampling::default());
    let mut text = format!(
        "image      {width} × {height} pixels, {}; at most {} while it is rendered and written\n",
        HumanBytes(image),
        HumanBytes(most)
    );
    let volume_bytes = scene.volume_bytes();
    if volume_bytes > 0 {
        let size = HumanBytes(volume_bytes);
        text.push_str(&format!("volumes    {size} of values\n"));
    }
    let mut panels = Vec::new();
    for (index, plan) in plans.iter().enumerate() {
        if plans.len() > 1 {
            let title = plan.panel.title.as_deref().unwrap_or("untitled");
            text.push_str(&format!("panel {}: {title}\n", index + 1));
        }
        panels.push(described(plan, work.get(index), &mut text));
    }
    let value = json!({
        "schema": "volref/plan/1",
        "scene": arguments.scene,
        "image": { "width": width, "height": height, "bytes": image, "most_bytes": most },
        "volume_bytes": volume_bytes,
        "panels": panels,
    });
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

/// The plan of a panel as JSON, and the same for people, at the end of `text`.
fn described(plan: &Plan<'_>, work: Option<&Counters>, text: &mut String) -> Value {
    let panel = plan.panel;
    let pixels = (panel.width * panel.height) as u64;
    let rays = pixels.saturating_mul(plan.samples(Sampling::default()).into());
    let Estimator { method, why } = &plan.estimator;
    text.push_str(&format!(
        "kernel     {}\nestimator  {method}: {why}\n",
        plan.kernel
    ));
    let mut json = json!({
        "title": panel.title,
        "kernel": plan.kernel.to_string(),
        "estimator": plan.estimator,
        "effects": plan.decisions,
        "warnings": plan.warnings,
        "rays": rays,
    });
    describe_volumes(panel, text, &mut json);
    let mut section = |title: &str, lines: Vec<String>| {
        text.push_str(&format!("\n{title}\n"));
        lines
            .iter()
            .for_each(|line| text.push_str(&format!("  {line}\n")));
    };
    let warnings = plan.warnings.iter().map(ToString::to_string);
    if !plan.warnings.is_empty() {
        section("warnings", warnings.collect());
    }
    let effects = plan.decisions.iter();
    let effects = effects.map(|of| format!("{:<7}  {:<22}  {}", of.state, of.effect, of.why));
    section("effects", effects.collect());
    if !plan.approximations.is_empty() {
        json["approximations"] = json!(plan.approximations);
        let lines = plan.approximations.iter().map(|of| {
            let line = of
                .line
                .map_or(String::new(), |line| format!(", line {line}"));
            format!(
                "without {}: pixels are off by less than {:.3e}  ({}{line})",
                of.without, of.bias, of.field
            )
        });
        section("approximations requested", lines.collect());
    }
    let defaults = panel.readings.iter();
    let defaults = defaults.filter(|reading| reading.origin != Origin::Given);
    let widest = widest(defaults.clone().map(|reading| &reading.key));
    let (mut lines, mut entries) = (Vec::new(), Vec::new());
    for Reading { key, value, origin } in defaults {
        let mut default = json!({ "key": key, "value": value });
        let mut line = format!("{key:<widest$}  {value}");
        if let Origin::Derived(rule) = origin {
            default["rule"] = json!(rule);
            line.push_str(&format!("  ({rule})"));
        }
        entries.push(default);
        lines.push(line);
    }
    json["defaults"] = json!(entries);
    if lines.is_empty() {
        lines.push("none".to_owned());
    }
    section("defaults filled in", lines);
    if let Some(work) = work {
        json["counters"] = json!(work);
        let count = format!("({rays} rays)");
        let title = format!("work {count:<23}  {:>12}  {:>14}", "per ray", "total");
        let lines = Event::ALL.map(|event| {
            let (name, count) = (event.key().replace('_', " "), work[event]);
            let per_ray = count as f64 / rays.max(1) as f64;
            format!("{name:<26}  {per_ray:>12.3}  {count:>14}")
        });
        section(&title, lines.into());
    }
    text.push('\n');
    json
}

/// Position of the grids, world units, and the numbers of what is among them.
fn describe_volumes(panel: &Panel, text: &mut String, json: &mut Value) {
    let Some(classified) = panel.classified() else {
        return;
    };
    let mut volumes = Vec::new();
    for volume in classified.each_alone() {
        let ([nx, ny, nz], voxel) = (volume.grid.lattice().nodes(), volume.voxel());
        let bounds = volume.extent().world_bounds();
        let ([x, y, z], [u, v, w]) = (bounds.min.to_array(), bounds.max.to_array());
        text.push_str(&format!(
            "volume     {nx} × {ny} × {nz} nodes, voxel size {voxel}, from ({x}, {y}, {z}) to ({u}, {v}, {w})\n"
        ));
        let mut json = json!({
            "nodes": [nx, ny, nz], "voxel": voxel, "min": [x, y, z], "max": [u, v, w],
        });
        if let Some(map) = volume.to_world {
            json["to_world"] = json!(map.rows());
        }
        volumes.push(json);
    }
    json["volume"] = volumes.remove(0);
    if !volumes.is_empty() {
        json["further_volumes"] = json!(volumes);
    }
    if !classified.objects.is_empty() {
        json["surfaces"] = json!(classified.objects.surfaces.len());
        json["clips"] = json!(classified.objects.clips.len());
    }
}

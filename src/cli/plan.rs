//! `volref plan SCENE`

use super::failure::{Exit, Failure};
use super::output::Json;
use super::{Outcome, progress};
use crate::render::{self, Counters, Effect, Plan, State};
use crate::scene::{Model, Origin, Panel, Scene};
use serde::Serialize;
use std::path::PathBuf;

/// Show what a scene calls for: effects with reasons, the kernel, filled-in defaults
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Render, and show how much work of each kind was done
    #[arg(long)]
    counters: bool,
    /// Simulate an effect although it is provably null here: same bits, more work
    #[arg(long, value_name = "EFFECT")]
    force: Vec<Effect>,
    #[command(flatten)]
    json: Json,
}

#[derive(Serialize)]
struct PlanJson<'s> {
    schema: &'static str,
    scene: &'s PathBuf,
    panels: Vec<PanelJson<'s>>,
}

#[derive(Serialize)]
struct PanelJson<'s> {
    title: Option<&'s str>,
    kernel: String,
    effects: &'s [render::plan::Decision],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    approximations: &'s [render::plan::Approximation],
    #[serde(skip_serializing_if = "Option::is_none")]
    volume: Option<VolumeJson>,
    defaults: Vec<DefaultJson<'s>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    counters: Option<Counters>,
}

#[derive(Serialize)]
struct DefaultJson<'s> {
    key: &'s str,
    value: &'s str,
    #[serde(skip_serializing_if = "Option::is_none")]
    rule: Option<&'static str>,
}

/// Where the grid lies, world units.
#[derive(Serialize)]
struct VolumeJson {
    nodes: [usize; 3],
    voxel: f64,
    min: [f64; 3],
    max: [f64; 3],
}

fn volume(panel: &Panel) -> Option<VolumeJson> {
    let Model::Classified(classified) = &panel.model else {
        return None;
    };
    let lattice = classified.grid.lattice();
    let bounds = lattice.bounds();
    Some(VolumeJson {
        nodes: lattice.nodes(),
        voxel: lattice.voxel(),
        min: bounds.min.to_array(),
        max: bounds.max.to_array(),
    })
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    arguments.json.check()?;
    let scene = Scene::load(&arguments.scene)?;
    let plans = scene
        .panels
        .iter()
        .map(|panel| Plan::forcing(panel, &arguments.force))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| Failure::new(Exit::BadInput, error.to_string(), None))?;
    let work = if arguments.counters {
        let bar = progress::rows(
            "counting",
            scene.panels.iter().map(|panel| panel.height).sum(),
        );
        let rendering = render::render_counted(&scene, &plans, &|| bar.inc(1));
        bar.finish_and_clear();
        let rendering =
            rendering.map_err(|error| Failure::new(Exit::BadInput, error.to_string(), None))?;
        rendering.work.into_iter().map(Some).collect()
    } else {
        vec![None; plans.len()]
    };

    let mut text = String::new();
    let mut panels = Vec::new();
    for (index, ((panel, plan), work)) in scene.panels.iter().zip(&plans).zip(work).enumerate() {
        if scene.panels.len() > 1 {
            let title = panel.title.as_deref().unwrap_or("untitled");
            text.push_str(&format!("panel {}: {title}\n", index + 1));
        }
        text.push_str(&describe(panel, plan, work.as_ref()));
        panels.push(PanelJson {
            title: panel.title.as_deref(),
            kernel: plan.kernel.to_string(),
            effects: &plan.decisions,
            approximations: &plan.approximations,
            volume: volume(panel),
            defaults: defaults(panel).collect(),
            counters: work,
        });
    }
    let value = PlanJson {
        schema: "volref/plan/1",
        scene: &arguments.scene,
        panels,
    };
    arguments.json.instead_of(text, &value).map(Outcome::from)
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

fn describe(panel: &Panel, plan: &Plan, work: Option<&Counters>) -> String {
    let mut text = format!("kernel  {}\n", plan.kernel);
    if let Some(volume) = volume(panel) {
        let ([nx, ny, nz], [x, y, z], [u, v, w]) = (volume.nodes, volume.min, volume.max);
        text.push_str(&format!(
            "volume  {nx} × {ny} × {nz} nodes, voxel {}, from ({x}, {y}, {z}) to ({u}, {v}, {w})\n",
            volume.voxel
        ));
    }
    text.push_str("\neffects\n");
    for decision in &plan.decisions {
        text.push_str(&format!(
            "  {:<7}  {:<22}  {}",
            decision.state, decision.effect, decision.reason
        ));
        match decision.field {
            Some(field) if decision.state != State::Omitted => {
                text.push_str(&format!("  ({field})\n"));
            }
            _ => text.push('\n'),
        }
    }
    if !plan.approximations.is_empty() {
        text.push_str("\napproximations asked for\n");
    }
    for approximation in &plan.approximations {
        text.push_str(&format!(
            "  without {}: pixels are off by less than {:.3e}  ({})\n",
            approximation.without, approximation.bias, approximation.field
        ));
    }
    text.push_str("\ndefaults filled in\n");
    if defaults(panel).next().is_none() {
        text.push_str("  none\n");
    }
    let widest = defaults(panel).map(|default| default.key.len()).max();
    let widest = widest.unwrap_or(0);
    for DefaultJson { key, value, rule } in defaults(panel) {
        let rule = rule.map_or(String::new(), |rule| format!("  ({rule})"));
        text.push_str(&format!("  {key:<widest$}  {value}{rule}\n"));
    }
    if let Some(work) = work {
        text.push_str("\nwork\n");
        let work = serde_json::to_value(work).expect("plain data becomes JSON");
        for (name, count) in work.as_object().expect("counters are a map") {
            text.push_str(&format!("  {count:>12}  {}\n", name.replace('_', " ")));
        }
    }
    text.push('\n');
    text
}

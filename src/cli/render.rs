//! `volref render SCENE|CASE|VOLUME -o FILE`

use super::failure::{Exit, Failure, bad_input};
use super::output::{self, Json};
use super::picture::Picture;
use super::suite::{NamedScene, named_scene};
use super::threads::Threads;
use super::{Outcome, progress};
use crate::film::{Depth, Film, FilmFormat};
use crate::math;
use crate::reference;
use crate::render::plan::{Kernel, Reason};
use crate::render::{self, Plan, Sampling, Seed};
use crate::scene::{Conventions, Length, Model, Origin, Reading, Scene, samples};
use crate::sensitivity::number;
use crate::volume::volume_format;
use serde_json::json;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Render a scene, or a volume file, to an image
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene file (TOML), a case of the suite, or a volume file
    scene: PathBuf,
    /// Image to write: .exr or .npy (linear radiance, 32-bit float), or .png (8-bit sRGB preview)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Samples per pixel, for Monte Carlo scenes; with 2 or more, an .exr also stores the variance of
    /// each pixel
    #[arg(long, value_name = "N", value_parser = samples)]
    spp: Option<u32>,
    /// Seed of the random numbers, for Monte Carlo scenes
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Distance between samples along a ray, instead of the scene's: world units, or "0.5 voxels";
    /// an integral without samples is then sampled
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    step: Option<Length>,
    /// Changes a parameter of the scene, such as density=0.1 for a tenth more (`volref sensitivity SCENE`
    /// lists them); may be repeated
    #[arg(long, value_name = "NAME=CHANGE", allow_hyphen_values = true, value_parser = change)]
    change: Vec<(String, f64)>,
    #[command(flatten)]
    threads: Threads,
    /// Exposure of a .png, in stops: radiance is multiplied by 2^STOPS [default: that of the case, else 0]
    #[arg(
        long,
        value_name = "STOPS",
        allow_hyphen_values = true,
        value_parser = output::stops
    )]
    exposure: Option<f64>,
    /// Use the plain reference renderers (src/reference): usually slower; every [radiative]
    /// scene is path traced
    #[arg(long)]
    reference: bool,
    /// Depth of each pixel as well, in world units: mean (weighted by opacity) or half (where opacity
    /// reaches 1/2), along the ray; or mean-along-view or half-along-view. In an .exr it is the channel
    /// Z; beside an .npy a second file, FILE.depth.npy
    #[arg(long, value_name = "KIND", num_args = 0..=1, require_equals = true, default_missing_value = "mean")]
    depth: Option<Depth>,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    picture: Picture,
}

/// Runs the command.
pub fn run(mut arguments: Arguments) -> Result<Outcome, Failure> {
    let NamedScene { file, exposure, .. } = named_scene(&arguments.scene)?;
    arguments.scene = file;
    let exposure = arguments.exposure.or(exposure).unwrap_or(0.0);
    let is_volume = is_volume(&arguments.scene);
    if !is_volume {
        arguments.picture.refuse()?;
    }
    let format = format_of(&arguments.output, "linear radiance")?;
    let depth_file = arguments.depth_file(format)?;
    let outputs = [
        Some(arguments.output.as_path()),
        depth_file.as_deref(),
        arguments.picture.save_scene.as_deref(),
        arguments.json.file(),
    ];
    output::check(&outputs, &[&arguments.scene])?;
    let read = || match is_volume {
        true => arguments.picture.scene(&arguments.scene),
        false => Ok((Scene::load(&arguments.scene)?, String::new())),
    };
    let (scene, scene_text) = progress::during("reading the scene", read)?;
    output::check(&outputs, &[])?;
    let scene = arguments.changed(scene)?;
    let sampling = Sampling {
        samples: arguments.spp,
        seed: arguments.seed.map_or(Seed::OfScene, Seed::Given),
    };
    let start = Instant::now();
    let plans = render::plans(&scene);
    let film = arguments
        .threads
        .run(|| arguments.rendered(&scene, &plans, sampling))?
        .map_err(bad_input)?;
    let film = match arguments.depth {
        Some(depth) => film.with_depth(arguments.depths(&scene, depth)?),
        None => film,
    };
    let seconds = start.elapsed().as_secs_f64();

    arguments.write(&film, (format, exposure), depth_file.as_deref())?;
    arguments.picture.save(&scene_text)?;
    let mut text = format!(
        "{}: {} × {} pixels in {seconds:.2} s\n",
        arguments.output.display(),
        film.width(),
        film.height()
    );
    let warnings = warnings_of_all(&plans);
    let preview = (format == FilmFormat::Png).then_some(exposure);
    let mut notes = range_notes(&plans);
    notes.extend(warnings.iter().map(ToString::to_string));
    notes.extend(brightness_note(&film, &plans, preview));
    for note in notes {
        text.push_str(&format!("note: {note}\n"));
    }
    let mut value = json!({
        "schema": "volref/render/1",
        "scene": arguments.scene,
        "output": arguments.output,
        "width": film.width(),
        "height": film.height(),
        "hash": film.pixel_hash(),
        "seconds": seconds,
        "warnings": warnings,
    });
    if let Some(depth) = arguments.depth {
        let file = depth_file.as_deref().unwrap_or(&arguments.output);
        value["depth"] = json!({ "kind": depth.to_string(), "file": file });
    }
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

impl Arguments {
    /// The file of depths beside an image of this `format`, where it has one.
    fn depth_file(&self, format: FilmFormat) -> Result<Option<PathBuf>, Failure> {
        match (self.depth, format) {
            (None, _) | (Some(_), FilmFormat::Exr) => Ok(None),
            (Some(_), FilmFormat::Npy) => Ok(Some(self.output.with_extension("depth.npy"))),
            (Some(_), _) => {
                let message = "--depth: a .png holds no distances";
                let help =
                    "write .exr, with depth as its channel Z, or .npy, with depth in a second file";
                Err(Failure::new(Exit::BadInput, message, Some(help)))
            }
        }
    }

    /// Writes the image, and the file of its depths where it has one.
    fn write(
        &self,
        film: &Film,
        (format, exposure): (FilmFormat, f64),
        depth_file: Option<&Path>,
    ) -> Result<(), Failure> {
        let bytes = match format {
            FilmFormat::Png => film.to_png(exposure),
            FilmFormat::Npy => film.to_npy(),
            FilmFormat::Exr | FilmFormat::Pfm => film.to_exr().map_err(bad_input)?,
        };
        output::write(&self.output, &bytes)?;
        match (depth_file, film.depth_to_npy()) {
            (Some(file), Some(bytes)) => output::write(file, &bytes),
            _ => Ok(()),
        }
    }

    /// Depth of each pixel of `scene`.
    fn depths(&self, scene: &Scene, depth: Depth) -> Result<Vec<f32>, Failure> {
        let right =
            render::depth(scene, depth).map_err(|error| bad_input(format!("--depth: {error}")))?;
        if !self.reference {
            return Ok(right);
        }
        let panels = scene.panels.iter().filter_map(|panel| {
            let size = [panel.width, panel.height];
            let depths = reference::depth::render(panel.classified()?, size, depth);
            let grey = depths.into_iter().map(|depth| [depth; 3]).collect();
            Some(Film::new(size[0], size[1], grey))
        });
        let film = Film::side_by_side(&panels.collect::<Vec<_>>());
        Ok(film.radiance().iter().map(|depth| depth[0]).collect())
    }

    /// The `scene` with the step and the changes asked for.
    fn changed(&self, mut scene: Scene) -> Result<Scene, Failure> {
        if let Some(step) = self.step {
            set_step(&mut scene, step)?;
        }
        for (name, change) in &self.change {
            let number =
                number(&scene, name).map_err(|error| bad_input(format!("--change: {error}")))?;
            scene = number.changed(&scene, *change).ok_or_else(|| {
                bad_input(format!(
                    "--change: {name} cannot change by {change}: it would leave its domain"
                ))
            })?;
        }
        Ok(scene)
    }

    /// The image of `scene`, by the plain renderers if they are asked for and there are such.
    fn rendered(&self, scene: &Scene, plans: &[Plan], sampling: Sampling) -> Result<Film, String> {
        let bar = progress::image("rendering");
        if self.reference && plans.iter().all(has_plain_renderer) {
            let centres: Vec<bool> = plans.iter().map(|plan| !plan.is_sampled()).collect();
            reference::render(scene, sampling, &centres).map_err(|error| error.to_string())
        } else {
            let rendering = render::render(plans, sampling, &bar);
            let film = rendering.map(|rendering| rendering.film);
            film.map_err(|error| error.to_string())
        }
    }
}

/// Conventions of other renderers and the integral itself have one renderer, which is plain.
fn has_plain_renderer(plan: &Plan<'_>) -> bool {
    !matches!(
        &plan.panel.model,
        Model::Classified(scene)
            if scene.continuous || scene.conventions != Conventions::default()
    )
}

/// `NAME=CHANGE`
fn change(text: &str) -> Result<(String, f64), String> {
    let (name, change) = text
        .split_once('=')
        .ok_or("expected NAME=CHANGE, such as density=0.1")?;
    let change: f64 = change
        .parse()
        .map_err(|_| format!("{change:?} is not a number"))?;
    if !change.is_finite() {
        return Err("a change must be finite".to_owned());
    }
    Ok((name.to_owned(), change))
}

/// The warnings of the plans of all panels.
fn warnings_of_all<'p>(plans: &'p [Plan<'_>]) -> Vec<&'p Reason> {
    let warnings = plans[0].warnings.iter();
    warnings
        .filter(|warning| plans.iter().all(|plan| plan.warnings.contains(warning)))
        .collect()
}

/// A note on an image that is black, or too dark to be seen at the exposure of a `preview`.
fn brightness_note(film: &Film, plans: &[Plan<'_>], preview: Option<f64>) -> Option<String> {
    let values = film.radiance().as_flattened().iter().copied();
    let most = values.fold(0.0, f32::max);
    let stops = (-math::log2(most.into())).round();
    match plans {
        [plan] if most == 0.0 && matches!(plan.kernel, Kernel::Background(_)) => {
            Some(format!("the image is black: {}", plan.estimator.why.reason))
        }
        _ if most == 0.0 => {
            Some("the image is black: no ray reaches anything that emits light".to_owned())
        }
        _ if preview.is_some_and(|exposure| stops - exposure >= 2.0) => Some(format!(
            "the image is dark; --exposure {stops} shows it better"
        )),
        _ => None,
    }
}

/// Notes on the ranges of values that no scene states.
fn range_notes(plans: &[Plan<'_>]) -> Vec<String> {
    let readings = plans.iter().flat_map(|plan| &plan.panel.readings);
    let mut notes: Vec<String> = readings
        .filter_map(|Reading { key, value, origin }| match origin {
            Origin::Derived(rule) if key.ends_with("transfer_function.range") => Some(format!(
                "values are shown from {} by default ({rule}); state `range` in [transfer_function] to change that",
                value.trim_matches(['[', ']']).replace(", ", " to ")
            )),
            _ => None,
        })
        .collect();
    notes.dedup();
    notes
}

/// True of a volume file. A description of bare samples ends in .toml, as scenes do.
fn is_volume(path: &Path) -> bool {
    let is_toml = |ending: &OsStr| ending.eq_ignore_ascii_case("toml");
    !path.extension().is_some_and(is_toml) && volume_format(path).is_some()
}

/// The format of an image to be written, of linear `values`.
pub fn format_of(path: &Path, values: &str) -> Result<FilmFormat, Failure> {
    let is_written =
        |format: &FilmFormat| matches!(format, FilmFormat::Exr | FilmFormat::Npy | FilmFormat::Png);
    FilmFormat::of(path).filter(is_written).ok_or_else(|| {
        bad_input(format!(
            "{}: unknown image extension: use .exr or .npy ({values}), or .png (preview)",
            path.display()
        ))
    })
}

fn set_step(scene: &mut Scene, step: Length) -> Result<(), Failure> {
    let fail = |message: String| bad_input(format!("--step: {message}"));
    for panel in &mut scene.panels {
        match &mut panel.model {
            Model::Classified(classified) => {
                classified.sample();
                classified.set_step(step).map_err(fail)?;
            }
            Model::Curve(_) => return Err(fail("a plot of the curve has no steps".into())),
            Model::Radiative(_) => {
                return Err(fail(
                    "applies only to classified volumes: participating media are not ray marched"
                        .into(),
                ));
            }
        }
    }
    Ok(())
}

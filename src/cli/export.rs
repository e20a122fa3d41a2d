//! `volref export SCENE --to FORMAT -o DIR`

use super::Outcome;
use super::failure::{Exit, Failure};
use super::output::{self, Json};
use super::suite::named_scene;

use crate::exchange::{self, Export, Format, Refusal};
use crate::files::regular_file;
use crate::film::CHANNELS;
use crate::scene::Scene;
use serde_json::json;
use std::fs::Metadata;
use std::path::{Path, PathBuf};

/// Write a scene for another renderer
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene file (TOML), or a case of the suite
    scene: PathBuf,
    /// Format: mitsuba (3, XML), pbrt (v4), bundle (any scene as
    /// numbers and formulas); or the grid of a classified volume alone: raw, nrrd or npy
    #[arg(long, value_name = "FORMAT")]
    to: Format,
    /// Folder to write into; created if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    json: Json,
}

/// Runs the command.
pub fn run(mut arguments: Arguments) -> Result<Outcome, Failure> {
    let named = named_scene(&arguments.scene)?;
    arguments.scene = named.file;
    output::check(&[arguments.json.file()], &[&arguments.scene])?;
    let scene = Scene::load(&arguments.scene)?;
    output::check(&[arguments.json.file()], &[])?;
    let stem = arguments.scene.file_stem().unwrap_or_default();
    let format = arguments.to;
    let name = stem.to_string_lossy();
    let export = exchange::export(&scene, format, &name, named.exposure)?;
    let folder = &arguments.output;
    // Where it is yet to be made, none of its files is another.
    if folder.is_dir() {
        let files = export.files.iter().map(|(name, _)| folder.join(name));
        let files: Vec<PathBuf> = files.collect();
        let mut outputs = vec![arguments.json.file()];
        outputs.extend(files.iter().map(|file| Some(file.as_path())));
        output::check(&outputs, &[])?;
        check_no_other(&export, folder, &arguments.scene)?;
    }
    export.write_into(folder).map_err(|error| {
        let message = format!("cannot write into {}: {error}", folder.display());
        let help = "nothing was written; give a folder that can be created or written to";
        Failure::new(Exit::BadInput, message, Some(help))
    })?;
    let commands = commands(format, folder, &export);
    let mut text = String::new();
    for (name, bytes) in &export.files {
        let path = folder.join(name);
        text.push_str(&format!("{}: {} bytes\n", path.display(), bytes.len()));
    }
    if !commands.is_empty() {
        text.push_str("\nto render it:\n");
    }
    for command in &commands {
        text.push_str(&format!("  {command}\n"));
    }
    let is_grid = matches!(format, Format::Raw | Format::Nrrd | Format::Npy);
    let map = scene.panels[0]
        .classified()
        .filter(|_| is_grid)
        .and_then(|volume| volume.to_world);
    let mut value = json!({
        "schema": "volref/export/1",
        "scene": arguments.scene,
        "format": format.to_string(),
        "folder": folder,
        "main": export.main,
        "files": export.files.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        "commands": commands,
    });
    if let Some(map) = map {
        value["transform"] = json!(map.rows());
    }
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

/// Fails if a file in `folder` that the export would replace holds something else: another scene of the same name, or a
/// file of the user's. A file that is no younger than the scene is out of date, and of this scene for all that is known.
fn check_no_other(export: &Export, folder: &Path, scene: &Path) -> Result<(), Failure> {
    let changed = |file: Metadata| file.modified().ok();
    let of_scene = scene.metadata().ok().and_then(changed);
    for (name, bytes) in &export.files {
        let path = folder.join(name);
        let Some(found) = path.metadata().ok().filter(Metadata::is_file) else {
            continue;
        };
        let is_same = || {
            let found = regular_file::read(&path, bytes.len() as u64);
            found.is_ok_and(|found| found == *bytes)
        };
        if is_same() || changed(found) <= of_scene {
            continue;
        }
        let [path, scene] = [&path, scene].map(Path::display);
        let message = format!("{path} is there already, and is not this export of {scene}");
        let help = "nothing was written; give another folder, or remove that file first";
        return Err(Failure::new(Exit::BadInput, message, Some(help)));
    }
    Ok(())
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Failure {
        let help = "nothing was written; remove these features from the scene or replace them";
        Failure::new(Exit::BadInput, refusal.to_string(), Some(help))
    }
}

/// Command lines of the other renderer.
fn commands(format: Format, folder: &Path, export: &Export) -> Vec<String> {
    let quoted = |name: &str| {
        let path = folder.join(name).display().to_string();
        shell_words::quote(&path).into_owned()
    };
    let names = || export.files.iter().map(|(name, _)| name.as_str());
    match format {
        Format::Mitsuba => {
            let (stem, main) = (export.main.trim_end_matches(".xml"), quoted(&export.main));
            let command = |channel| {
                format!("mitsuba -m scalar_rgb -Dchannel={channel} -o {stem}.{channel}.exr {main}")
            };
            let split = format!("{stem}.red.xml");
            match names().any(|name| name == split) {
                true => CHANNELS.map(command).to_vec(),
                false => vec![format!("mitsuba -m scalar_rgb -o {stem}.exr {main}")],
            }
        }
        Format::Pbrt => names()
            .filter(|name| name.ends_with(".pbrt"))
            .map(|name| format!("pbrt {}", quoted(name)))
            .collect(),
        Format::Bundle | Format::Raw | Format::Nrrd | Format::Npy => Vec::new(),
    }
}

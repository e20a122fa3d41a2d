//! The options of `volref render` for volume files, and the scene that they make.

use super::failure::{Exit, Failure, bad_input};
use super::{output, progress};
use crate::files::atomic_file::directory_of;
use crate::optics::Colormap;
use crate::scene::{Recipe, Scene};
use clap::builder::PossibleValuesParser;
use std::path::{Component, Path, PathBuf};

/// Options of pictures of volume files.
#[derive(Debug, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "For a volume file")]
pub struct Picture {
    /// What a pixel shows
    #[arg(long, value_parser = ["composite", "maximum", "minimum", "mean", "sum", "attenuated-maximum", "isosurface"])]
    mode: Option<String>,
    /// Colours of the values [default: bone; inferno if much of the volume is 0; display-grey for projections]
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(Colormap::NAMES))]
    colormap: Option<String>,
    /// Values of the first and last colour [default: 1st and 99.9th percentile]
    #[arg(long, value_name = "LO,HI", allow_hyphen_values = true, value_parser = range)]
    range: Option<[f64; 2]>,
    /// Distances between nodes, in place of those of the file
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = spacing)]
    spacing: Option<[f64; 3]>,
    /// Size of the image, pixels: one number, or WxH [default: 512]
    #[arg(long, value_name = "N|WxH", value_parser = size)]
    size: Option<[u64; 2]>,
    /// Angle of the eye about the vertical, from the front towards the right, degrees [default: 30; for
    /// projections 0; of RAS+ scans 180 more]
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true, value_parser = degrees)]
    azimuth: Option<f64>,
    /// Angle of the eye above the horizon, degrees [default: 20; for projections 0]
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true, value_parser = degrees)]
    elevation: Option<f64>,
    /// Scene to write, which renders this image
    #[arg(long, value_name = "FILE")]
    pub save_scene: Option<PathBuf>,
}

impl Picture {
    /// Refuses options that say nothing of a scene.
    pub fn refuse(&self) -> Result<(), Failure> {
        if *self == Picture::default() {
            return Ok(());
        }
        let message = "--mode, --colormap, --range, --spacing, --size, --azimuth, --elevation and --save-scene are for \
                       volume files: a scene states all that it shows";
        let help = "change the key in a copy of the scene: `volref plan` shows them all";
        Err(Failure::new(Exit::BadInput, message, Some(help)))
    }

    /// The scene of the volume at `path`, and its text.
    pub fn scene(&self, path: &Path) -> Result<(Scene, String), Failure> {
        let mode = self.mode.clone().filter(|mode| mode != "composite");
        if mode.as_deref() == Some("attenuated-maximum") && self.colormap.is_some() {
            let message = "--colormap: `attenuated-maximum` is shown in greys alone";
            let help = "leave the option out, or use `--mode maximum`";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
        let recipe = Recipe {
            mode,
            colormap: self.colormap.clone(),
            range: self.range,
            spacing: self.spacing,
            size: self.size,
            azimuth: self.azimuth,
            elevation: self.elevation,
        };
        let beside = PathBuf::from(format!("{} (as a scene)", path.display()));
        let scene = self.save_scene.as_deref().unwrap_or(&beside);
        let file = seen_from(directory_of(scene), path);
        let file = file.to_str().ok_or_else(|| {
            bad_input(format!("{}: a scene names files in UTF-8", path.display()))
        })?;
        let (text, replaced) = recipe.text(path, file).map_err(bad_input)?;
        if let Some(value) = replaced {
            let path = path.display();
            progress::note(&format!(
                "{path}: values that are not finite are shown as {value}, the smallest"
            ));
        }
        Ok((Scene::parse(&text, scene)?, text))
    }

    /// Writes the scene, if asked to.
    pub fn save(&self, text: &str) -> Result<(), Failure> {
        match &self.save_scene {
            Some(file) => output::write(file, text.as_bytes()),
            None => Ok(()),
        }
    }
}

/// The file at `path` as seen from `folder`: below it, or through as few `..` as need be.
fn seen_from(folder: &Path, path: &Path) -> PathBuf {
    let parent = directory_of(path).canonicalize();
    let (Ok(folder), Ok(parent), Some(name)) = (folder.canonicalize(), parent, path.file_name())
    else {
        return path.to_owned();
    };
    let (from, to): (Vec<_>, Vec<_>) =
        (folder.components().collect(), parent.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from[shared..].iter().map(|_| Component::ParentDir);
    let seen: PathBuf = up.chain(to[shared..].iter().copied()).collect();
    seen.join(name)
}

fn numbers<const N: usize>(text: &str, expected: &str) -> Result<[f64; N], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|it| it.trim().parse()).collect();
    let numbers: Option<[f64; N]> = numbers.ok().and_then(|it| it.try_into().ok());
    let finite = numbers.filter(|it| it.iter().all(|number| number.is_finite()));
    finite.ok_or_else(|| format!("expected {expected}"))
}

fn range(text: &str) -> Result<[f64; 2], String> {
    let [low, high] = numbers(text, "two numbers with a comma between, such as -1000,800")?;
    if low < high {
        return Ok([low, high]);
    }
    Err(format!(
        "the range from {low} to {high} is empty: give the smaller number first"
    ))
}

fn degrees(text: &str) -> Result<f64, String> {
    numbers(text, "a number of degrees, such as -30").map(|[degrees]| degrees)
}

fn spacing(text: &str) -> Result<[f64; 3], String> {
    let expected = "three numbers above 0 with commas between, such as 0.5,0.5,2";
    let spacing: [f64; 3] = numbers(text, expected)?;
    if spacing.iter().all(|&along| along > 0.0) {
        return Ok(spacing);
    }
    Err(format!("expected {expected}"))
}

fn size(text: &str) -> Result<[u64; 2], String> {
    let parts: Vec<&str> = text.split(['x', 'X', '×']).collect();
    let pixels = |part: &str| {
        part.parse()
            .ok()
            .filter(|count| (1..=MOST_PIXELS).contains(count))
    };
    let size = match parts[..] {
        [side] => pixels(side).map(|side| [side; 2]),
        [width, height] => pixels(width).zip(pixels(height)).map(|(w, h)| [w, h]),
        _ => None,
    };
    size.ok_or_else(|| {
        format!("expected a number of pixels from 1 to {MOST_PIXELS}, or two, such as 640x480")
    })
}

/// Most columns or rows of an image, as of [film] in a scene.
const MOST_PIXELS: u64 = 16384;

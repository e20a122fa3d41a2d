//! `volref sensitivity SCENE --of NAME -o FILE`

use super::failure::{Failure, bad_input};
use super::output::{self, Json};
use super::render::format_of;
use super::suite::named_scene;
use super::threads::Threads;
use super::{Outcome, progress};
use crate::film::{Film, FilmFormat};
use crate::render::Detail;
use crate::report::{signed_colour, widest};
use crate::scene::{Scene, samples};
use crate::sensitivity::{Differences, Number, derivative, number, numbers};
use crate::suite::sensitivities_of;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Differentiate the image of a scene by one of its parameters
///
/// Writes the derivative per unit of change, with its variance; without --of, lists the
/// parameters. A change is a share of the parameter itself (0.01 is one per cent) or in the unit
/// that the list states.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// Scene file (TOML), or a case of the suite
    scene: PathBuf,
    /// Parameter to differentiate by, such as density or reflectance.2
    #[arg(long, value_name = "NAME", requires = "output")]
    of: Option<String>,
    /// Image to write: .exr or .npy (32-bit float; .exr with variance), or .png (red is brighter,
    /// blue darker as the parameter grows)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// For Monte Carlo scenes: samples per pixel of each of the two sides
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = samples)]
    spp: u32,
    /// For Monte Carlo scenes: pairs of renderings with seeds of their own, from whose spread the
    /// variance is estimated
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(2..=1024))]
    pairs: u32,
    /// Seed of the random numbers of the first pair; the others have the next ones
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Change on either side of the parameter, instead of the one that the list states
    #[arg(long, value_name = "CHANGE", allow_hyphen_values = true, value_parser = positive)]
    step: Option<f64>,
    /// Instead of an image: derivatives of blocks of 8 x 8 pixels by all parameters, as a suite
    /// keeps them in golden/sensitivities
    #[arg(long, conflicts_with = "of", requires = "output")]
    all: bool,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    json: Json,
}

/// Seeds of the numbers that make golden/sensitivities: no golden and no rendering uses them.
const SEED_OF_SUITE: u64 = 0x7365_6e73_6974_0000;

fn positive(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    (number > 0.0 && number.is_finite())
        .then_some(number)
        .ok_or_else(|| "a change must be above 0".to_owned())
}

/// Runs the command.
pub fn run(mut arguments: Arguments) -> Result<Outcome, Failure> {
    arguments.scene = named_scene(&arguments.scene)?.file;
    let outputs = [arguments.output.as_deref(), arguments.json.file()];
    output::check(&outputs, &[&arguments.scene])?;
    let scene = progress::during("reading the scene", || Scene::load(&arguments.scene))?;
    let Some(path) = &arguments.output else {
        return listed(&arguments, &scene);
    };
    if arguments.all {
        return of_all(&arguments, &scene);
    }
    let Some(name) = &arguments.of else {
        return Err(bad_input(
            "-o FILE needs --of NAME: which parameter? Without both, the parameters are listed",
        ));
    };
    let number = number(&scene, name).map_err(bad_input)?;
    let format = format_of(path, "derivatives")?;
    let differences = Differences {
        detail: Detail::Whole,
        samples: arguments.spp.max(arguments.pairs),
        pairs: arguments.pairs,
        seed: arguments.seed,
        step: arguments.step,
    };
    let start = Instant::now();
    let differentiate = || derivative(&scene, &number, &differences, &|| false);
    let found = arguments
        .threads
        .run(|| progress::during("differentiating", differentiate))?
        .map_err(bad_input)?;
    let Some(found) = found else {
        let step = arguments.step.unwrap_or(number.step);
        let step = format!("{step} {}", unit(&number));
        return Err(bad_input(format!(
            "{name} can neither be larger nor smaller by {}: choose a smaller --step",
            step.trim_end()
        )));
    };
    let bytes = match format {
        FilmFormat::Png => in_red_and_blue(&found.film),
        FilmFormat::Npy => found.film.to_npy(),
        FilmFormat::Exr | FilmFormat::Pfm => found.film.to_exr().map_err(bad_input)?,
    };
    output::write(path, &bytes)?;
    let [mean, error] = mean_and_error(&found.film);
    let mut text = format!(
        "{}: derivative by {name}, {} × {} pixels in {:.2} s\n\
         mean over the image: {mean:.4e}{}, error {error:.1e}\n",
        path.display(),
        found.film.width(),
        found.film.height(),
        start.elapsed().as_secs_f64(),
        per_unit(&number),
    );
    if found.unsettled > 0 {
        text.push_str(&format!(
            "note: {} pixels have no derivative: an edge crosses them as {name} changes, or their values jump; their \
             variance says so\n",
            found.unsettled
        ));
    }
    let value = json!({
        "schema": "volref/sensitivity/1",
        "scene": arguments.scene,
        "output": path,
        "of": name,
        "unit": unit(&number),
        "step": found.step,
        "central": found.is_central,
        "unsettled_pixels": found.unsettled,
        "mean": mean,
        "mean_error": error,
        "width": found.film.width(),
        "height": found.film.height(),
        "hash": found.film.pixel_hash(),
    });
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

/// The mean of all channels and pixels, and its error, as if pixels were independent.
fn mean_and_error(film: &Film) -> [f64; 2] {
    let count = (3 * film.radiance().len()) as f64;
    let sum = |pixels: &[[f32; 3]]| -> f64 {
        let values = pixels.as_flattened().iter();
        values.map(|&value| f64::from(value)).sum()
    };
    let variance = film.noise().map_or(0.0, |noise| sum(noise.variance()));
    [sum(film.radiance()) / count, variance.sqrt() / count]
}

/// `world units`; empty for a share or a bare number.
fn unit(number: &Number) -> &'static str {
    number.unit.unwrap_or("of itself")
}

fn per_unit(number: &Number) -> String {
    match number.unit {
        None => " per 100 % of the parameter".to_owned(),
        Some("") => " per 1".to_owned(),
        Some(unit) => format!(" per {}", unit.trim_end_matches('s')),
    }
}

fn listed(arguments: &Arguments, scene: &Scene) -> Result<Outcome, Failure> {
    let numbers = numbers(scene);
    let width = widest(numbers.iter().map(Number::name));
    let (mut text, mut entries) = (String::new(), Vec::new());
    for number in &numbers {
        let (name, words, unit) = (number.name(), number.words(), unit(number));
        let step = format!("{:.4}", number.step);
        let step = step.trim_end_matches('0').trim_end_matches('.');
        let line = format!("{name:width$}  {words}; step {step} {unit}");
        text.push_str(&format!("{}\n", line.trim_end()));
        entries.push(json!({ "name": name, "words": words, "unit": unit, "step": number.step }));
    }
    if numbers.is_empty() {
        text.push_str("a plot has no parameters to differentiate by\n");
    }
    let value = json!({
        "schema": "volref/sensitivity/1",
        "scene": arguments.scene,
        "numbers": entries,
    });
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

fn of_all(arguments: &Arguments, scene: &Scene) -> Result<Outcome, Failure> {
    let path = arguments.output.as_deref().expect("checked by the parser");
    let start = Instant::now();
    let (spp, pairs) = (arguments.spp, arguments.pairs);
    let differentiate = || sensitivities_of(scene, spp, pairs, SEED_OF_SUITE, &|| false);
    let layered = arguments
        .threads
        .run(|| progress::during("differentiating", differentiate))?
        .map_err(bad_input)?;
    output::write(path, &layered.to_exr().map_err(bad_input)?)?;
    let text = format!(
        "{}: derivatives by {} parameters in {:.0} s\n",
        path.display(),
        layered.layers.len(),
        start.elapsed().as_secs_f64()
    );
    let value = json!({
        "schema": "volref/sensitivity/1",
        "scene": arguments.scene,
        "output": path,
        "numbers": layered.layers.iter().map(|(name, _)| name).collect::<Vec<_>>(),
    });
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

/// PNG pixels: white where nothing changes, red where the image becomes brighter, blue where
/// darker; full colour at the size that one pixel in a hundred exceeds.
fn in_red_and_blue(film: &Film) -> Vec<u8> {
    let means = film
        .radiance()
        .iter()
        .map(|pixel| pixel.iter().sum::<f32>() / 3.0);
    let means: Vec<f64> = means.map(f64::from).collect();
    let mut sizes: Vec<f64> = means.iter().map(|mean| mean.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let full = sizes[(sizes.len() - 1) * 99 / 100].max(f64::MIN_POSITIVE);
    let colour = |mean: &f64| signed_colour(mean / full);
    let codes: Vec<[u8; 3]> = means.iter().map(colour).collect();
    Film::codes_to_png(&codes, film.width(), film.height())
}

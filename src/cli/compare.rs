//! `volref compare REFERENCE TEST`

use super::Outcome;
use super::command_line::command_line;
use super::failure::{Exit, Failure, bad_input};
use super::output::{self, Json};
use super::page::ReportPage;
use crate::compare::flip::{DEFAULT_PIXELS_PER_DEGREE, flip, magma};
use crate::compare::{
    Conditions, GATES, Gate, Picture, Promise, default_gate, gate_named, judge, precision_in_words,
    recognised,
};
use crate::film::{Bits, Film, FilmFormat};
use crate::judging::{CaseResult, Evidence, radiance};
use crate::naming::Diagnosis;
use crate::report::{self, Page};
use crate::suite::MEAN_RESOLUTION;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Compare two images
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The correct image: .exr, .pfm or .npy (linear radiance) or .png (8-bit sRGB)
    reference: PathBuf,
    /// The image to check
    test: PathBuf,
    // `help` lists the gates.
    #[arg(long, value_name = "GATE", value_parser = gate_named, help = gates_help())]
    gate: Option<Gate>,
    /// The stochastic gate passes an image only if a bias this large would have been detected, in
    /// percent of (image mean + 0.001); noisier images are inconclusive (exit code 5)
    #[arg(
        long,
        value_name = "PERCENT",
        default_value_t = 100.0 * MEAN_RESOLUTION,
        allow_negative_numbers = true,
        value_parser = percent
    )]
    resolution: f64,
    /// Bits of a channel in TEST: 8, 8-linear or 8-srgb. Differences up to half a code agree then; a PNG holds codes
    /// of radiance at --exposure
    #[arg(long, value_name = "BITS")]
    bits: Option<Bits>,
    /// Exposure applied to linear images, in stops, for the perceptual gate, the heat map and
    /// codes of 8 bits
    #[arg(
        long,
        value_name = "STOPS",
        default_value_t = 0.0,
        allow_hyphen_values = true,
        value_parser = output::stops
    )]
    exposure: f64,
    /// Write an image of the perceived difference (FLIP): black where equal, bright where different
    #[arg(long, value_name = "FILE.png")]
    heatmap: Option<PathBuf>,
    #[command(flatten)]
    page: ReportPage,
    #[command(flatten)]
    json: Json,
}

/// A percentage above 0 and below 100.
pub fn percent(text: &str) -> Result<f64, String> {
    let expected = "a resolution is a percentage above 0 and below 100";
    output::number(text, |it| it > 0.0 && it < 100.0, expected)
}

/// Names of the gates, and the pairs of images for which each is the default.
fn gates_help() -> String {
    let default = |gate: Gate| {
        Some(format!(
            "{} for {}",
            gate.name(),
            gate.description().default_for?
        ))
    };
    let defaults: Vec<String> = GATES.into_iter().filter_map(default).collect();
    let names = GATES.map(Gate::name).join(", ");
    format!("{names} [default: {}]", defaults.join("; "))
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let start = Instant::now();
    let is_png = |path: &&PathBuf| FilmFormat::of(path) == Some(FilmFormat::Png);
    if let Some(path) = arguments.heatmap.as_ref().filter(|path| !is_png(path)) {
        let message = format!("--heatmap writes a .png, not {}", path.display());
        return Err(bad_input(message));
    }
    arguments.page.check()?;
    output::check(
        &[
            arguments.json.file(),
            arguments.heatmap.as_deref(),
            arguments.page.file().as_deref(),
        ],
        &[&arguments.reference, &arguments.test],
    )?;
    // The reference first: where both are unreadable, its exit code is the one that counts.
    let reference = Picture::read(&arguments.reference).map_err(bad_input)?;
    let test = Picture::read(&arguments.test)
        .map_err(|error| Failure::new(Exit::OtherRenderer, error.to_string(), None))?;
    let test = arguments.with_bits(&reference, test)?;
    let (gate, why) = match arguments.gate {
        Some(gate) => (gate, ""),
        None => default_gate(&reference, &test),
    };
    let conditions = Conditions {
        exposure: arguments.exposure,
        promise: Some(Promise::of_mean(arguments.resolution / 100.0)),
        ..Conditions::default()
    };
    let judgement = judge(gate, &reference, &test, &conditions).map_err(bad_input)?;
    let mut note = "";
    if let Some(path) = &arguments.heatmap {
        if reference.size() == test.size() {
            output::write(path, &heatmap(&reference, &test, arguments.exposure)?)?;
        } else {
            note = "\nno heat map: the images differ in size\n";
        }
    }
    let mut result = CaseResult {
        name: arguments.test.to_string_lossy().into_owned(),
        gate,
        seconds: start.elapsed().as_secs_f64(),
        ..CaseResult::from(judgement)
    };
    let film = test.radiance();
    let hidden = film.and_then(|film| precision_in_words(result.gate, &result.metrics, film));
    result.notes.extend(hidden);
    let verdict = result.verdict.name();
    let mut text = format!(
        "{verdict}  ({} gate{why})\n{}\n",
        gate.name(),
        result.reason
    );
    for note in &result.notes {
        text.push_str(&format!("note: {note}\n"));
    }
    text.push_str(&metrics(&result));
    text.push_str(note);
    let exit = result.cause.into();
    let json = report::results_json("compare", std::slice::from_ref(&result));
    let page = Page {
        title: "volref compare",
        command: &command_line(),
        judged_with: "",
        results: &[result],
        evidence: &[arguments.evidence(reference, test)],
        found: &Diagnosis::default(),
    };
    arguments.page.write(&page, &mut text)?;
    let text = arguments.json.instead_of(text, &json)?;
    Ok(Outcome { text, exit })
}

impl Arguments {
    /// Both images, for a page.
    fn evidence(&self, reference: Picture, test: Picture) -> Evidence {
        let fact = |name: &str, path: &Path| (name.to_owned(), path.display().to_string());
        Evidence {
            golden: Some(reference.film(self.exposure)),
            test: Some(test),
            exposure: self.exposure,
            provenance: vec![
                fact("golden", &self.reference),
                fact("test image", &self.test),
            ],
            reproduce: vec![command_line()],
            ..Evidence::default()
        }
    }

    /// `test` with its bits, declared or recognised.
    fn with_bits(&self, reference: &Picture, test: Picture) -> Result<Picture, Failure> {
        let Picture::Radiance(golden) = reference else {
            if self.bits.is_some() {
                let message = "--bits needs a reference of linear radiance, and this one is a .png";
                let help = "leave --bits out: two images of 8 bits are compared by how they look";
                return Err(Failure::new(Exit::BadInput, message, Some(help)));
            }
            return Ok(test);
        };
        // Volref's own images, which are compared by every bit, are not rounded unless somebody says so.
        let is_exact = self.gate == Some(Gate::Exact);
        Ok(match (self.bits, test) {
            (Some(bits), test) => {
                let film = radiance(test, bits, self.exposure);
                let in_file = |error| bad_input(format!("{}: {error}", self.test.display()));
                Picture::Radiance(film.map_err(in_file)?)
            }
            (None, Picture::Radiance(film)) if !is_exact => {
                Picture::Radiance(recognised(golden, film, self.exposure))
            }
            (None, test) => test,
        })
    }
}

/// A line for each metric.
fn metrics(result: &CaseResult) -> String {
    let mut text = String::new();
    if !result.metrics.is_empty() {
        text.push('\n');
    }
    let widest = report::widest(result.metrics.keys());
    for (name, value) in &result.metrics {
        let value = match value.abs() {
            size if size != 0.0 && !(1e-6..1e9).contains(&size) => format!("{value:e}"),
            _ => value.to_string(),
        };
        text.push_str(&format!("  {name:<widest$}  {value}\n"));
    }
    text
}

/// The perceived difference of two images of one size as PNG.
pub fn heatmap(reference: &Picture, test: &Picture, exposure: f64) -> Result<Vec<u8>, Failure> {
    let srgb = |picture: &Picture| picture.srgb(exposure).map_err(bad_input);
    let errors = flip(&srgb(reference)?, &srgb(test)?, DEFAULT_PIXELS_PER_DEGREE)
        .map_err(|error| bad_input(format!("no heat map: {error}")))?;
    let (width, height) = reference.size();
    Ok(Film::codes_to_png(&magma(&errors), width, height))
}

//! Options of the renderer that `volref validate --run` calls, or `--serve` starts.

use super::failure::{Exit, Failure, bad_input};
use super::output::number;
use crate::renderers::{
    CallSettings, CommandTemplate, OtherRenderer, RendererOptions, hashes_of_files,
};
use std::path::PathBuf;
use std::time::Duration;

/// Default options, as text.
const TIMEOUT: &str = "600";
const SPP: &str = "64";
const SEED: &str = "1";
const BUDGET: &str = "10m";
const FORMAT: &str = "exr";

/// Command of a renderer: called for each case, or started once.
#[derive(Clone, Copy)]
pub struct Command<'c> {
    /// Its words, with placeholders.
    pub text: &'c str,
    /// It stays.
    pub stays: bool,
}

/// Options of a renderer that is run.
#[derive(Debug, clap::Args)]
pub struct RendererArguments {
    /// Time limit of an image, after which the renderer is killed with its process group
    #[arg(long, value_name = "SECONDS", default_value = TIMEOUT, allow_negative_numbers = true, value_parser = seconds)]
    timeout: f64,
    /// Number of cases rendered at the same time
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    pub jobs: u16,
    /// Samples per pixel, {spp}
    #[arg(long, value_name = "N", default_value = SPP, value_parser = crate::scene::samples)]
    spp: u32,
    /// Seed, {seed}
    #[arg(long, value_name = "N", default_value = SEED)]
    seed: u64,
    /// Image format of {output}: exr, pfm, npy or png
    #[arg(long, value_name = "EXT", default_value = FORMAT, value_parser = OtherRenderer::FORMATS)]
    pub format: String,
    /// Render cases that noise leaves open again, with other seeds and more samples, until
    /// each passes or fails, or the budget is spent; all these looks together raise a false alarm no more
    /// often than one
    #[arg(long, requires = "renderer", conflicts_with = "outputs")]
    pub decide: bool,
    /// With --decide: time for the further renderings of all cases, such as 90s, 10m or 2h
    #[arg(long, value_name = "TIME", default_value = BUDGET, allow_hyphen_values = true, requires = "decide", value_parser = budget)]
    pub budget: Duration,
}

impl RendererArguments {
    /// The renderer that `command` calls; its images are kept in the folder `keep`, beside the names of all cases.
    pub fn renderer(
        &self,
        command: Command<'_>,
        keep: Option<(PathBuf, Vec<String>)>,
    ) -> Result<OtherRenderer, Failure> {
        let (template, help) = match command.stays {
            true => (
                CommandTemplate::parse_serving(command.text),
                "for example: --serve 'my-renderer --serve {scene} {spp}'",
            ),
            false => (
                CommandTemplate::parse(command.text),
                "for example: --run 'my-renderer {scene} --out {output} --spp {spp}'",
            ),
        };
        let template = template.map_err(|error| Failure::new(Exit::BadInput, error, Some(help)))?;
        let (spp, seed) = (self.spp, self.seed);
        let options = RendererOptions {
            template,
            stays: command.stays,
            first: CallSettings { spp, seed },
            format: self.format.clone(),
            timeout: Duration::from_secs_f64(self.timeout),
            keep,
        };
        OtherRenderer::new(options).map_err(bad_input)
    }

    /// Settings that the images of `command` depend on, by name: the files that it names are hashed, so that another
    /// build of the renderer makes another run.
    pub fn settings(&self, command: Command<'_>) -> Vec<(&'static str, String)> {
        let name = match command.stays {
            true => "command of the renderer that stays",
            false => "command of the renderer",
        };
        vec![
            (name, command.text.to_owned()),
            ("files of the renderer", hashes_of_files(command.text)),
            ("samples", self.spp.to_string()),
            ("seed", self.seed.to_string()),
            ("format", self.format.clone()),
            ("decide", self.decide.to_string()),
        ]
    }

    /// The words that repeat the run of `command`, without those that equal their defaults.
    pub fn words(&self, command: Command<'_>) -> Vec<String> {
        let flag = if command.stays { "--serve" } else { "--run" };
        let mut words = vec![flag.to_owned(), command.text.to_owned()];
        let mut say = |name: &str, value: String, default: &str| {
            if value != default {
                words.extend([name.to_owned(), value]);
            }
        };
        say("--spp", self.spp.to_string(), SPP);
        say("--seed", self.seed.to_string(), SEED);
        say("--format", self.format.clone(), FORMAT);
        say("--timeout", self.timeout.to_string(), TIMEOUT);
        if self.decide {
            words.push("--decide".to_owned());
            if self.budget != budget(BUDGET).unwrap_or_default() {
                let seconds = format!("{}s", self.budget.as_secs());
                words.extend(["--budget".to_owned(), seconds]);
            }
        }
        words
    }
}

/// A time limit: positive and finite.
pub fn seconds(text: &str) -> Result<f64, String> {
    let expected = "a time limit is a positive number of seconds";
    number(text, |it| it > 0.0 && it <= 1e9, expected)
}

/// A time in words: `10m`, `90s`, `1h`; a number alone is seconds.
fn budget(text: &str) -> Result<Duration, String> {
    let expected = || "a budget is a time such as 90s, 10m or 2h".to_owned();
    let (number, unit) = match text.char_indices().last() {
        Some((at, 's')) => (&text[..at], 1.0),
        Some((at, 'm')) => (&text[..at], 60.0),
        Some((at, 'h')) => (&text[..at], 3600.0),
        _ => (text, 1.0),
    };
    let seconds = unit * number.parse::<f64>().map_err(|_| expected())?;
    match seconds {
        seconds if (0.0..=1e9).contains(&seconds) => Ok(Duration::from_secs_f64(seconds)),
        _ => Err(expected()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_times() {
        for (text, seconds) in [
            ("90s", 90),
            ("10m", 600),
            ("0.5h", 1800),
            ("7", 7),
            ("0", 0),
        ] {
            assert_eq!(budget(text), Ok(Duration::from_secs(seconds)), "{text}");
        }
        for text in ["", "m", "-1s", "10 minutes", "NaN", "inf", "1d", "1e300h"] {
            assert!(budget(text).is_err(), "{text}");
        }
    }
}

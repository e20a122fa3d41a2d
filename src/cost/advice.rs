//! Recommended settings.

use super::{Parameter, Sweep};
use serde::Serialize;

/// A recommended setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recommendation {
    /// Root mean square error wanted.
    pub error: f64,
    /// Recommendation in words.
    pub text: String,
    /// The command that renders it.
    pub command: Option<String>,
}

/// Errors that settings are recommended for.
pub const WANTED: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// A setting of `sweep` for each wanted error, and the command that renders `scene` with it.
pub fn recommendations(sweep: &Sweep, scene: &str) -> Vec<Recommendation> {
    let of = |error: f64| {
        let (text, setting) = text_and_setting(error, sweep);
        // Digits of the product that say nothing.
        let percent = (error * 1e8).round() / 1e6;
        Recommendation {
            error,
            text: format!("for an error of {percent} %: {text}"),
            command: setting.map(|value| command(sweep.parameter, value, scene)),
        }
    };
    WANTED.map(of).into()
}

/// A recommendation in words, and the setting.
fn text_and_setting(error: f64, sweep: &Sweep) -> (String, Option<f64>) {
    let parameter = sweep.parameter;
    // A setting counts only if all finer ones do as well: no lucky hits.
    let good = sweep.levels.iter().rev();
    let good = good.take_while(|level| level.error.l2 + sweep.reference.bound <= error);
    if let Some(level) = good.last() {
        return (in_sentence(parameter, level.value), Some(level.value));
    }
    let Some(finest) = sweep.levels.last() else {
        return (NO_TIME.to_owned(), None);
    };
    // Noise falls with the root of the samples, which no finer setting needs to be tried for.
    if parameter == Parameter::Samples {
        let samples = samples_for(sweep, error);
        if samples <= MOST_SAMPLES {
            let text = format!(
                "no measured setting is enough, up to {}; if noise continues to fall as the root of the samples, \
                 about {samples} samples will do",
                finest.setting
            );
            return (text, (samples <= MOST_ADVISED).then_some(samples));
        }
    }
    let text = match sweep.cut {
        Some(_) => NO_TIME.to_owned(),
        None => format!(
            "no setting of the sweep is fine enough; the last one is off by {:.1e}",
            finest.error.l2
        ),
    };
    (text, None)
}

/// Reason of a sweep that ended early.
const NO_TIME: &str = "no setting measured in the time given is fine enough";

/// Samples per pixel of a scene, at most: 2^31.
const MOST_SAMPLES: f64 = 2_147_483_648.0;

/// Largest number of samples that a command is given for: a day and more for a small image.
const MOST_ADVISED: f64 = 1e6;

/// Samples at which noise has fallen to `error`, if it falls as the root of them: by the middle one
/// of all settings, since a single one may have met a rare path.
fn samples_for(sweep: &Sweep, error: f64) -> f64 {
    let levels = sweep.levels.iter();
    let mut scaled: Vec<f64> = levels
        .map(|level| level.error.l2 * level.error.l2 * level.value)
        .collect();
    scaled.sort_unstable_by(f64::total_cmp);
    (scaled[scaled.len() / 2] / (error * error)).round()
}

/// `steps of 0.5 voxels`, `64 samples`.
fn in_sentence(parameter: Parameter, value: f64) -> String {
    let setting = parameter.words(value);
    match parameter {
        Parameter::Step => format!("steps of {setting}"),
        Parameter::ShadowStep => format!("shadow steps of {setting}"),
        Parameter::Samples => setting,
    }
}

fn command(parameter: Parameter, value: f64, scene: &str) -> String {
    let option = match parameter {
        Parameter::Samples => format!("--spp {value}"),
        _ => format!("--step \"{}\"", parameter.words(value)),
    };
    format!(
        "volref render {} -o image.exr {option}",
        shell_words::quote(scene)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::Level;
    use crate::cost::norms::Norms;
    use crate::cost::order::{ExpectedOrder, order};
    use crate::cost::{MeanWork, Reference};
    use crate::render::Event;

    /// Noise beyond what was measured is said to be so.
    #[test]
    fn what_was_not_measured_is_no_promise() {
        let level = |value: f64| Level {
            setting: Parameter::Samples.words(value),
            value,
            work: MeanWork::from([(Event::RandomDraw, 10.0 * value)]),
            error: Norms {
                l2: 0.79 / value.sqrt(),
                ..Norms::default()
            },
            time: None,
        };
        let sweep = Sweep {
            name: "samples",
            parameter: Parameter::Samples,
            own: 64.0,
            size: [16, 16],
            reference: Reference {
                method: "more samples".to_owned(),
                bound: 1e-3,
            },
            levels: [1.0, 16.0, 64.0].map(level).into(),
            order: order(Vec::new(), ExpectedOrder::OF_SAMPLES, 0.0),
            cut: None,
        };
        let (text, setting) = text_and_setting(1e-4, &sweep);
        assert_eq!(
            text,
            "no measured setting is enough, up to 64 samples; if noise continues to fall as the root of the \
             samples, about 62410000 samples will do"
        );
        assert_eq!(setting, None);
        let (text, setting) = text_and_setting(0.1, &sweep);
        assert_eq!(text, "64 samples");
        let command = command(Parameter::Samples, setting.unwrap(), "my fog.toml");
        assert_eq!(command, "volref render 'my fog.toml' -o image.exr --spp 64");
    }
}

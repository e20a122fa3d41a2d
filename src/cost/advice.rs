//! Recommended settings.

use super::{Level, Parameter, Sweep};
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
        let setting = in_sentence(parameter, level.value);
        let relative = relative(sweep, level.work.price());
        return (format!("{setting}{relative}"), Some(level.value));
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
                 about {} samples will do{}",
                finest.setting,
                in_words(samples),
                relative(sweep, finest.work.price() * samples / finest.value)
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

/// Work beside that of the scene's own setting, in words.
fn relative(sweep: &Sweep, price: f64) -> String {
    let own = in_sentence(sweep.parameter, sweep.own);
    let times = price_at(sweep, sweep.own).map(|own| price / own);
    match times.filter(|times| times.is_finite()) {
        // The settings of a sweep are not the scene's own to the last digit.
        Some(times) if (times - 1.0).abs() < 0.02 => format!(", the scene's own {own}"),
        Some(times) => {
            let times = in_words(times);
            format!(", {times} times the work of the scene's own {own}")
        }
        None => String::new(),
    }
}

/// Samples at which noise has fallen to `error`, if it falls as the root of them: by the middle one
/// of all settings, since a single one may have met a rare path.
fn samples_for(sweep: &Sweep, error: f64) -> f64 {
    let levels = sweep.levels.iter();
    let mut scaled: Vec<f64> = levels
        .map(|level| level.error.l2 * level.error.l2 * level.value)
        .collect();
    scaled.sort_unstable_by(f64::total_cmp);
    (scaled[scaled.len() / 2] / (error * error)).ceil()
}

/// Lookups at a setting, from those of the nearest measured one: nearly proportional to the
/// setting, or inversely so.
fn price_at(sweep: &Sweep, value: f64) -> Option<f64> {
    let far = |level: &&Level| (level.value / value).max(value / level.value);
    let levels = sweep.levels.iter();
    let nearest = levels.min_by(|a, b| far(a).total_cmp(&far(b)))?;
    let share = match sweep.parameter {
        Parameter::Samples => value / nearest.value,
        _ => nearest.value / value,
    };
    Some(nearest.work.price() * share)
}

/// A count or a ratio with two or three digits that say something.
fn in_words(number: f64) -> String {
    match number {
        _ if number < 0.01 => format!("{number:.0e}"),
        _ if number < 9.995 => format!("{number:.2}")
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned(),
        _ if number < 99.95 => format!("{number:.1}").trim_end_matches(".0").to_owned(),
        _ if number < 999_999.5 => format!("{number:.0}"),
        _ if number < 999.5e6 => format!("{} million", in_words(number / 1e6)),
        _ if number < 999.5e9 => format!("{} billion", in_words(number / 1e9)),
        _ => format!("{number:.1e}"),
    }
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
            order: order(&[], &[], ExpectedOrder::OF_SAMPLES, 0.0),
            cut: None,
        };
        let (text, setting) = text_and_setting(1e-4, &sweep);
        assert_eq!(
            text,
            "no measured setting is enough, up to 64 samples; if noise continues to fall as the root of the \
             samples, about 62.4 million samples will do, 975156 times the work of the scene's own 64 samples"
        );
        assert_eq!(setting, None);
        let (text, setting) = text_and_setting(0.1, &sweep);
        assert_eq!(text, "64 samples, the scene's own 64 samples");
        let command = command(Parameter::Samples, setting.unwrap(), "my fog.toml");
        assert_eq!(command, "volref render 'my fog.toml' -o image.exr --spp 64");
    }

    #[test]
    fn large_numbers_are_words() {
        let shown = [
            0.0017,
            0.5,
            1.004,
            2.656_25,
            12.34,
            17_000.0,
            2_656_250.0,
            2.1e9,
            3e15,
        ];
        assert_eq!(
            shown.map(in_words),
            [
                "2e-3",
                "0.5",
                "1",
                "2.66",
                "12.3",
                "17000",
                "2.66 million",
                "2.1 billion",
                "3.0e15"
            ]
        );
    }
}

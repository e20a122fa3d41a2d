//! Recommended settings.

use super::image::in_voxels;
use super::results::{Cost, Level, Parameter, Recommendation, Study, Sweep};
use super::study::WANTED;
use crate::scene::{Model, Panel};

/// Recommended settings of the fast renderer for each wanted error, from its own sweeps.
pub fn recommendations(cost: &Cost, panel: &Panel) -> Vec<Recommendation> {
    let ours = |study: &&Study| matches!(&*study.name, "image" | "samples");
    let Some(study) = cost.studies.iter().find(ours) else {
        return vec![Recommendation {
            error: 0.0,
            text:
                "this image is made of closed forms and integrals, exact but for rounding: there \
                   is nothing to choose"
                    .to_owned(),
            command: None,
        }];
    };
    let Some(sweep) = study.sweeps.iter().find(|sweep| sweep.is_ours) else {
        return vec![];
    };
    let given = SceneSettings::of(panel, sweep);
    WANTED
        .map(|error| recommendation(error, sweep, &given, &cost.scene))
        .into()
}

/// Samples per pixel of a scene, at most: 2^31.
const MOST_SAMPLES: f64 = 2_147_483_648.0;

/// Largest number of samples that a command is given for: a day and more for a small image.
const MOST_ADVISED: f64 = 1e6;

/// Settings that the scene asks for.
struct SceneSettings {
    setting: String,
    price: Option<f64>,
}

impl SceneSettings {
    fn of(panel: &Panel, sweep: &Sweep) -> SceneSettings {
        let (setting, value) = match &panel.model {
            Model::Classified(scene) => (in_voxels(scene.step, scene.voxel()), scene.step),
            Model::Radiative(scene) => {
                let samples = scene.samples;
                (format!("{samples} samples"), f64::from(samples))
            }
            Model::Curve(_) => (String::new(), 0.0),
        };
        SceneSettings {
            setting: in_sentence(sweep.parameter, &setting),
            price: price_at(sweep, value),
        }
    }

    /// Work beside that of the scene's own setting, in words.
    fn relative(&self, price: f64) -> String {
        let (own, setting) = (self.price.filter(|own| *own > 0.0), &self.setting);
        match own.map(|own| price / own) {
            // The settings of a sweep are not the scene's own to the last digit.
            Some(times) if (times - 1.0).abs() < 0.02 => format!(", the scene's own {setting}"),
            Some(times) => {
                let times = in_words(times);
                format!(", {times} times the work of the scene's own {setting}")
            }
            None => String::new(),
        }
    }
}

/// Samples at which noise has fallen to `error`, if it falls as the root of them: by the middle one
/// of all settings, since a single one may have met a rare path. To two digits.
fn samples_for(sweep: &Sweep, error: f64) -> f64 {
    let levels = sweep.levels.iter();
    let mut scaled: Vec<f64> = levels
        .map(|level| level.error.l2 * level.error.l2 * level.value)
        .collect();
    scaled.sort_unstable_by(f64::total_cmp);
    let samples = scaled[scaled.len() / 2] / (error * error);
    let mut unit = 1.0;
    while samples / unit >= 100.0 && unit < 1e300 {
        unit *= 10.0;
    }
    (samples / unit).ceil() * unit
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

fn recommendation(error: f64, sweep: &Sweep, given: &SceneSettings, scene: &str) -> Recommendation {
    let (text, command) = text_and_command(error, sweep, given, scene);
    // Digits of the product that say nothing.
    let percent = (error * 1e8).round() / 1e6;
    Recommendation {
        error,
        text: format!("for an error of {percent} %: {text}"),
        command,
    }
}

fn text_and_command(
    error: f64,
    sweep: &Sweep,
    given: &SceneSettings,
    scene: &str,
) -> (String, Option<String>) {
    let known = sweep.order.known;
    let good = sweep.levels.iter().rev();
    let good = good.take_while(|level| known <= error && level.error.l2 <= error);
    if let Some(level) = good.last() {
        let setting = in_sentence(sweep.parameter, &level.setting);
        let relative = given.relative(level.work.price());
        return (
            format!("{setting}{relative}"),
            Some(command(sweep.parameter, &level.setting, scene)),
        );
    }
    let Some(finest) = sweep.levels.last() else {
        let text = match sweep.cut {
            Some(_) => NO_TIME,
            None => "nothing was tried",
        };
        return (text.to_owned(), None);
    };
    // Noise falls with the root of the samples, which no finer setting needs to be tried for.
    if sweep.parameter == Parameter::Samples {
        let samples = samples_for(sweep, error);
        if samples <= MOST_SAMPLES {
            let text = format!(
                "no measured setting is enough, up to {}; if noise continues to fall as the root \
                of the samples, about {} samples will do{}",
                finest.setting,
                in_words(samples),
                given.relative(finest.work.price() * samples / finest.value)
            );
            let setting = format!("{samples} samples");
            // Nobody waits for more.
            let is_advised = samples <= MOST_ADVISED;
            return (
                text,
                is_advised.then(|| command(sweep.parameter, &setting, scene)),
            );
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
fn in_sentence(parameter: Parameter, setting: &str) -> String {
    match parameter {
        Parameter::Step => format!("steps of {setting}"),
        _ => setting.to_owned(),
    }
}

fn command(parameter: Parameter, setting: &str, scene: &str) -> String {
    let option = match parameter {
        Parameter::Samples => {
            let count = setting.split(' ').next().unwrap_or_default();
            format!("--spp {count}")
        }
        _ => format!("--step \"{setting}\""),
    };
    format!(
        "volref render {} -o image.exr {option}",
        shell_words::quote(scene)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::results::{ConvergenceOrder, Event, MeanWork, Norms, OrderVerdict};

    /// Noise beyond what was measured is said to be so, next to a price list that reaches nothing.
    #[test]
    fn what_was_not_measured_is_no_promise() {
        let level = |samples: u32| Level {
            setting: format!("{samples} samples"),
            value: f64::from(samples),
            work: MeanWork::from([(Event::RandomDraw, 10.0 * f64::from(samples))]),
            error: Norms {
                l2: 0.79 / f64::from(samples).sqrt(),
                ..Norms::default()
            },
            error_of_order: None,
            single_precision: None,
            time: None,
        };
        let sweep = Sweep {
            estimator: "path tracing".to_owned(),
            is_ours: true,
            parameter: Parameter::Samples,
            levels: [1, 16, 64].map(level).into(),
            order: ConvergenceOrder {
                expected: Some(-0.5),
                known: 0.0,
                counted: vec![true; 3],
                fitted: None,
                fitted_max: None,
                local: Vec::new(),
                tolerance: 0.05,
                uncertainty: 0.0,
                verdict: OrderVerdict::Undecided,
            },
            cut: None,
        };
        let given = SceneSettings {
            setting: "64 samples".to_owned(),
            price: Some(640.0),
        };
        let advice = recommendation(1e-4, &sweep, &given, "fog.toml");
        assert_eq!(
            advice.text,
            "for an error of 0.01 %: no measured setting is enough, up to 64 samples; \
             if noise continues to fall as the root of the samples, about 63 million samples will \
             do, \
             984375 times the work of the scene's own 64 samples"
        );
        assert_eq!(advice.command, None);
        let advice = recommendation(0.1, &sweep, &given, "my fog.toml");
        assert_eq!(
            advice.text,
            "for an error of 10 %: 64 samples, the scene's own 64 samples"
        );
        let command = "volref render 'my fog.toml' -o image.exr --spp 64";
        assert_eq!(advice.command.as_deref(), Some(command));
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

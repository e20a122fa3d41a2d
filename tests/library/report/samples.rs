//! A suite as a report may meet it: the goldens, and images made from them by known edits.

pub use crate::common::suite::golden_of as golden;
use crate::common::{simulated, suite::silent};
use std::sync::OnceLock;
use volref::compare::flip::SrgbImage;
use volref::compare::{Conditions, Gate, Picture, judge};
use volref::film::Film;
use volref::judging::{CaseResult, Cause, Evidence, LikelyMistake, Verdict};
use volref::naming::Diagnosis;
use volref::report::{Page, results_html};
use volref::suite::Case;

/// What a page tells of.
#[derive(Default)]
pub struct Sample {
    pub results: Vec<CaseResult>,
    pub evidence: Vec<Evidence>,
    pub found: Diagnosis,
}

impl Sample {
    pub fn page(&self) -> Page<'_> {
        Page {
            title: "validate: images in ./out",
            command: "volref validate --outputs out --report report",
            judged_with: "",
            results: &self.results,
            evidence: &self.evidence,
            found: &self.found,
        }
    }

    /// Adds a case that came to `verdict` without being compared.
    pub fn push(&mut self, name: &str, verdict: Verdict, evidence: Evidence) -> &mut CaseResult {
        self.evidence.push(evidence);
        self.results.push(result(name, verdict));
        self.results.last_mut().unwrap()
    }

    /// Adds a case, judged by `gate`.
    pub fn judged(&mut self, name: &str, gate: Gate, evidence: Evidence) -> &mut CaseResult {
        let golden = Picture::Radiance(evidence.golden.clone().unwrap());
        let test = evidence.test.as_ref().unwrap();
        let conditions = Conditions {
            exposure: evidence.exposure,
            ..Conditions::default()
        };
        let judgement = judge(gate, &golden, test, &conditions).unwrap();
        let verdict = if judgement.passed {
            Verdict::Pass
        } else {
            Verdict::Fail
        };
        let result = self.push(name, verdict, evidence);
        result.gate = gate;
        result.metrics = judgement.metrics;
        result.reason = judgement.reason;
        result
    }
}

pub fn result(name: &str, verdict: Verdict) -> CaseResult {
    CaseResult {
        name: name.to_owned(),
        family: name.split('/').next().unwrap().to_owned(),
        class: "deterministic".to_owned(),
        gate: Gate::Deterministic,
        ..CaseResult::new(verdict, Cause::None, "no reason")
    }
}

/// Numbers that look random, the same each time: in [0, 1), by a step of Knuth's MMIX generator.
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// Of mean 0 and standard deviation 1, nearly normal.
    pub fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.next()).sum::<f32>() - 6.0
    }
}

/// `film` with each pixel changed; without its noise.
pub fn edited(film: &Film, edit: impl Fn(usize, usize, [f32; 3]) -> [f32; 3]) -> Film {
    simulated::edited(&silent(film), edit)
}

/// A rendering of `factor` times the radiance of `golden` with a sixteenth of its samples.
pub fn rendered_again(golden: &Film, factor: f32) -> Film {
    let noise = golden.noise().expect("a golden of samples");
    let mut numbers = Numbers(1);
    let variance: Vec<[f32; 3]> = noise
        .variance()
        .iter()
        .map(|v| v.map(|v| 16.0 * v))
        .collect();
    let radiance = golden
        .radiance()
        .iter()
        .zip(&variance)
        .map(|(pixel, variance)| {
            let normal = numbers.normal();
            [0, 1, 2].map(|c| factor * (pixel[c] + variance[c].sqrt() * normal))
        })
        .collect();
    let samples = (noise.samples() / 16).max(2);
    Film::with_noise(golden.width(), golden.height(), radiance, variance, samples)
}

fn evidence(case: &Case, test: impl FnOnce(&Film) -> Option<Picture>) -> Evidence {
    let golden = match (case.truth, case.sampling) {
        (Some(_), Some(_)) => golden(&case.name).known(),
        _ => golden(&case.name),
    };
    Evidence {
        test: test(&golden),
        golden: Some(golden),
        provenance: vec![
            (
                "golden made by".to_owned(),
                "volref 0.1.0, 1472 samples per pixel, seed 1".to_owned(),
            ),
            ("hash of its pixels".to_owned(), "1f2e3d4c5b6a".repeat(5)),
            ("image".to_owned(), format!("out/{}.exr", case.name)),
        ],
        reproduce: vec![
            format!(
                "volref render fixtures/scenes/{}.toml -o golden.exr",
                case.name
            ),
            format!("volref compare golden.exr out/{}.exr", case.name),
        ],
        ..Evidence::of(case)
    }
}

/// The pixel that is checked to the digits, of a deterministic failure.
pub const CHECKED: &str = "figures/figure-3";

/// The whole suite, with failures of every kind among it.
pub fn suite() -> &'static Sample {
    static SUITE: OnceLock<Sample> = OnceLock::new();
    SUITE.get_or_init(made_suite)
}

/// Its page.
pub fn suite_html() -> &'static str {
    static HTML: OnceLock<String> = OnceLock::new();
    HTML.get_or_init(|| results_html(&suite().page()))
}

fn made_suite() -> Sample {
    let suite = crate::common::suite::suite();
    let mut sample = Sample::default();
    for case in suite.cases() {
        let some = |film| Some(Picture::Radiance(film));
        let again = |film: &Film| match film.noise() {
            Some(_) => rendered_again(film, 1.0),
            None => edited(film, |_, _, pixel| pixel.map(|v| v * 1.000_1)),
        };
        match case.name.as_str() {
            CHECKED => {
                let factor = |y| 1.0 + 0.12 * f32::from(u8::from(y > 100));
                let e = evidence(case, |f| {
                    some(edited(f, |_, y, pixel| pixel.map(|v| v * factor(y))))
                });
                let result = sample.judged(&case.name, case.gate(), e);
                result.looks_like = vec![
                    "no opacity correction".into(),
                    "half a voxel of offset".into(),
                ];
            }
            "figures/figure-4" => {
                let e = evidence(case, |f| some(Film::new(9, 5, f.radiance()[..45].to_vec())));
                sample.judged(&case.name, case.gate(), e);
            }
            "figures/figure-5" => {
                let e = evidence(case, |f| {
                    let codes = edited(f, |_, _, p| [p[1], p[1], p[2]]).srgb_codes(case.exposure);
                    Some(Picture::Codes(
                        SrgbImage::new(f.width(), f.height(), codes).unwrap(),
                    ))
                });
                sample.judged(&case.name, Gate::Perceptual, e);
            }
            "fog/backward" => {
                let e = evidence(case, |_| some(rendered_again(&golden("fog/forward"), 1.0)));
                let result = sample.judged(&case.name, case.gate(), e);
                result.looks_like = vec!["g negated".to_owned()];
            }
            "fog/rate-0.1" => {
                let e = evidence(case, |f| some(rendered_again(f, 1.02)));
                sample.judged(&case.name, case.gate(), e);
            }
            "procedural/gain-0.1" => {
                let e = evidence(case, |f| {
                    some(edited(f, |x, y, p| match (x, y) {
                        (64..70, 60..63) => [f32::NAN, p[1], p[2]],
                        (90, 90) => [f32::INFINITY; 3],
                        _ => p,
                    }))
                });
                sample.judged(&case.name, Gate::Deterministic, e);
            }
            "smoke/cornell" => {
                let e = Evidence {
                    output: Some("error: out of memory\n".repeat(2_000)),
                    ..evidence(case, |_| None)
                };
                let result = sample.push(&case.name, Verdict::Missing, e);
                result.reason =
                    "the renderer ended with exit code 137 and wrote no image".to_owned();
            }
            "procedural/gain-0.6" => {
                let e = Evidence {
                    golden: None,
                    ..evidence(case, |f| some(again(f)))
                };
                let result = sample.push(&case.name, Verdict::Error, e);
                result.reason =
                    "stale: the scene has changed since the golden was accepted".to_owned();
            }
            "fog/absorption" => {
                let e = evidence(case, |f| some(again(f)));
                let result = sample.judged(&case.name, case.gate(), e);
                result.verdict = Verdict::Inconclusive;
                result.reason = "too noisy: 256 samples per pixel would decide".to_owned();
            }
            _ => {
                sample.judged(&case.name, case.gate(), evidence(case, |f| some(again(f))));
            }
        }
    }
    sample.found.likely = vec![
        LikelyMistake {
            mistake: "g negated".to_owned(),
            advice: "the phase function has forward and backward exchanged: check the sign convention of your direction vectors".to_owned(),
            explains: 1,
            of: 6,
            cases: Vec::new(),
        },
        LikelyMistake {
            mistake: "no opacity correction".to_owned(),
            advice: "opacities of the table are meant over the reference length: correct them for the length of your step".to_owned(),
            explains: 1,
            of: 6,
            cases: Vec::new(),
        },
    ];
    sample
}

/// A text that would do harm if any place of the page took it for more than text.
pub const HOSTILE: &str = "../\"x' onerror='window.hacked=1'></script><script>window.hacked=1</script><img src=x onerror=window.hacked=1>{{ 7*7 }}<!--]]>";

/// A failed case all of whose texts are [`HOSTILE`].
pub fn hostile() -> Sample {
    let mut sample = Sample::default();
    let text = || HOSTILE.to_owned();
    let film = Film::new(2, 1, vec![[0.25, 0.5, 1.0], [0.5; 3]]);
    let evidence = Evidence {
        conventions_are_open: false,
        work_of_search: 0,
        golden: Some(film.clone()),
        test: Some(Picture::Radiance(edited(&film, |_, _, pixel| {
            pixel.map(|v| 2.0 * v)
        }))),
        at_step: None,
        exposure: 0.0,
        source: text(),
        shows: text(),
        computes: text(),
        provenance: vec![(text(), text())],
        reproduce: vec![text()],
        call: Some(text()),
        output: Some(text()),
        rendering_seconds: None,
    };
    let result = sample.push(HOSTILE, Verdict::Fail, evidence);
    result.family = text();
    result.class = text();
    result.reason = text();
    result.looks_like = vec![text()];
    result.metrics.insert(text(), 1.0);
    sample.found.likely = vec![LikelyMistake {
        mistake: text(),
        advice: text(),
        explains: 1,
        of: 1,
        cases: Vec::new(),
    }];
    sample
}

//! Stochastic cases with a renderer that is made of noise.

use super::*;
use crate::judging::verify::verify_with;
use crate::judging::{CaseResult, Verdict};
use crate::render::{Plan, Progress, RenderError, Rendering, Sampling};
use crate::scene::Model;
use crate::suite::Suite;
use std::sync::Mutex;

const SCENE: &str = include_str!("../../../fixtures/scenes/smoke/cornell.toml");

const MANIFEST: &str = "source = \"a test\"\nshows = \"noise\"\ncomputes = \"nothing\"\n\
                        class = \"stochastic\"\nconverged_samples = 400\nquick_samples = 16\n";

/// Means of numbers uniform in [0, 1), by seed, pixel and sample alone.
struct ExtraNoise {
    /// Makes other random numbers, as a renderer does that was rewritten.
    variant: u8,
    /// Added to every pixel of a quick rendering.
    bias: f32,
    /// Samples and seed of every rendering so far.
    calls: Mutex<Vec<(u32, u64)>>,
}

impl ExtraNoise {
    fn new() -> ExtraNoise {
        ExtraNoise {
            variant: 0,
            bias: 0.0,
            calls: Mutex::default(),
        }
    }

    /// The calls since the last time.
    fn calls(&self) -> Vec<(u32, u64)> {
        std::mem::take(&mut self.calls.lock().unwrap())
    }
}

impl ExtraNoise {
    fn render(&self, plans: &[Plan<'_>], sampling: Sampling) -> Result<Rendering, RenderError> {
        let panel = plans[0].panel;
        let Model::Radiative(radiative) = &panel.model else {
            panic!("not the scene of this test")
        };
        let samples = sampling.samples_of(radiative);
        let seed = sampling.seed_of(radiative);
        self.calls.lock().unwrap().push((samples, seed));
        let bias = if samples < 400 { self.bias } else { 0.0 };
        let (mut means, mut variances) = (Vec::new(), Vec::new());
        let (height, width) = (panel.height, panel.width);
        for pixel in (0..height * width).map(|pixel| pixel as u32) {
            let number = |sample: u32| {
                let mut bytes = vec![self.variant];
                bytes.extend(seed.to_le_bytes());
                bytes.extend(pixel.to_le_bytes());
                bytes.extend(sample.to_le_bytes());
                let hash = blake3::hash(&bytes);
                f64::from(u16::from_le_bytes([hash.as_bytes()[0], hash.as_bytes()[1]])) / 65536.0
            };
            let numbers: Vec<f64> = (0..samples).map(number).collect();
            let n = f64::from(samples);
            let mean = numbers.iter().sum::<f64>() / n;
            let squares: f64 = numbers.iter().map(|x| (x - mean) * (x - mean)).sum();
            means.push([mean as f32 + bias; 3]);
            variances.push([(squares / (n - 1.0) / n) as f32; 3]);
        }
        Ok(Rendering {
            film: Film::with_noise(width, height, means, variances, samples),
            work: vec![],
            error_bound: None,
        })
    }
}

struct SampledFolder(tempfile::TempDir);

impl SampledFolder {
    fn new() -> SampledFolder {
        let folder = SampledFolder(tempfile::tempdir().unwrap());
        let scene = SCENE.replace("= 256", "= 16");
        folder.write("fixtures/scenes/fog/room.toml", &scene);
        folder.write("fixtures/cases/fog/room.toml", MANIFEST);
        folder
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.0.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    fn manifest(&self, old: &str, new: &str) {
        assert!(MANIFEST.contains(old));
        self.write("fixtures/cases/fog/room.toml", &MANIFEST.replace(old, new));
    }

    fn suite(&self) -> Suite {
        Suite::open(self.0.path()).unwrap()
    }

    fn store(&self) -> Store {
        Store::open(self.suite().golden_folder())
    }

    fn accept(&self, renderer: &ExtraNoise) -> Result<Vec<Accepted>, AcceptError> {
        self.accept_or_keep(renderer, false)
    }

    fn accept_or_keep(
        &self,
        renderer: &ExtraNoise,
        keep_images: bool,
    ) -> Result<Vec<Accepted>, AcceptError> {
        let suite = self.suite();
        let cases: Vec<_> = suite.cases().iter().collect();
        accept_with(
            &|plans, sampling, _| renderer.render(plans, sampling),
            &cases,
            &self.store(),
            Request {
                reason: "a test",
                keep_images,
                in_ci: false,
            },
            &|| (),
            &|_| (),
        )
    }

    fn verify(&self, renderer: &ExtraNoise) -> CaseResult {
        let render =
            |plans: &[Plan<'_>], sampling, _: Progress<'_>| renderer.render(plans, sampling);
        verify_with(&render, &self.suite().cases()[0], &self.store(), &|| ()).result
    }

    fn golden(&self) -> Golden {
        Golden::read(&self.store(), &self.suite().cases()[0]).unwrap()
    }
}

#[test]
fn two_renderings_that_share_no_random_number() {
    let folder = SampledFolder::new();
    let renderer = ExtraNoise::new();
    let accepted = folder.accept(&renderer).unwrap();
    assert_eq!(accepted[0].detail, "its first golden");
    assert_eq!(renderer.calls(), [(16, 0), (400, 1 << 63)]);

    let provenance = folder.golden().provenance;
    assert_eq!((provenance.samples, provenance.seed), (400, 0));
    assert_eq!(provenance.quick.as_ref().unwrap().samples, 16);
    // Of numbers uniform in [0, 1): √(1/12 / 400 / 64) / (0.5 + 0.001).
    assert!((provenance.error_estimate - 0.0036).abs() < 0.0004);

    let result = folder.verify(&renderer);
    assert_eq!(result.verdict, Verdict::Pass, "{}", result.reason);
    assert_eq!(result.metrics["same_bits"], 1.0);
    assert!(result.reason.contains("same bits") && result.reason.contains("400 samples"));
    assert_eq!(renderer.calls(), [(16, 0)], "verify stays quick");

    assert_eq!(
        folder.accept(&renderer).unwrap()[0].change,
        Change::Unchanged
    );
}

#[test]
fn other_bits_fail_and_say_whether_the_picture_is_the_same() {
    let folder = SampledFolder::new();
    folder.accept(&ExtraNoise::new()).unwrap();
    let rewritten = ExtraNoise {
        variant: 1,
        ..ExtraNoise::new()
    };
    let wrong = ExtraNoise {
        bias: 0.1,
        ..ExtraNoise::new()
    };
    for (renderer, words) in [
        (
            rewritten,
            "but against 400 samples: no difference beyond noise",
        ),
        (wrong, "and against 400 samples: the image is too bright"),
    ] {
        let result = folder.verify(&renderer);
        assert_eq!(result.verdict, Verdict::Fail);
        assert_eq!(result.metrics["same_bits"], 0.0);
        for words in ["other bits", words] {
            assert!(result.reason.contains(words), "{}", result.reason);
        }
    }
}

/// A renderer of other random numbers: its quick rendering is recorded beside the old image, and a
/// biased one is refused, as is an image of other samples.
#[test]
fn images_can_be_kept() {
    let folder = SampledFolder::new();
    let renderer = ExtraNoise::new();
    let nothing = |result: Result<Vec<Accepted>, AcceptError>| {
        let error = result.unwrap_err();
        assert!(error.to_string().contains("no image to keep"), "{error}");
    };
    nothing(folder.accept_or_keep(&renderer, true));
    folder.accept(&renderer).unwrap();
    let before = folder.golden();

    let rewritten = ExtraNoise {
        variant: 1,
        ..ExtraNoise::new()
    };
    assert_eq!(folder.verify(&rewritten).verdict, Verdict::Fail);
    rewritten.calls();
    let accepted = folder.accept_or_keep(&rewritten, true).unwrap();
    assert_eq!(accepted[0].change, Change::Recorded);
    assert_eq!(rewritten.calls(), [(16, 0)]);
    assert_eq!(folder.verify(&rewritten).verdict, Verdict::Pass);
    let after = folder.golden();
    assert_eq!(before.film, after.film);
    assert_ne!(before.provenance.quick, after.provenance.quick);

    let biased = ExtraNoise {
        bias: 0.1,
        ..ExtraNoise::new()
    };
    let error = folder.accept_or_keep(&biased, true).unwrap_err();
    assert!(error.to_string().contains(CONTRADICTION), "{error}");
    folder.manifest("= 400", "= 401");
    nothing(folder.accept_or_keep(&rewritten, true));
    assert_eq!(folder.golden().provenance.seal, after.provenance.seal);
}

#[test]
fn quick_and_converged_must_agree() {
    let folder = SampledFolder::new();
    let wrong = ExtraNoise {
        bias: 0.1,
        ..ExtraNoise::new()
    };
    let error = folder.accept(&wrong).unwrap_err();
    assert!(error.to_string().contains(CONTRADICTION), "{error}");
    assert_eq!(folder.verify(&wrong).verdict, Verdict::Missing);
}

#[test]
fn a_noisy_golden_is_refused_with_the_samples_that_would_do() {
    let folder = SampledFolder::new();
    folder.manifest("= 400", "= 200");
    let Err(AcceptError::Refused { reason, help }) = folder.accept(&ExtraNoise::new()) else {
        panic!("a golden of 200 samples is too noisy")
    };
    assert!(reason.contains("too noisy"), "{reason}");
    let enough = help
        .split_once("= ")
        .and_then(|(_, it)| it.split_once(';'))
        .unwrap()
        .0;
    assert!((210..400).contains(&enough.parse().unwrap()), "{enough}");
    folder.manifest("= 400", &format!("= {enough}"));
    folder.accept(&ExtraNoise::new()).unwrap();
}

#[test]
fn a_changed_manifest_makes_the_golden_stale() {
    let folder = SampledFolder::new();
    folder.accept(&ExtraNoise::new()).unwrap();
    for (old, new, words) in [
        ("= 400", "= 500", "converged_samples"),
        ("= 16", "= 17", "quick_samples"),
        ("= 16", "= 16\nresolution = 0.01", "too noisy"),
    ] {
        folder.manifest(old, new);
        let result = folder.verify(&ExtraNoise::new());
        assert_eq!(result.verdict, Verdict::Error);
        assert!(result.reason.contains("stale") && result.reason.contains(words));
    }
}

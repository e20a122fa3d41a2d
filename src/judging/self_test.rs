//! The self-test: the suite must catch every mistake, and reject no correct image.
//!
//! Every [mistake](crate::variations::mistakes) is made in the cases to which it applies, the image is rendered
//! with fresh seeds, and judged like that of another renderer. A gate that was never seen to fail
//! cannot be trusted; one that rejects a correct image is as bad.

use super::finding::CheckedGolden;
use super::validate::validate_with;
use super::{Judged, Verdict};
use crate::compare::Picture;
use crate::compare::flip::SrgbImage;
use crate::film::{Encoding, Film, Origin, Quantisation};
use crate::math::rng::{Purpose, Stream};
use crate::render::{Sampling, Seed, plans, render};
use crate::scene::Scene;
use crate::suite::{Case, Store};
use crate::variations::edited_film::{mapped, rebuilt, value};
use crate::variations::mistakes;
use crate::variations::mistakes::Mistake;
use half::f16;
use serde::{Deserialize, Serialize};
use std::cell::OnceCell;
use std::collections::BTreeMap;

/// The outcome of one mistake in one case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trial {
    /// Rejected, as it should be.
    Caught,
    /// Not rejected.
    Missed,
    /// The mistake changes nothing here, or cannot be rendered.
    NoOccasion,
    /// Not tried, because another case had caught it.
    NotTried,
}

/// Findings in one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseTrials {
    /// Its name.
    pub case: String,
    /// Outcomes by name of the mistake.
    pub mistakes: BTreeMap<String, Trial>,
    /// Benign variants tried; with the reason, if rejected.
    pub benign: BTreeMap<String, Option<String>>,
    /// Reason why its golden cannot be trusted, if so: then nothing was tried.
    pub unusable: Option<String>,
}

impl CaseTrials {
    fn is_usable(&self) -> bool {
        self.unusable.is_none()
    }

    /// These findings with those of another process, which may have tried other mistakes.
    pub fn with(mut self, other: CaseTrials) -> CaseTrials {
        for (mistake, trial) in other.mistakes {
            if self.trial(&mistake) == Trial::NotTried {
                self.mistakes.insert(mistake, trial);
            }
        }
        for (variant, rejection) in other.benign {
            let known = self.benign.entry(variant).or_default();
            *known = known.take().or(rejection);
        }
        self.unusable = self.unusable.or(other.unusable);
        self
    }

    fn trial(&self, mistake: &str) -> Trial {
        let trial = self.mistakes.get(mistake);
        trial.copied().unwrap_or(Trial::NotTried)
    }
}

/// A mistake and its outcome in each case.
#[derive(Clone, Debug, Serialize)]
pub struct MistakeTrials {
    /// Its name in the catalogue.
    pub mistake: &'static str,
    /// Outcomes by case, in their order.
    pub trials: Vec<Trial>,
}

/// A benign variant, and the cases that rejected it.
#[derive(Clone, Debug, Serialize)]
pub struct BenignTrials {
    /// Name of the variant.
    pub variant: &'static str,
    /// Cases that accepted it, or were undecided.
    pub accepted: usize,
    /// Cases that rejected it, and why.
    pub rejected: Vec<Rejection>,
}

impl BenignTrials {
    fn of(variant: &'static str, found: &[&CaseTrials]) -> BenignTrials {
        let accepts = |of: &&&CaseTrials| of.benign.get(variant) == Some(&None);
        let rejected = found.iter().filter_map(|of| {
            let reason = of.benign.get(variant)?.as_ref()?;
            Some(Rejection::new(&of.case, reason))
        });
        BenignTrials {
            variant,
            accepted: found.iter().filter(accepts).count(),
            rejected: rejected.collect(),
        }
    }
}

/// A correct image that was rejected.
#[derive(Clone, Debug, Serialize)]
pub struct Rejection {
    /// Name of the case.
    pub case: String,
    /// Reason given by its gate.
    pub reason: String,
}

impl Rejection {
    fn new(case: &str, reason: &str) -> Rejection {
        Rejection {
            case: case.to_owned(),
            reason: reason.to_owned(),
        }
    }
}

/// Results of a self-test.
#[derive(Clone, Debug, Serialize)]
pub struct SelfTest {
    /// Names of the cases, in order.
    pub cases: Vec<String>,
    /// Every mistake.
    pub mistakes: Vec<MistakeTrials>,
    /// Every benign variant.
    pub benign: Vec<BenignTrials>,
    /// Mistakes that no case caught although they applied; if all cases of the suite were tried,
    /// also those that never applied.
    pub uncaught: Vec<&'static str>,
    /// Mistakes that the manifest of a case requires it to catch and that it missed.
    pub broken_promises: Vec<String>,
    /// Untrustworthy goldens with reasons: their cases cannot be tested.
    pub unusable: Vec<Rejection>,
}

impl SelfTest {
    /// True if every mistake is caught, every promise kept and every correct image accepted.
    pub fn passed(&self) -> bool {
        self.unusable.is_empty() && self.judges_right()
    }

    /// True if every mistake is caught, every promise kept and every correct image accepted by the
    /// cases with trustworthy goldens.
    pub(crate) fn judges_right(&self) -> bool {
        self.uncaught.is_empty()
            && self.broken_promises.is_empty()
            && self.benign.iter().all(|benign| benign.rejected.is_empty())
    }
}

/// Added to the seed of a scene for pictures of the self-test: they share no random number with
/// goldens.
const SEED: u64 = 0x7365_6c66_0000_0000;

/// Progress of a self-test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step<'n> {
    /// A picture of this case is rendered, or images with this variant or mistake are judged.
    Begins(&'n str),
    /// The current step is done.
    Done,
}

/// The steps of a self-test on that many cases.
pub fn self_test_steps(cases: usize) -> usize {
    cases + BENIGN.len() + mistakes::catalogue().count()
}

/// Cases of a self-test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SelfTestCases {
    /// All of the suite: each mistake is to be caught by one of them.
    Whole,
    /// Some of it: each mistake for which they give occasion is to be caught by one of them.
    Selected,
    /// A part of these: a mistake that it misses may be caught by another part.
    Part,
}

impl SelfTestCases {
    /// All parts of the selected cases, if they are there; everything, if no filter excludes a case.
    pub fn of(has_all_parts: bool, is_everything: bool) -> SelfTestCases {
        match (has_all_parts, is_everything) {
            (false, _) => SelfTestCases::Part,
            (true, true) => SelfTestCases::Whole,
            (true, false) => SelfTestCases::Selected,
        }
    }
}

/// Runs the self-test on `cases`: outcomes of every mistake and of correct images in each. A quick one tries a mistake in
/// the cases required to catch it, and in others until one does; and correct images in every fourth case.
pub(crate) fn case_trials(
    cases: &[&Case],
    store: &Store,
    is_quick: bool,
    report: &dyn Fn(Step<'_>),
) -> Vec<CaseTrials> {
    let mut found = Vec::new();
    let mut subjects = Vec::new();
    for case in cases {
        report(Step::Begins(&case.name));
        let subject = Subject::new(case, store);
        found.push(CaseTrials {
            case: case.name.clone(),
            mistakes: BTreeMap::new(),
            benign: BTreeMap::new(),
            unusable: subject.as_ref().err().cloned(),
        });
        subjects.extend(subject);
        report(Step::Done);
    }
    let mut of_subjects: Vec<&mut CaseTrials> =
        found.iter_mut().filter(|of| of.is_usable()).collect();
    let every = if is_quick { 4 } else { 1 };
    for (variant, make) in BENIGN {
        report(Step::Begins(variant));
        for (subject, found) in subjects.iter().zip(&mut of_subjects).step_by(every) {
            let Some(picture) = make(subject) else {
                continue;
            };
            let result = subject.judge(picture).result;
            let is_accepted = matches!(result.verdict, Verdict::Pass | Verdict::Inconclusive);
            let rejection = (!is_accepted).then_some(result.reason);
            found.benign.insert((*variant).to_owned(), rejection);
        }
        report(Step::Done);
    }
    for mistake in mistakes::catalogue() {
        report(Step::Begins(mistake.name));
        let trials = trials(mistake, &subjects, is_quick);
        for (found, trial) in of_subjects.iter_mut().zip(trials) {
            found.mistakes.insert(mistake.name.to_owned(), trial);
        }
        report(Step::Done);
    }
    found
}

impl SelfTest {
    /// The self-test of these `cases` of the suite, of which this was `found`.
    pub fn of(cases: &[&Case], found: &[CaseTrials], which: SelfTestCases) -> SelfTest {
        let usable: Vec<&CaseTrials> = found.iter().filter(|of| of.is_usable()).collect();
        let mistakes: Vec<MistakeTrials> = mistakes::catalogue()
            .map(|mistake| MistakeTrials {
                mistake: mistake.name,
                trials: usable.iter().map(|of| of.trial(mistake.name)).collect(),
            })
            .collect();
        let is_to_be_caught = |row: &&MistakeTrials| match which {
            SelfTestCases::Whole => true,
            SelfTestCases::Selected => row.trials.contains(&Trial::Missed),
            SelfTestCases::Part => false,
        };
        let is_caught = |row: &&MistakeTrials| row.trials.contains(&Trial::Caught);
        let uncaught = mistakes
            .iter()
            .filter(|row| is_to_be_caught(row) && !is_caught(row));
        let uncaught = uncaught.map(|row| row.mistake).collect();
        let promised = |of: &CaseTrials, mistake: &str| {
            let case = cases.iter().find(|case| case.name == of.case);
            case.is_some_and(|case| case.mistakes.iter().any(|name| name == mistake))
        };
        let mut broken_promises = Vec::new();
        for row in &mistakes {
            for (of, trial) in usable.iter().zip(&row.trials) {
                if matches!(trial, Trial::Missed | Trial::NoOccasion) && promised(of, row.mistake) {
                    broken_promises.push(format!("{}: {}", of.case, row.mistake));
                }
            }
        }
        let unusable = |of: &CaseTrials| Some(Rejection::new(&of.case, of.unusable.as_ref()?));
        let benign = |(variant, _): &(&'static str, Benign)| BenignTrials::of(variant, &usable);
        SelfTest {
            cases: usable.iter().map(|of| of.case.clone()).collect(),
            mistakes,
            benign: BENIGN.iter().map(benign).collect(),
            uncaught,
            broken_promises,
            unusable: found.iter().filter_map(unusable).collect(),
        }
    }
}

/// A case, and an honest picture of it.
pub(crate) struct Subject<'c> {
    pub case: &'c Case,
    checked: CheckedGolden,
    /// Samples per pixel, in every picture.
    samples: u32,
    honest: OnceCell<Film>,
}

impl<'c> Subject<'c> {
    pub fn new(case: &'c Case, store: &Store) -> Result<Subject<'c>, String> {
        let checked = CheckedGolden::load_with_sensitivities(case, store);
        let checked = checked.map_err(|finding| finding.reason)?;
        let samples = case.sampling.map_or(1, |sampling| sampling.quick);
        Ok(Subject {
            case,
            checked,
            samples,
            honest: OnceCell::new(),
        })
    }

    /// The picture as it should be, rendered once.
    fn honest(&self) -> &Film {
        let make = || {
            let film = self.right(0);
            film.unwrap_or_else(|| self.checked.golden.film.clone())
        };
        self.honest.get_or_init(make)
    }

    /// The picture as it should be, with seeds of its own for each `run`.
    pub fn right(&self, run: u64) -> Option<Film> {
        picture(&self.checked.scene, self.samples, run)
    }

    /// Judges a picture of the case.
    pub fn judge(&self, picture: Picture) -> Judged {
        validate_with(self.case, &self.checked, picture)
    }

    /// The picture with `mistake`; `None` if the case gives no occasion for it.
    fn with(&self, mistake: &Mistake) -> Option<Film> {
        if mistake.is_of_the_image() {
            return mistake.in_image(self.honest());
        }
        picture(&mistake.in_scene(&self.checked.scene)?, self.samples, 0)
    }
}

/// `scene` rendered as another renderer would that is built like the reference. Seeds differ from
/// run to run; scenes without random numbers have none.
fn picture(scene: &Scene, samples: u32, run: u64) -> Option<Film> {
    let seed = scene.seed().unwrap_or(0).wrapping_add(SEED + run);
    let sampling = Sampling {
        samples: Some(samples),
        seed: Seed::Given(seed),
    };
    let made = render(&plans(scene), sampling, &|| ());
    made.ok().map(|made| made.film)
}

/// Outcomes of `mistake` in each case.
fn trials(mistake: &Mistake, subjects: &[Subject<'_>], is_quick: bool) -> Vec<Trial> {
    let mut trials = vec![Trial::NotTried; subjects.len()];
    let promises = |subject: &Subject<'_>| subject.case.mistakes.iter().any(|m| m == mistake.name);
    let mut order: Vec<usize> = (0..subjects.len()).collect();
    order.sort_by_key(|&index| !promises(&subjects[index]));
    let mut is_caught = false;
    for index in order {
        let subject = &subjects[index];
        if is_quick && is_caught && !promises(subject) {
            break;
        }
        trials[index] = match subject.with(mistake) {
            None => Trial::NoOccasion,
            Some(film) => match subject.judge(Picture::Radiance(film)).result.verdict {
                Verdict::Fail => Trial::Caught,
                _ => Trial::Missed,
            },
        };
        is_caught |= trials[index] == Trial::Caught;
    }
    trials
}

/// A correct variant of a picture; `None` where it does not apply to the case.
type Benign = fn(&Subject<'_>) -> Option<Picture>;

/// Benign variants: choices of correct renderers.
const BENIGN: &[(&str, Benign)] = &[
    ("other-seed", |subject| {
        Some(Picture::Radiance(subject.honest().clone()))
    }),
    ("half-precision", |subject| {
        let half = mapped(subject.honest(), |x, _| (f16::from_f64(x).to_f64(), 1.0));
        // Nobody keeps in half precision an image that it cannot hold.
        let held = half.radiance().iter().flatten().all(|x| x.is_finite());
        held.then_some(Picture::Radiance(half))
    }),
    ("other-rounding", |subject| {
        Some(Picture::Radiance(rebuilt(subject.honest(), |film, at| {
            let index = at[0] + film.width() * at[1];
            let u = Stream::new(SEED, index as u32, 0).uniform(0, Purpose::Camera, 0);
            // A renderer in single precision is off by no more than this.
            let factor = 1.0 + 1e-4 * (2.0 * u as f32 - 1.0);
            let (mean, variance) = value(film, at);
            (mean.map(|x| f64::from(x as f32 * factor)), variance)
        })))
    }),
    ("noise-not-stated", |subject| {
        let film = subject.honest();
        film.noise()?;
        let silent = Film::new(film.width(), film.height(), film.radiance().to_vec());
        Some(Picture::Radiance(silent))
    }),
    ("four-replicates", |subject| {
        subject.case.sampling?;
        let films: Vec<Film> = (1..5).filter_map(|run| subject.right(run)).collect();
        Film::from_replicates(&films).ok().map(Picture::Radiance)
    }),
    ("png-at-the-exposure", |subject| {
        // Noise is not in the eye's favour: pictures of few samples are not meant to look alike.
        if subject.case.sampling.is_some() {
            return None;
        }
        let film = subject.honest();
        let codes = film.srgb_codes(subject.case.exposure);
        let image = SrgbImage::new(film.width(), film.height(), codes);
        image.ok().map(Picture::Codes)
    }),
    ("8-bits-linear", |subject| {
        Some(in_8_bits(subject, Encoding::Linear))
    }),
    ("8-bits-srgb", |subject| {
        Some(in_8_bits(subject, Encoding::Srgb))
    }),
];

/// The picture as a renderer has it that reads it from a display, and says so: rounded and cut off at the exposure
/// of the case.
fn in_8_bits(subject: &Subject<'_>, encoding: Encoding) -> Picture {
    let quantisation = Quantisation {
        encoding,
        exposure: subject.case.exposure,
        origin: Origin::Declared,
        blended: false,
    };
    Picture::Radiance(quantisation.rounded(subject.honest()))
}

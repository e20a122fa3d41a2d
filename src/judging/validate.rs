//! Another renderer's image against the golden of a case.

use super::decide::cases_at;
use super::depth::{self, DepthComparison};
use super::finding::{CheckedGolden, MOST_CASES};
use super::measured::{codes_in_words, gain, is_of_png};
use super::nothing_drawn::nothing_drawn;
use super::precision::{known, known_radiance, other_readings};
use super::{CaseResult, Cause, Evidence, Judged, Verdict, random_samples, refinement};
use crate::compare::depth::OUTLIERS_OF_DEPTH;
use crate::compare::{
    Gate, Judgement, Picture, PictureError, default_gate, judge, precision_in_words,
    stochastic::is_off_by_noise,
};
use crate::conventions::Profile;
use crate::film::Film;
use crate::scene::Model;
use crate::suite::{Case, Output, Store};
use std::time::Instant;

/// Judges the output of another renderer for `case`, by the gate of the case: radiance by the
/// deterministic or the stochastic one, 8-bit codes by the perceptual one.
///
/// With a `profile`, a classified volume is judged by its image under the conventions of that profile,
/// rendered now, in place of the golden; in a case of class limit with the step of its scene.
pub fn validate(case: &Case, store: &Store, output: Output, profile: Option<&Profile>) -> Judged {
    validate_at(None, case, store, output, profile)
}

/// [`validate`] at look `look`, from 1, where there may be several at one case: together they raise no more false
/// alarms than one.
pub(crate) fn validate_at(
    look: Option<u32>,
    case: &Case,
    store: &Store,
    output: Output,
    profile: Option<&Profile>,
) -> Judged {
    let cases = look.map_or(MOST_CASES, cases_at);
    let start = Instant::now();
    let checked = CheckedGolden::load_with_sensitivities(case, store);
    let checked = checked.map(|checked| CheckedGolden { cases, ..checked });
    let has_image = matches!(output, Output::Picture(_) | Output::Refined(_));
    let checked = checked.and_then(|checked| match profile {
        Some(profile) if has_image => checked.under(profile),
        _ => Ok(checked),
    });
    let mut judged = match (output, checked) {
        (Output::Picture(picture), Ok(checked)) => validate_with(case, &checked, *picture),
        (Output::Refined(mut images), Ok(checked)) if case.is_limit() => match &checked.profile {
            None => validate_refined(case, &checked, images),
            Some(_) => validate_with(case, &checked, images.swap_remove(0)),
        },
        (Output::Refined(_), Ok(checked)) => {
            let reason = "there are images with several steps, and the scene of this case states its \
                          step: only cases of class limit are judged by several; keep one image";
            without_image(case, Verdict::Error, reason.to_owned(), Ok(checked))
        }
        (Output::Picture(_) | Output::Refined(_), Err(finding)) => Judged {
            result: finding.of_case(&case.name, case.class(), case.gate()),
            evidence: Evidence::of(case),
        },
        (Output::Missing(reason), checked) => {
            without_image(case, Verdict::Missing, reason, checked)
        }
        (Output::Unusable(reason), checked) => without_image(case, Verdict::Error, reason, checked),
    };
    judged.result.seconds = start.elapsed().as_secs_f64();
    judged
}

/// The verdict on a case without an image to judge: a fault of its golden or scene first, since that
/// weighs more, then that of the other renderer.
fn without_image(
    case: &Case,
    verdict: Verdict,
    reason: String,
    checked: Result<CheckedGolden, CaseResult>,
) -> Judged {
    let (finding, evidence) = match checked {
        Ok(checked) => (
            CaseResult::new(verdict, Cause::OtherRenderer, reason),
            evidence(case, &checked),
        ),
        Err(mut finding) => {
            finding.reason = format!("{}; {reason}", finding.reason);
            (finding, Evidence::of(case))
        }
    };
    Judged {
        result: finding.of_case(&case.name, case.class(), case.gate()),
        evidence,
    }
}

/// Judges `picture` as an image of `case`, whose golden is loaded.
pub(crate) fn validate_with(case: &Case, checked: &CheckedGolden, picture: Picture) -> Judged {
    let picture = known(case, &checked.golden.film, picture);
    let profile = checked.profile.as_ref();
    let golden = profile.and_then(|_| random_samples::nearest(&checked.scene, &picture));
    let golden = golden.unwrap_or_else(|| reference(case, checked, &picture));
    let golden = Picture::Radiance(golden);
    let finding = match judged(case, checked, &golden, &picture) {
        Ok(judgement) => with_words(case, checked, judgement, &picture),
        Err(error) => CaseResult {
            gate: case.gate(),
            ..CaseResult::new(Verdict::Error, Cause::OtherRenderer, error.to_string())
        },
    };
    let gate = finding.gate;
    let finding = with_what_is_asked(case, checked, &picture, finding);
    with_evidence(case, checked, CaseResult { gate, ..finding }, picture, None)
}

/// The `finding` on `picture` as the result of `case`, with a note on what its precision hides.
fn with_evidence(
    case: &Case,
    checked: &CheckedGolden,
    mut finding: CaseResult,
    picture: Picture,
    at_step: Option<Film>,
) -> Judged {
    let film = picture.radiance();
    let note = film.and_then(|film| precision_in_words(finding.gate, &finding.metrics, film));
    finding.notes.extend(note);
    let gate = finding.gate;
    Judged {
        result: finding.of_case(&case.name, case.class(), gate),
        evidence: Evidence {
            test: Some(picture),
            at_step,
            ..evidence(case, checked)
        },
    }
}

/// `finding` with the depth of `picture`, where the case asks for depth; and with notes on results that are asked for
/// and not there.
fn with_what_is_asked(
    case: &Case,
    checked: &CheckedGolden,
    picture: &Picture,
    mut finding: CaseResult,
) -> CaseResult {
    let film = picture.radiance();
    if case.opacity && film.and_then(Film::opacity).is_none() {
        finding.notes.push("the case asks for opacity as well, and the image has no fourth channel: colours alone were compared".to_owned());
    }
    let Some(asked) = case.depth else {
        return finding;
    };
    let Some((film, depth)) = film.and_then(|film| Some((film, film.depth()?))) else {
        finding.notes.push(format!(
            "the case asks for {asked} depth as well, and the image has none: write the channel Z of an .exr, or {}.depth.npy",
            case.name
        ));
        return finding;
    };
    if finding.verdict != Verdict::Pass {
        return finding;
    }
    let compared = DepthComparison {
        scene: &checked.scene,
        opacity: checked.golden.film.opacity(),
        width: film.width(),
        step: checked.longest_step(),
    };
    let right = match compared.right(asked) {
        Ok(right) => right,
        Err(reason) => {
            let reason = format!("depth cannot be judged: {reason}");
            return CaseResult {
                notes: finding.notes,
                ..CaseResult::new(Verdict::Error, Cause::BadInput, reason)
            };
        }
    };
    let found = compared.of(&right, depth);
    let outliers = OUTLIERS_OF_DEPTH.0.to_owned();
    finding.metrics.insert(outliers, found.outside as f64);
    if found.agrees() {
        return finding;
    }
    let mut reason = format!("the image agrees; {}", found.in_words(film.width()));
    reason.push_str(&match depth::cause(&compared, asked, depth) {
        Some(cause) => format!("; it is {cause}"),
        None => "; write distances from the eye, in world units".to_owned(),
    });
    CaseResult {
        metrics: finding.metrics,
        notes: finding.notes,
        // Nothing that is looked for moves depth alone.
        cause_is_said: true,
        ..CaseResult::new(Verdict::Fail, Cause::Mismatch, reason)
    }
}

/// Judges images with the step of the scene of `case`, half of it, a quarter and so on.
fn validate_refined(case: &Case, checked: &CheckedGolden, images: Vec<Picture>) -> Judged {
    let images = images.into_iter();
    let images = images.map(|image| known_radiance(case, &checked.golden.film, image));
    let mut images: Vec<Film> = images.collect();
    // 8 bits hide what smaller steps change.
    if images.iter().any(|image| image.quantisation().is_some()) {
        return validate_with(case, checked, Picture::Radiance(images.swap_remove(0)));
    }
    let judgement = refinement::judge(checked, &images);
    // Images that nobody sees, such as a limit by extrapolation, are evidence of nothing.
    let seen = Picture::Radiance(images[images.len() - 1].clone());
    let finding = with_words(case, checked, judgement, &seen);
    with_evidence(case, checked, finding, seen, images.into_iter().next())
}

/// The image that `picture` is compared with. The mean of samples is compared with the mean of their
/// distribution, where that is known: it has no noise that could hide a bias.
fn reference(case: &Case, checked: &CheckedGolden, picture: &Picture) -> Film {
    let golden = &checked.golden.film;
    let is_sampled = matches!(picture, Picture::Radiance(test) if test.noise().is_some());
    match (case.truth, &case.answer) {
        _ if is_noisy(case, checked, picture) => golden.clone().known(),
        // Another image, rendered under the conventions of a profile.
        _ if checked.profile.is_some() || !is_sampled => golden.clone(),
        (Some(_), _) => golden.clone().known(),
        (None, Some(answer)) => answer.image(golden.width(), golden.height()).known(),
        (None, None) => golden.clone(),
    }
}

/// True if `picture` is a mean of samples that states no noise, of a scene that volref integrates without any: light in
/// media, where other renderers take samples. Its noise is estimated then.
fn is_noisy(case: &Case, checked: &CheckedGolden, picture: &Picture) -> bool {
    let golden = &checked.golden.film;
    let mut panels = checked.scene.panels.iter();
    let Picture::Radiance(test) = picture else {
        return false;
    };
    let may_be = panels.all(|panel| matches!(panel.model, Model::Radiative(_)))
        && golden.noise().is_none()
        && test.noise().is_none()
        && golden.is_comparable(test);
    may_be && !agrees(case, checked, test) && is_off_by_noise(golden, test)
}

fn evidence(case: &Case, checked: &CheckedGolden) -> Evidence {
    let answer = case.answer.as_ref();
    let answer = answer.map(|answer| ("known answer".to_owned(), answer.to_string()));
    Evidence {
        provenance: checked.provenance().into_iter().chain(answer).collect(),
        golden: Some(checked.golden.film.clone()),
        ..Evidence::of(case)
    }
}

/// True if `film`, read in another way than it was judged, agrees.
fn agrees(case: &Case, checked: &CheckedGolden, film: &Film) -> bool {
    let golden = &checked.golden.film;
    if !golden.is_comparable(film) {
        return false;
    }
    let [golden, film] = [golden, film].map(|film| Picture::Radiance(film.clone()));
    let judgement = judged(case, checked, &golden, &film);
    judgement.is_ok_and(|judgement| judgement.passed && judgement.undecided.is_none())
}

/// Judges `picture` by `golden`. An image that states its noise is judged by the stochastic gate, even in a deterministic
/// case.
fn judged(
    case: &Case,
    checked: &CheckedGolden,
    golden: &Picture,
    picture: &Picture,
) -> Result<Judgement, PictureError> {
    let has_step = case.is_limit() && checked.profile.is_none();
    match (default_gate(golden, picture).0, picture.radiance()) {
        (Gate::Deterministic, Some(image)) if has_step => Ok(refinement::judge_one(checked, image)),
        (gate, _) => judge(gate, golden, picture, &checked.conditions(case)),
    }
}

/// The finding of `judgement` on `picture`, with measurements of a whole image that fails, and the exposure of the case
/// where that counts, unless nothing was drawn.
fn with_words(
    case: &Case,
    checked: &CheckedGolden,
    judgement: Judgement,
    picture: &Picture,
) -> CaseResult {
    let stops = ["stops", "stop"][usize::from(case.exposure.abs() == 1.0)];
    let exposure = format!("; exposure of the case: {} {stops}", case.exposure);
    let mut exposure = (judgement.gate == Gate::Perceptual).then_some(exposure);
    let mut finding = CaseResult::from(judgement);
    if finding.verdict == Verdict::Fail {
        // What holds for the whole image comes first: it explains what the gate saw.
        let mut readings =
            other_readings(case, (&checked.golden.film, &checked.scene), picture).into_iter();
        let right = readings.find(|reading| agrees(case, checked, &reading.film));
        // A factor would be the reading, measured.
        let gain = gain(case, &checked.golden.film, picture).filter(|_| right.is_none());
        // In a file made for a display a plain factor means another exposure first.
        finding.cause_is_said = right.is_some() || gain.is_some() && is_of_png(picture);
        let mut said = Vec::from_iter(codes_in_words(picture));
        said.extend(gain);
        let nothing = nothing_drawn(case, &checked.scene, &checked.golden.film, picture);
        if let Some(nothing) = nothing.filter(|_| right.is_none()) {
            // No number of the scene is measured by what is not there, and nothing is searched.
            finding.reason = nothing;
            finding.cause_is_said = true;
            (finding.changes, exposure) = (Vec::new(), None);
        } else {
            said.extend(right.map(|reading| reading.words));
            said.push(finding.reason);
            finding.reason = said.join("; ");
        }
    }
    finding.reason.extend(exposure);
    finding
}

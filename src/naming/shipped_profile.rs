//! A profile that volref brings as the explanation of an image: judged as `validate --as` judges it.
//!
//! The [search](super::convention_search) knows single choices. A renderer as it comes also rounds and
//! places its samples in ways that are no choices of the search, and only its profile as a whole states them.

use crate::compare::unexplained::makes_what_shows;
use crate::compare::{Conditions, Deterministic, Picture, judge};
use crate::conventions::{PLACES, Profile};
use crate::film::{Origin, Quantisation};
use crate::judging::nothing_drawn::background;
use crate::judging::{Judged, Verdict, radiance_of_codes, validate};
use crate::scene::{Panel, Scene};
use crate::suite::{Case, Output, Store};

/// A profile that volref brings, by its name.
pub type NamedProfile = (&'static str, Profile);

/// Largest number of samples for which a profile is tried: some seconds of work.
const MOST_SAMPLES: f64 = 2.5e9;

/// The first of the profiles of these `names`, of renderers of 8 bits, under which the images behind `judged`
/// pass. The work of each is counted, so that no verdict depends on the machine or on other cases.
pub fn passing(
    names: impl Iterator<Item = &'static str>,
    case: &Case,
    store: &Store,
    scene: &Scene,
    judged: &Judged,
) -> Option<NamedProfile> {
    // With half the step, a quarter and so on.
    let steps = ((1_u64 << judged.evidence.refined.len().clamp(1, 32)) - 1) as f64;
    let mut profiles = names.filter_map(|name| Some((name, Profile::named(name).ok()?)));
    profiles.find(|(_, profile)| {
        let Some(output) = output_of(judged, profile, case.exposure) else {
            return false;
        };
        if steps * samples_under(profile, scene) > MOST_SAMPLES {
            return false;
        }
        let judged_by = |profile| validate(case, store, output.clone(), profile);
        let passes = |judged: &Judged| judged.result.verdict == Verdict::Pass;
        let under_profile = judged_by(Some(profile));
        // Not of an image that is right but for the curve of its codes, which the verdict says.
        passes(&under_profile)
            && makes_what_shows_in(&under_profile, scene)
            && !are_alike(judged, &under_profile)
            && !passes(&judged_by(None))
    })
}

/// True if the right image by which `judged` passed makes what its image shows of `scene`.
fn makes_what_shows_in(judged: &Judged, scene: &Scene) -> bool {
    let right = judged.evidence.golden.as_ref();
    let images = judged.evidence.images();
    let known = right.zip(images.first()).zip(background(scene));
    known.is_some_and(|((right, test), nothing)| makes_what_shows(right, test, &nothing))
}

/// Samples in the images that `validate` renders of `scene` under `profile`, if all rays cross the volumes along
/// their diagonals.
fn samples_under(profile: &Profile, scene: &Scene) -> f64 {
    let of_panel = |panel: &Panel| {
        let volume = panel.classified()?;
        let images = if volume.conventions.is_random() {
            f64::from(PLACES)
        } else {
            1.0
        };
        Some((panel.width * panel.height) as f64 * volume.diagonal() / volume.step * images)
    };
    let under = profile.applied_to(scene).ok().flatten();
    under.map_or(0.0, |scene| scene.panels.iter().filter_map(of_panel).sum())
}

/// True if the right images by which both were judged pass for each other: then a profile explains nothing.
fn are_alike(first: &Judged, second: &Judged) -> bool {
    let right = |judged: &Judged| Some(Picture::Radiance(judged.evidence.golden.clone()?));
    let [Some(first), Some(second)] = [first, second].map(right) else {
        return false;
    };
    let judgement = judge(&Deterministic, &first, &second, &Conditions::default());
    judgement.is_ok_and(|judgement| judgement.passed)
}

/// The images behind `judged` in the precision of `profile`; `None` if they have another, or if there are none.
fn output_of(judged: &Judged, profile: &Profile, exposure: f64) -> Option<Output> {
    let of = |picture: Picture| in_precision_of(profile, picture, exposure);
    let evidence = &judged.evidence;
    if evidence.refined.is_empty() {
        return Some(Output::Picture(Box::new(of(evidence.test.clone()?)?)));
    }
    let refined = evidence.refined.iter().cloned().map(Picture::Radiance);
    Some(Output::Refined(refined.map(of).collect::<Option<_>>()?))
}

/// `picture` with the codes of `profile`; `None` if it has others. What a renderer of 8 bits may be off by is
/// forgiven in images of 8 bits alone.
fn in_precision_of(profile: &Profile, picture: Picture, exposure: f64) -> Option<Picture> {
    let bits = profile.bits?;
    let film = match picture {
        Picture::Radiance(film) => film,
        Picture::Codes(codes) => radiance_of_codes(&codes, bits, exposure),
    };
    let of_codes = |it: Quantisation| it.encoding == bits.encoding.unwrap_or(it.encoding);
    let quantisation = match film.quantisation() {
        Some(known) if of_codes(known) => known,
        // Codes of a PNG were read as sRGB where nobody said which curve they have.
        Some(known) if known.origin == Origin::Png => {
            let film = known.read_as(bits.encoding?, &film);
            return in_precision_of(profile, Picture::Radiance(film), exposure);
        }
        Some(_) => return None,
        None => {
            let found = bits.of_radiance(&film, exposure).ok();
            found.filter(|it| it.origin != Origin::Assumed)?
        }
    };
    let blended = bits.blended;
    let quantisation = Quantisation {
        blended,
        ..quantisation
    };
    Some(Picture::Radiance(film.quantised(quantisation)))
}

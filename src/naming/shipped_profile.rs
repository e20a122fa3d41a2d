//! A profile that volref brings as the explanation of an image: judged as `validate --as` judges it.
//!
//! The [search](super::convention_search) knows single choices. A renderer as it comes also rounds and
//! places its samples in ways that are no choices of the search, and only its profile as a whole states them.

use super::convention_search::attempt::{LATTICE, MOST_OUTSIDE, Residual};
use super::convention_search::images::Images;
use super::diagnosis::{Stage, lattice_of, pixels_of};
use crate::compare::unexplained::makes_what_shows;
use crate::compare::{Conditions, Gate, Picture, judge};
use crate::conventions::{Profile, bounds, scenes_by_chance};
use crate::film::{Film, Origin, Quantisation};
use crate::judging::nothing_drawn::background;
use crate::judging::{Judged, Verdict, validate, within};
use crate::scene::Scene;
use crate::suite::{Case, Output, Store};

/// A profile that volref brings, by its name.
pub type NamedProfile = (&'static str, Profile);

/// The first of the profiles that volref brings, of renderers of 8 bits, under which the image behind `judged`
/// passes. Their work counts as that of `images`, so that no verdict depends on the machine or on other cases.
pub fn passing(
    case: &Case,
    store: &Store,
    judged: &Judged,
    images: &Images<'_>,
) -> Option<NamedProfile> {
    let scene = images.scene;
    let count = Profile::shipped().count();
    for (tried, name) in Profile::shipped().enumerate() {
        images.clock.report(Stage::Profiles, tried, count);
        let Ok(profile) = Profile::named(name) else {
            continue;
        };
        let evidence = &judged.evidence;
        let at_step = evidence.at_step.clone().map(Picture::Radiance);
        let picture = at_step.or_else(|| evidence.test.clone());
        let of_profile = picture.and_then(|it| in_precision_of(&profile, it, case.exposure));
        let Some(test) = of_profile.filter(|test| is_near(test, &profile, scene, images)) else {
            continue;
        };
        let picture = Picture::Radiance(test);
        let output = || Output::Picture(Box::new(picture.clone()));
        let judged_by = |profile| validate(case, store, output(), profile);
        let passes = |judged: &Judged| judged.result.verdict == Verdict::Pass;
        let under_profile = judged_by(Some(&profile));
        // Not of an image that is right but for the curve of its codes, which the verdict says.
        let explains = passes(&under_profile)
            && makes_what_shows_in(&under_profile, scene)
            && !are_alike(judged, &under_profile);
        if explains && !passes(&judged_by(None)) {
            return Some((name, profile));
        }
    }
    None
}

/// True if the right image by which `judged` passed makes what its image shows of `scene`.
fn makes_what_shows_in(judged: &Judged, scene: &Scene) -> bool {
    let right = judged.evidence.golden.as_ref();
    let known = right.zip(judged.evidence.image()).zip(background(scene));
    known.is_some_and(|((right, test), nothing)| makes_what_shows(right, &test, &nothing))
}

/// True if few pixels do not rule out `profile`, and the whole image may be rendered within the limit of the work,
/// which counts it.
fn is_near(test: &Film, profile: &Profile, scene: &Scene, images: &Images<'_>) -> bool {
    let Ok(Some(under)) = profile.applied_to(scene) else {
        return false;
    };
    let pixels = test.width() * test.height();
    let lattice = lattice_of(pixels, LATTICE);
    let on_lattice = pixels_of(test, scene, lattice);
    let before = images.clock.work();
    let scenes = scenes_by_chance(&under).unwrap_or_else(|| vec![under]);
    let right = scenes.iter().map(|scene| images.of_scene(scene, lattice));
    let Some(right) = right.collect::<Option<Vec<Film>>>() else {
        return false;
    };
    let nearest = within(&bounds(&right), &on_lattice);
    if Residual::of(&nearest, &on_lattice).outside > MOST_OUTSIDE {
        return false;
    }
    let share = on_lattice.radiance().len() as f64 / pixels as f64;
    let of_lattice = (images.clock.work() - before) as f64;
    images.clock.spend((of_lattice / share) as u64)
}

/// True if the right images by which both were judged pass for each other: then a profile explains nothing.
fn are_alike(first: &Judged, second: &Judged) -> bool {
    let right = |judged: &Judged| Some(Picture::Radiance(judged.evidence.golden.clone()?));
    let [Some(first), Some(second)] = [first, second].map(right) else {
        return false;
    };
    let judgement = judge(Gate::Deterministic, &first, &second, &Conditions::default());
    judgement.is_ok_and(|judgement| judgement.passed)
}

/// `picture` with the codes of `profile`; `None` if it has others. What a renderer of 8 bits may be off by is
/// forgiven in images of 8 bits alone.
fn in_precision_of(profile: &Profile, picture: Picture, exposure: f64) -> Option<Film> {
    let bits = profile.bits?;
    let film = match picture {
        Picture::Radiance(film) => film,
        Picture::Codes(codes) => codes.radiance(bits, exposure),
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
    Some(film.quantised(quantisation))
}

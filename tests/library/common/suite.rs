//! The suite, its images, and what is said of others.

pub use super::simulated::silent;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::Duration;
use volref::compare::Picture;
use volref::film::Film;
use volref::judging::{CaseResult, Judged, validate};
use volref::naming::{Predictions, Search, diagnosis};
use volref::render::{Sampling, Seed, plans, render};
use volref::scene::Scene;
use volref::suite::{Case, Output, Suite};

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The suite of the repository, opened once.
pub fn suite() -> &'static Suite {
    static SUITE: LazyLock<Suite> = LazyLock::new(|| Suite::open(root()).unwrap());
    &SUITE
}

pub fn case_of(name: &str) -> &'static Case {
    cases_of(name)[0]
}

/// The cases that a filter selects.
pub fn cases_of(filter: &str) -> Vec<&'static Case> {
    suite().select(&[filter.to_owned()]).unwrap()
}

/// The scene in a file of `fixtures/scenes`.
pub fn scene_of(name: &str) -> Scene {
    Scene::load(&root().join(format!("fixtures/scenes/{name}.toml"))).unwrap()
}

/// The files of `fixtures/scenes`, with the names of their scenes, in order.
pub fn scene_files() -> Vec<(String, PathBuf)> {
    let root = root().join("fixtures/scenes");
    let mut found = Vec::new();
    for family in std::fs::read_dir(&root).unwrap() {
        for file in std::fs::read_dir(family.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            if path
                .extension()
                .is_some_and(|extension| extension == "toml")
            {
                let name = path.strip_prefix(&root).unwrap().with_extension("");
                found.push((name.to_str().unwrap().replace('\\', "/"), path));
            }
        }
    }
    found.sort_by(|(_, a), (_, b)| a.cmp(b));
    assert!(
        found.len() > 130,
        "a walk that finds nothing finds no fault either"
    );
    found
}

/// The image of a scene, with the samples and the seed that it states.
pub fn film_of(scene: &Scene) -> Film {
    let rendering = render(&plans(scene), Sampling::default(), &|| ());
    rendering.unwrap().film
}

/// The image of a scene with so many samples.
pub fn film_with(scene: &Scene, samples: u32, seed: u64) -> Film {
    let sampling = Sampling {
        samples: Some(samples),
        seed: Seed::Given(seed),
    };
    render(&plans(scene), sampling, &|| ()).unwrap().film
}

pub fn golden_of(name: &str) -> Film {
    let file = root().join(format!("golden/{name}.exr"));
    Film::from_exr(&std::fs::read(file).unwrap()).unwrap()
}

pub fn output_of(film: Film) -> Output {
    Output::Picture(Box::new(Picture::Radiance(film)))
}

/// The verdict on an image of a case.
pub fn validated(case: &Case, film: Film) -> Judged {
    validate(case, &suite().store(), output_of(film), None)
}

/// A search with this much work that nobody ends.
pub fn uninterrupted(budget: Option<Duration>, predictions: &Predictions) -> Search<'_> {
    Search {
        budget,
        predictions,
        interrupted: &|| false,
        progress: &|_| (),
    }
}

/// The verdict, with the causes that a search without limit finds.
pub fn searched(case: &Case, film: Film) -> CaseResult {
    let judged = validated(case, film);
    explained(case, judged, &uninterrupted(None, &Predictions::default()))
}

/// The verdict, with the causes that `search` finds.
pub fn explained(case: &Case, judged: Judged, search: &Search<'_>) -> CaseResult {
    let mut judged = [judged];
    diagnosis(&[case], None, &mut judged, search);
    let [judged] = judged;
    judged.result
}

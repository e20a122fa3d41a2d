//! The suite, its images, and what is said of others.

use std::path::Path;
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

pub fn suite() -> Suite {
    Suite::open(root()).unwrap()
}

pub fn case_of(name: &str) -> Case {
    suite().select(&[name.to_owned()]).unwrap()[0].clone()
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

/// The film without what it states of its noise.
pub fn silent(film: &Film) -> Film {
    Film::new(film.width(), film.height(), film.radiance().to_vec())
}

pub fn output_of(film: Film) -> Output {
    Output::Picture(Box::new(Picture::Radiance(film)))
}

/// The verdict on an image of a case.
pub fn validated(case: &Case, film: Film) -> Judged {
    validate(case, &suite().store(), output_of(film), None)
}

/// The verdict, with the causes that a search without limit finds.
pub fn searched(case: &Case, film: Film) -> CaseResult {
    let mut judged = [validated(case, film)];
    let search = Search {
        budget: None,
        predictions: &Predictions::default(),
        interrupted: &|| false,
        progress: &|_| (),
    };
    diagnosis(&[case], None, &mut judged, &search);
    let [judged] = judged;
    judged.result
}

//! Images in which nothing, or all but nothing, was drawn.
//!
//! Such an image agrees with any other dark one, so that it has no other cause: nothing is measured of it, and nothing
//! is searched.

use crate::compare::Picture;
use crate::compare::deterministic::tolerance;
use crate::compare::opacity;
use crate::compare::unexplained::{UNEXPLAINED, squared_difference};
use crate::film::Film;
use crate::scene::{Model, Scene};
use crate::suite::Case;
use crate::variations::edited_film::mapped;

/// The image of `scene` in which nothing is drawn; `None` of one without background.
pub(crate) fn background(scene: &Scene) -> Option<Film> {
    let mut row = Vec::new();
    for panel in &scene.panels {
        let background = match &panel.model {
            Model::Classified(volume) => volume.background,
            Model::Radiative(scene) => scene.environment,
            Model::Curve(_) => return None,
        };
        let [r, g, b] = background.as_vec3().to_array();
        row.extend(std::iter::repeat_n([r, g, b, 0.0], panel.width));
    }
    let pixels = row.repeat(scene.height());
    Some(Film::with_opacity(row.len(), scene.height(), pixels))
}

/// Statement that `picture`, which failed by `golden`, shows nothing of `scene` but its background, or all but nothing.
///
/// The latter is within the tolerance of the background in every pixel, with one code more where it holds codes, the
/// least that they can show; and what it shows is no more of its difference from the golden than any explanation may
/// leave ([`UNEXPLAINED`]). An opacity that it states has to be as empty.
pub(crate) fn nothing_drawn(
    case: &Case,
    scene: &Scene,
    golden: &Film,
    picture: &Picture,
) -> Option<String> {
    let film = picture.film(case.exposure);
    let background = background(scene).filter(|background| background.is_comparable(&film))?;
    if !is_opacity_empty(&film) {
        return None;
    }
    let black = mapped(&background, |_, _| (0.0, 0.0));
    // Some programs leave the background out.
    let empty = [(&background, "the background"), (&black, "black")];
    empty.into_iter().find_map(|(empty, name)| {
        let [shown, lacking] = [empty, golden].map(|of| squared_difference(of, &film));
        let is_little = lacking > 0.0 && shown <= UNEXPLAINED * lacking;
        let words = || format!("nothing was drawn: every pixel is {name}, within its tolerance");
        (is_little && is_like(&film, empty)).then(words)
    })
}

/// True if no value of `film` is off from `empty` by more than its tolerance and a code.
fn is_like(film: &Film, empty: &Film) -> bool {
    let codes = film.quantisation();
    let [values, nothings] = [film, empty].map(|film| film.radiance().as_flattened());
    values.iter().zip(nothings).all(|(&value, &nothing)| {
        let [value, nothing] = [value, nothing].map(f64::from);
        let half_code = codes.map_or(0.0, |it| it.half_code(nothing));
        (value - nothing).abs() <= tolerance(nothing) + 2.0 * half_code
    })
}

/// True if `film`, an image of `scene`, is its background within the tolerance of each pixel.
pub(super) fn shows_nothing(film: &Film, scene: &Scene) -> bool {
    background(scene).is_some_and(|empty| is_like(film, &empty))
}

/// True if `film` states no opacity, or one of nothing.
fn is_opacity_empty(film: &Film) -> bool {
    // As the gate has it, and one code, which is twice its rounding.
    let most = tolerance(0.0) + 2.0 * opacity::rounding(film);
    let stated = opacity::stated(film).unwrap_or_default();
    stated.iter().all(|&opacity| f64::from(opacity) <= most)
}

//! Images as they are declared: of 8 bits, or without the background of their scene.

use crate::compare::{Picture, recognised};
use crate::film::{Alpha, Bits, Encoding, Film, Origin, Quantisation};
use crate::scene::{Model, Scene};
use crate::suite::{Case, Output};

/// `output` for `case`, with its images declared to have these bits; unusable where they have others.
pub fn declared(output: Output, bits: Option<Bits>, case: &Case) -> Output {
    let Some(bits) = bits else {
        return output;
    };
    output.edited(|picture| {
        let film = radiance(picture, bits, case.exposure);
        let film = film.map_err(|error| format!("the image of {}: {error}", case.name))?;
        Ok(Picture::Radiance(film))
    })
}

/// `output` for `case`, with its images declared to be colours without the background of their scene. An image of 8 bits
/// is recognised before that.
pub(crate) fn before_background(output: Output, alpha: Option<Alpha>, case: &Case) -> Output {
    let Some(alpha) = alpha else {
        return output;
    };
    // A fault is said where the scene is judged.
    let Ok(scene) = case.load_scene() else {
        return output;
    };
    let mut panels = scene.panels.iter();
    let has_volume = panels.any(|panel| panel.classified().is_some());
    let has_none = |picture: &Picture| picture.radiance().and_then(Film::opacity).is_none();
    if has_volume && matches!(&output, Output::Picture(picture) if has_none(picture)) {
        return Output::Unusable(format!(
            "the image has no opacity, and --alpha {alpha} is declared: write the fourth channel of an .exr or .npy, \
             or leave --alpha out where colours contain the background"
        ));
    }
    output.edited(|picture| match picture {
        Picture::Radiance(film) => Ok(Picture::Radiance(with_background(film, alpha, &scene))),
        codes => Ok(codes),
    })
}

/// `film`, whose colours are declared to be `alpha`, before the background of `scene`.
fn with_background(film: Film, alpha: Alpha, scene: &Scene) -> Film {
    let background = backgrounds(scene);
    let columns = film.width().max(1);
    let quantisation = film.quantisation();
    let quantisation = quantisation.or_else(|| Quantisation::recognised(&film, 0.0));
    let behind = |index: usize| background.get(index % columns).copied().unwrap_or_default();
    let film = film.before(alpha, behind);
    let blended = quantisation.map(|it| Quantisation {
        blended: true,
        ..it
    });
    match blended {
        Some(quantisation) => film.quantised(quantisation),
        None => film,
    }
}

/// Background of each column of the image: black where no classified volume is.
fn backgrounds(scene: &Scene) -> Vec<[f64; 3]> {
    let columns = scene.panels.iter().flat_map(|panel| {
        let background = match &panel.model {
            Model::Classified(volume) => volume.background.to_array(),
            _ => [0.0; 3],
        };
        std::iter::repeat_n(background, panel.width)
    });
    columns.collect()
}

/// The radiance of `picture`, whose bits are declared; codes are at `exposure` stops.
///
/// # Errors
///
/// If a value is no code of these bits.
pub fn radiance(picture: Picture, bits: Bits, exposure: f64) -> Result<Film, String> {
    match picture {
        Picture::Radiance(film) if film.quantisation().is_some() => Ok(film),
        Picture::Radiance(film) => {
            let quantisation = bits.of_radiance(&film, exposure)?;
            Ok(film.quantised(quantisation))
        }
        Picture::Codes(codes) => Ok(codes.radiance(bits, exposure)),
    }
}

/// The radiance of an image of `case`, with what is known of its precision; of a PNG that of its sRGB codes.
pub(super) fn known_radiance(case: &Case, golden: &Film, picture: Picture) -> Film {
    recognised(golden, picture.film(case.exposure), case.exposure)
}

/// Another way to read an image.
pub(super) struct Reading {
    /// The image, read so.
    pub film: Film,
    /// Statement, without a full stop, on an image that agrees if read so.
    pub words: String,
}

/// Other ways to read `picture`, an image of `case`, likely ones first.
pub(super) fn other_readings(
    case: &Case,
    (golden, scene): (&Film, &Scene),
    picture: &Picture,
) -> Vec<Reading> {
    let mut readings = Vec::new();
    if let Picture::Radiance(film) = picture
        && golden.is_comparable(film)
    {
        readings.extend(of_whole_numbers(film));
        readings.extend(rounded_down(golden, film));
        readings.extend(without_background(film, scene));
    }
    readings.extend(other_encoding(case, picture));
    readings
}

/// Codes from 0 to 255 that were written as numbers.
fn of_whole_numbers(film: &Film) -> Vec<Reading> {
    let films = Quantisation::of_whole_numbers(film).into_iter().flatten();
    let read = ["divided by 255", "divided by 255 and decoded from sRGB"];
    let readings = films.zip(read).map(|(film, read)| Reading {
        words: format!("the image agrees if its codes are {read}"),
        film,
    });
    readings.collect()
}

/// Codes that were cut down to whole numbers.
fn rounded_down(golden: &Film, film: &Film) -> Option<Reading> {
    Some(Reading {
        film: film.quantisation()?.rounded_down(golden, film)?,
        words: "the codes are rounded down, not to the nearest as floor(255 x + 1/2) is: the image agrees where half a code \
                is added"
            .to_owned(),
    })
}

/// Colours without the background of the scene.
fn without_background(film: &Film, scene: &Scene) -> Vec<Reading> {
    if film.opacity().is_none() {
        return Vec::new();
    }
    let reading = |alpha: Alpha| {
        let what = match alpha {
            Alpha::Premultiplied => "leave out the background of the scene",
            Alpha::Straight => {
                "are not multiplied by opacity, and leave out the background of the scene"
            }
        };
        Reading {
            film: with_background(film.clone(), alpha, scene),
            words: format!(
                "the colours {what}: the image agrees where that is declared with --alpha {alpha}"
            ),
        }
    };
    let readings = [Alpha::Premultiplied, Alpha::Straight].map(reading);
    // In front of black nothing is added, and nothing explained.
    let is_other = |reading: &Reading| reading.film.radiance() != film.radiance();
    readings.into_iter().filter(is_other).collect()
}

/// The codes of a PNG taken for those of the other curve.
fn other_encoding(case: &Case, picture: &Picture) -> Option<Reading> {
    let film = picture.film(case.exposure);
    let quantisation = film.quantisation().filter(|it| it.origin == Origin::Png)?;
    let encoding = match quantisation.encoding {
        Encoding::Linear => Encoding::Srgb,
        Encoding::Srgb => Encoding::Linear,
    };
    let bits = Bits {
        encoding: Some(encoding),
        blended: quantisation.blended,
    };
    Some(Reading {
        film: quantisation.read_as(encoding, &film),
        words: format!("the image agrees if its codes are declared with --bits {bits}"),
    })
}

/// An image of `case` with what is known of its precision. A PNG is judged by how it looks, but for a case without
/// a step: looks do not tell what an image converges to.
pub(super) fn known(case: &Case, golden: &Film, picture: Picture) -> Picture {
    match picture {
        Picture::Codes(codes) if !case.is_limit() => Picture::Codes(codes),
        picture => Picture::Radiance(known_radiance(case, golden, picture)),
    }
}

//! Media: what fills a shape, or all space.

use super::{Body, LARGEST_RADIANCE, place, radiance, shapes};
use crate::geometry::{Surface, length_of};
use crate::media::{Asymmetry, Coefficients, HenyeyGreenstein, Homogeneous};
use crate::scene::SceneError;
use crate::scene::files::Files;
use crate::scene::format::{Absent, Key, Kind, Literal, Range, Rule, Table};
use crate::scene::reader::Reader;

/// The declaration of `[[radiative.medium]]`.
pub(super) const MEDIUM: Table = Table {
    doc: "A participating medium, the same everywhere in a closed shape; without a shape it fills all space. Where media overlap, they add up.",
    keys: &[
        shapes::SPHERE,
        shapes::BOX,
        shapes::MESH,
        place::SCALE,
        place::ROTATE,
        place::TRANSLATE,
        Key {
            name: "sigma_a",
            kind: Kind::Colour(Range::at_least(0.0)),
            absent: Absent::Default(Literal::Vector([0.0; 3])),
            doc: "Absorption per world length.",
        },
        Key {
            name: "sigma_s",
            kind: Kind::Colour(Range::at_least(0.0)),
            absent: Absent::Default(Literal::Vector([0.0; 3])),
            doc: "Scattering per world length.",
        },
        Key {
            name: "sigma_t",
            kind: Kind::Colour(Range::at_least(0.0)),
            absent: Absent::Nothing,
            doc: "Extinction per world length, absorption and scattering together; goes with `albedo`.",
        },
        Key {
            name: "albedo",
            kind: Kind::Colour(Range::closed(0.0, 1.0)),
            absent: Absent::Nothing,
            doc: "Share of the extinction that scatters, sigma_s / sigma_t, in [0, 1]; to give coefficients, write `sigma_a` and `sigma_s`.",
        },
        Key {
            name: "emission",
            kind: Kind::Colour(Range::at_least(0.0)),
            absent: Absent::Default(Literal::Vector([0.0; 3])),
            doc: "Radiance sent out per world length.",
        },
        Key {
            name: "g",
            kind: Kind::Number(Range::open(-1.0, 1.0)),
            absent: Absent::Default(Literal::Number(0.0)),
            doc: "Mean cosine of the scattering angle (Henyey–Greenstein), between -1 and 1: positive is forward, 0 is every direction alike.",
        },
    ],
    rules: &[
        Rule::AtMostOne {
            what: "shape",
            keys: &["sphere", "box", "mesh"],
        },
        Rule::Apart([&["sigma_a", "sigma_s"], &["sigma_t", "albedo"]]),
        Rule::Together(&["sigma_t", "albedo"]),
    ],
};

/// Reads one `[[radiative.medium]]`.
pub(super) fn read(
    reader: &Reader<'_, '_>,
    files: &mut Files<'_>,
) -> Result<Body, Box<SceneError>> {
    let boundary = shapes::boundary(reader, files)?;
    let coefficients = coefficients(reader)?;
    let emission = radiance(reader, "emission")?;
    let asymmetry = Asymmetry::new(reader.number("g")?)
        .map_err(|error| reader.error("g", error.to_string()))?;
    let body = Body {
        boundary,
        medium: Homogeneous {
            coefficients,
            emission,
            phase: HenyeyGreenstein(asymmetry),
        },
        density: None,
    };
    check_brightness(&body).map_err(|(message, help)| reader.mistake("emission", message, help))?;
    Ok(body)
}

fn coefficients(reader: &Reader<'_, '_>) -> Result<Coefficients, Box<SceneError>> {
    let (key, sigma_a, sigma_s) = match reader.optional_vector("sigma_t")? {
        Some(sigma_t) => {
            let albedo = reader.vector("albedo")?;
            let sigma_s = sigma_t * albedo;
            // By difference: their sum is the extinction that was given.
            ("sigma_t", sigma_t - sigma_s, sigma_s)
        }
        None => {
            let sigma_a = reader.vector("sigma_a")?;
            ("sigma_a", sigma_a, reader.vector("sigma_s")?)
        }
    };
    // Finite and not negative by declaration, but their sum need not be finite.
    Coefficients::new(sigma_a, sigma_s).map_err(|error| {
        let message = format!("the coefficients are too large: {error}");
        let help = "give smaller coefficients, or choose another unit of length";
        reader.mistake(key, message, help)
    })
}

/// Refuses a medium whose own light may be more than an image holds: along a straight path it is
/// at most the emission times the path, and at most the emission over the extinction.
fn check_brightness(body: &Body) -> Result<(), (String, String)> {
    let across = body.boundary.as_ref().map_or(f64::INFINITY, |boundary| {
        length_of(boundary.bounds().size())
    });
    let (emission, sigma_t) = (body.medium.emission, body.medium.coefficients.sigma_t());
    let brightest = (0..3)
        .filter(|&channel| emission[channel] > 0.0)
        .map(|channel| emission[channel] * across.min(1.0 / sigma_t[channel]))
        // That of a medium without end and extinction is infinite, and another mistake.
        .filter(|radiance| radiance.is_finite() || across.is_finite())
        .fold(0.0, f64::max);
    if brightest <= LARGEST_RADIANCE {
        return Ok(());
    }
    let message = format!(
        "the medium sends out up to {brightest:.3e} towards the eye; an image holds at most \
         {LARGEST_RADIANCE:.3e}"
    );
    Err((message, "give a smaller emission or a smaller shape".into()))
}

//! Media: what fills a shape, or all space.

use super::{Body, densities, phases, shape_transform, shapes};
use crate::geometry::{Surface, length_of};
use crate::optics::{Asymmetry, Coefficients, Density, Field, Homogeneous, optical_depth};
use crate::scene::SceneResult;
use crate::scene::files::Files;
use crate::scene::format::{Key, Kind, Range, Rule, Table};
use crate::scene::reader::Reader;
use glam::DVec3;

/// The declaration of `[[radiative.medium]]`.
pub(super) const MEDIUM: Table = Table::new("A participating medium in a closed shape; without a shape it fills all space. It is homogeneous unless a density is given; then coefficients and emission are those of density 1, and the density is transformed with the shape. Overlapping media add up.").with(&[
    &shapes::CLOSED,
    &shape_transform::STEPS,
    &densities::DENSITIES,
    &phases::PHASES,
]).keys(&[
        Key::or("sigma_a", Kind::Colour(Range::NOT_NEGATIVE), "[0.0, 0.0, 0.0]")
            .doc("Absorption per world length."),
        Key::or("sigma_s", Kind::Colour(Range::NOT_NEGATIVE), "[0.0, 0.0, 0.0]")
            .doc("Scattering per world length."),
        Key::optional("sigma_t", Kind::Colour(Range::NOT_NEGATIVE))
            .doc("Extinction per world length, absorption and scattering together; goes with `albedo`."),
        Key::optional("albedo", Kind::Colour(Range::UNIT))
            .doc("Fraction of the extinction that scatters, sigma_s / sigma_t, in [0, 1]; to give coefficients, write `sigma_a` and `sigma_s`."),
        Key::or("emission", Kind::Colour(Range::NOT_NEGATIVE), "[0.0, 0.0, 0.0]")
            .doc("Radiance emitted per world length."),
]).rules(&[
    Rule::AtMostOne("shape", &["sphere", "box", "mesh"]),
    Rule::AtMostOne("density", &densities::KEYS),
    Rule::AtMostOne("phase function", &phases::KEYS),
    Rule::Apart([&["procedural"], &["sigma_a", "sigma_s", "sigma_t", "albedo"]]),
    Rule::Apart([&["procedural"], &["interpolation"]]),
    Rule::Apart([&["sigma_a", "sigma_s"], &["sigma_t", "albedo"]]),
    Rule::Together(&["sigma_t", "albedo"]),
]);

/// Reads one `[[radiative.medium]]`.
pub(super) fn read(reader: &Reader, files: &mut Files) -> SceneResult<Body> {
    // What a medium is made of may bring the space that it fills. Where it does not, the space is
    // read first: the order in which keys are read is part of what goldens know of a scene.
    let varies = reader.first_of(&densities::KEYS);
    let mut space = match varies {
        None => shapes::space(reader, files, None)?,
        Some(_) => None,
    };
    let (coefficients, field, asymmetry) = substance(reader, files)?;
    if varies.is_some() {
        let own = match &field {
            Some(Field::Grid(grid)) => Some(grid.bounds()),
            _ => None,
        };
        space = shapes::space(reader, files, own)?;
    }
    let emission = reader.get("emission")?;
    let phase = phases::read(reader, asymmetry)?;
    let density = match (field, &space) {
        (None, _) => None,
        (Some(field), Some(space)) => Some(Density::new(field, space.bounds, space.to_world)),
        (Some(_), None) => {
            let message = "a heterogeneous medium needs a shape: without one it is unbounded";
            let help = "give the medium a `box`, `sphere` or `mesh`";
            return Err(reader.mistake(varies.expect("its density"), message, help));
        }
    };
    let nothing = coefficients.sigma_t() == DVec3::ZERO && emission == DVec3::ZERO;
    if let (Some(key), true) = (varies, nothing) {
        let message = "the medium has a density but no coefficients, so it has no effect on light";
        let help = "give it `sigma_a`, `sigma_s` or `emission`, as they are where the density is 1";
        return Err(reader.mistake(key, message, help));
    }
    let body = Body {
        boundary: space.map(|space| space.boundary),
        medium: Homogeneous {
            coefficients,
            emission,
            phase,
        },
        density,
    };
    check_depth(reader, &body)?;
    Ok(body)
}

/// Absorption and scattering of density 1, the density if that varies, and the phase function if it is given with that.
fn substance(
    reader: &Reader,
    files: &mut Files,
) -> SceneResult<(Coefficients, Option<Field>, Option<Asymmetry>)> {
    let Some(block) = densities::procedural(reader, files)? else {
        let coefficients = coefficients(reader)?;
        return Ok((coefficients, densities::field(reader, files)?, None));
    };
    for reading in &block.readings {
        reader.also("procedural", reading);
    }
    let field = Field::Noise(block.density);
    Ok((block.coefficients, Some(field), block.asymmetry))
}

/// Optical depth up to which a heterogeneous medium is tracked. More tentative collisions
/// than this are not to be waited for, and not to be told apart by their distances.
pub(super) const DEEPEST_TRACKED: f64 = (1 << 24) as f64;

/// Refuses a medium whose density makes numbers leave their range, or collisions come closer than
/// they can be followed.
fn check_depth(reader: &Reader, body: &Body) -> SceneResult<()> {
    let (Some(density), Some(boundary)) = (&body.density, &body.boundary) else {
        return Ok(());
    };
    let range = density.range();
    let across = length_of(boundary.bounds().size());
    let sigma_t = body.medium.coefficients.sigma_t().max_element();
    let column = range.high * across;
    let depth = optical_depth(sigma_t, column);
    let scatters = body.sigma_s() != DVec3::ZERO;
    let tracked = range.low < range.high && (scatters || !density.is_integrable());
    let most = if tracked { DEEPEST_TRACKED } else { f64::MAX };
    if column.is_finite() && depth <= most {
        return Ok(());
    }
    let key = reader.first_of(&["sigma_t", "sigma_a", "sigma_s", "procedural"]);
    let message = format!(
        "the medium is up to {depth:.4e} optical depths thick, with a density of up to {:.4e} over a length of up to \
         {across:.4e}: light is traced through at most {most:.4e}",
        range.high
    );
    let help = "give smaller coefficients, densities or lengths";
    Err(reader.mistake(key.unwrap_or("sigma_a"), message, help))
}

fn coefficients(reader: &Reader) -> SceneResult<Coefficients> {
    let (key, sigma_a, sigma_s): (_, DVec3, DVec3) = match reader.get::<Option<DVec3>>("sigma_t")? {
        Some(sigma_t) => {
            let sigma_s = sigma_t * reader.get::<DVec3>("albedo")?;
            // By difference: their sum is the extinction that was given.
            ("sigma_t", sigma_t - sigma_s, sigma_s)
        }
        None => ("sigma_a", reader.get("sigma_a")?, reader.get("sigma_s")?),
    };
    // Finite and not negative by declaration, but their sum need not be finite.
    Coefficients::new(sigma_a, sigma_s).map_err(|error| {
        let message = format!("the coefficients are too large: {error}");
        let help = "give smaller coefficients, or choose another unit of length";
        reader.mistake(key, message, help)
    })
}

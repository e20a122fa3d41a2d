//! Point, spot and directional lights.

use super::radiance;
use super::shapes::FARTHEST;
use crate::geometry::Direction;
use crate::optics::{Directional, Light, Point, Spot, SpotError};
use crate::scene::SceneResult;
use crate::scene::format::{Key, Kind, Range, Rule, Table};
use crate::scene::reader::Reader;
use glam::DVec3;

/// The declaration of `[[radiative.light]]`.
pub(super) const LIGHT: Table =
    Table::new("A point, spot or directional light. Area lights are surfaces with an emitter.")
        .keys(&[
            Key::optional("point", Kind::Table(&POINT))
                .doc("Emits from a point in every direction."),
            Key::optional("spot", Kind::Table(&SPOT)).doc("Emits from a point into a cone."),
            Key::optional("directional", Kind::Table(&DIRECTIONAL))
                .doc("Emits from infinitely far away."),
        ])
        .rules(&[Rule::ExactlyOne(
            "kind of light",
            &["point", "spot", "directional"],
        )]);

const DIRECTIONAL: Table =
    Table::new("Emits from infinitely far away, in the same direction everywhere.").keys(&[
        Key::required("direction", Kind::Vector).doc("Direction of travel, any length but 0."),
        Key::required("irradiance", Kind::Colour(Range::at_least(0.0)))
            .doc("Irradiance on a plane perpendicular to the direction."),
    ]);

const SPOT: Table = Table::new("Emits from a point into a cone: fully within the inner angle from its axis, not at all from the outer angle on, and falling linearly in between.").keys(&[
    POSITION,
    Key::required("target", Kind::Vector)
        .doc("A point on the axis of the cone, other than `position`, world units."),
    INTENSITY,
    Key::required("inner_angle", Kind::Number(Range::closed(0.0, 180.0)))
        .doc("Half-angle of the cone that is lit fully, degrees; at most `outer_angle`."),
    Key::required("outer_angle", Kind::Number(Range::closed(0.0, 180.0)))
        .doc("Half-angle of the cone outside which nothing is lit, degrees; above 0."),
]);

const POINT: Table =
    Table::new("Emits from a point in every direction.").keys(&[POSITION, INTENSITY]);

const POSITION: Key =
    Key::required("position", Kind::Vector).doc("Position of the light, world units.");

const INTENSITY: Key = Key::required("intensity", Kind::Colour(Range::at_least(0.0)))
    .doc("Radiant intensity, power per steradian, on the axis of a spot: the irradiance at distance r is intensity / r².");

/// Reads one `[[radiative.light]]`.
pub(super) fn read(reader: &Reader) -> SceneResult<Light> {
    if let Some(point) = reader.table("point")? {
        return Ok(Light::Point(Point {
            position: position(&point)?,
            intensity: radiance(&point, "intensity")?,
        }));
    }
    if let Some(spot) = reader.table("spot")? {
        return read_spot(&spot).map(Light::Spot);
    }
    let directional = reader.table("directional")?.expect("one of the lights");
    let direction = Direction::of(directional.vector("direction")?).ok_or_else(|| {
        let message = "the direction of the light is the zero vector";
        directional.error("direction", message)
    })?;
    Ok(Light::Directional(Directional {
        direction,
        irradiance: radiance(&directional, "irradiance")?,
    }))
}

fn position(reader: &Reader) -> SceneResult<DVec3> {
    let position = reader.vector("position")?;
    if position.abs().max_element() <= FARTHEST {
        return Ok(position);
    }
    let message = format!(
        "the light is at {:?}, too far away to trace its light: coordinates up \
         to {FARTHEST:e} are accepted",
        position.to_array()
    );
    let help = "choose another unit of length; for a light infinitely far away use `directional`";
    Err(reader.mistake("position", message, help))
}

fn read_spot(reader: &Reader) -> SceneResult<Spot> {
    let (position, target) = (position(reader)?, reader.vector("target")?);
    let intensity = radiance(reader, "intensity")?;
    let angles = [reader.number("inner_angle")?, reader.number("outer_angle")?];
    Spot::new(position, target - position, intensity, angles).map_err(|error| {
        let key = match error {
            SpotError::NoDirection => "target",
            SpotError::Angles { .. } => "outer_angle",
        };
        reader.error(key, error.to_string())
    })
}

//! Point, spot and directional lights.

use crate::geometry::Direction;
use crate::optics::{Directional, Light, Point, Spot};
use crate::scene::SceneResult;
use crate::scene::format::{Key, Kind, Range, Rule, Table};
use crate::scene::reader::Reader;
use crate::scene::record::Record;
use glam::DVec3;

/// The declaration of `[[radiative.light]]`.
pub(super) const LIGHT: Table =
    Table::new("A point, spot or directional light. Area lights are surfaces with an emitter.")
        .keys(&[
            Key::optional("point", Kind::Table(&Point::TABLE))
                .doc("Emits from a point in every direction."),
            Key::optional("spot", Kind::Table(&SpotTable::TABLE))
                .doc("Emits from a point into a cone."),
            Key::optional("directional", Kind::Table(&DirectionalTable::TABLE))
                .doc("Emits from infinitely far away."),
        ])
        .rules(&[Rule::ExactlyOne(
            "kind of light",
            &["point", "spot", "directional"],
        )]);

record! {
    struct DirectionalTable in "Emits from infinitely far away, in the same direction everywhere." {
        direction: DVec3 = required Vector, "Direction of travel, any length but 0.";
        irradiance: DVec3 = required Colour(Range::NOT_NEGATIVE),
            "Irradiance on a plane perpendicular to the direction.";
    }
}

record! {
    struct SpotTable in "Emits from a point into a cone: fully within the inner angle from its axis, not at all from the outer angle on, and falling linearly in between." {
        position: DVec3 = required Vector, "Position of the light, world units.";
        target: DVec3 = required Vector, "A point on the axis of the cone, other than `position`, world units.";
        intensity: DVec3 = required Colour(Range::NOT_NEGATIVE),
            "Radiant intensity, power per steradian, on the axis of a spot: the irradiance at distance r is intensity / r².";
        inner_angle: f64 = required Number(Range::closed(0.0, 180.0)),
            "Half-angle of the cone that is lit fully, degrees; at most `outer_angle`.";
        outer_angle: f64 = required Number(Range::closed(0.0, 180.0)),
            "Half-angle of the cone outside which nothing is lit, degrees; above 0.";
    }
}

record! {
    impl Point in "Emits from a point in every direction." {
        position = required Vector, "Position of the light, world units.";
        intensity = required Colour(Range::NOT_NEGATIVE),
            "Radiant intensity, power per steradian, on the axis of a spot: the irradiance at distance r is intensity / r².";
    }
}

/// Reads one `[[radiative.light]]`.
pub(super) fn read(reader: &Reader) -> SceneResult<Light> {
    if let Some(table) = reader.table("point")? {
        return Ok(Light::Point(Point::read(&table)?));
    }
    if let Some(table) = reader.table("spot")? {
        let spot = SpotTable::read(&table)?;
        let axis = spot.target - spot.position;
        let angles = [spot.inner_angle, spot.outer_angle];
        let spot = Spot::new(spot.position, axis, spot.intensity, angles);
        return table.accepted(spot).map(Light::Spot);
    }
    let table = reader.table("directional")?.expect("one of the lights");
    let read = DirectionalTable::read(&table)?;
    let direction = Direction::of(read.direction).ok_or_else(|| {
        let message = "the direction of the light is the zero vector";
        table.error("direction", message)
    })?;
    Ok(Light::Directional(Directional {
        direction,
        irradiance: read.irradiance,
    }))
}

//! Surfaces: a shape with a material.

use super::{AreaLight, Object, radiance, shapes};
use crate::optics::{Material, Sides};
use crate::scene::SceneResult;
use crate::scene::files::Files;
use crate::scene::format::{Key, Kind, Range, Rule, Table, joined};
use crate::scene::reader::Reader;

/// The declaration of `[[radiative.surface]]`.
pub(super) const SURFACE: Table = Table::new("A surface: one shape and its material.")
    .keys(&KEYS)
    .rules(&[
        shapes::ONE_SHAPE,
        Rule::ExactlyOne("material", &["diffuse", "mirror", "glass", "emitter"]),
    ]);

const KEYS: [Key; 11] = joined(
    shapes::SURFACE_KEYS,
    [
        Key::optional("diffuse", Kind::Table(&DIFFUSE))
            .doc("Material: reflects with the same radiance in every direction."),
        Key::optional("mirror", Kind::Table(&MIRROR))
            .doc("Material: reflects as a perfect mirror."),
        Key::optional("glass", Kind::Table(&GLASS)).doc("Material: smooth, clear glass."),
        Key::optional("emitter", Kind::Table(&EMITTER)).doc("Material: emits light."),
    ],
);

const EMITTER: Table = Table::new("Emits light and reflects none.").keys(&[
    Key::required("radiance", Kind::Colour(Range::at_least(0.0)))
        .doc("Linear radiance, the same in every direction."),
    Key::or("sides", Kind::Choice(&["front", "both"]), "'front'")
        .doc("Sides that emit; the front of a closed shape is its outside."),
]);

const GLASS: Table =
    Table::new("Smooth, clear glass: reflects and refracts by Fresnel's equations.").keys(&[
        Key::required("index", Kind::Number(Range::open(0.0, f64::INFINITY)))
            .doc("Index of refraction of the inside relative to the outside, such as 1.5."),
    ]);

const MIRROR: Table =
    Table::new("Reflects as a perfect mirror, on both sides.").keys(&[REFLECTANCE]);

const DIFFUSE: Table =
    Table::new("Reflects with the same radiance in every direction (Lambert), on both sides.")
        .keys(&[REFLECTANCE]);

const REFLECTANCE: Key = Key::required("reflectance", Kind::Colour(Range::closed(0.0, 1.0)))
    .doc("Fraction of the light that is reflected, by channel, in [0, 1].");

/// A surface, of either kind.
pub(super) enum SurfaceKind {
    /// Scatters light.
    Object(Object),
    /// Emits light.
    AreaLight(AreaLight),
}

/// Reads one `[[radiative.surface]]`.
pub(super) fn read(reader: &Reader, files: &mut Files) -> SceneResult<SurfaceKind> {
    if let Some(emitter) = reader.table("emitter")? {
        let shape = shapes::luminous(reader, files)?;
        return Ok(SurfaceKind::AreaLight(AreaLight {
            shape,
            radiance: radiance(&emitter, "radiance")?,
            sides: match emitter.text("sides")?.as_str() {
                "both" => Sides::Both,
                _ => Sides::Front,
            },
        }));
    }
    let glass = reader.table("glass")?;
    let shape = shapes::shape(reader, files, glass.is_some())?;
    let material = if let Some(diffuse) = reader.table("diffuse")? {
        Material::Diffuse(diffuse.vector("reflectance")?)
    } else if let Some(mirror) = reader.table("mirror")? {
        Material::Mirror(mirror.vector("reflectance")?)
    } else {
        let glass = glass.expect("one of the materials");
        Material::Glass(glass.number("index")?)
    };
    Ok(SurfaceKind::Object(Object { shape, material }))
}

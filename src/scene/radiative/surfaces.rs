//! Surfaces: a shape, and what it does to light.

use super::{AreaLight, Object, radiance, shape_transform, shapes};
use crate::optics::{Material, Sides};
use crate::scene::SceneError;
use crate::scene::files::Files;
use crate::scene::format::{Absent, Key, Kind, Literal, Range, Rule, Table};
use crate::scene::reader::Reader;

/// The declaration of `[[radiative.surface]]`.
pub(super) const SURFACE: Table = Table {
    doc: "A surface: one shape, and what it does to light.",
    keys: &[
        shapes::RECTANGLE,
        shapes::SPHERE,
        shapes::BOX,
        shapes::MESH,
        shape_transform::SCALE,
        shape_transform::ROTATE,
        shape_transform::TRANSLATE,
        Key {
            name: "diffuse",
            kind: Kind::Table(&Table {
                doc: "Reflects with the same radiance in every direction (Lambert), on both sides.",
                keys: &[REFLECTANCE],
                rules: &[],
            }),
            absent: Absent::Nothing,
            doc: "Material: reflects with the same radiance in every direction.",
        },
        Key {
            name: "mirror",
            kind: Kind::Table(&Table {
                doc: "Reflects as a perfect mirror, on both sides.",
                keys: &[REFLECTANCE],
                rules: &[],
            }),
            absent: Absent::Nothing,
            doc: "Material: reflects as a perfect mirror.",
        },
        Key {
            name: "glass",
            kind: Kind::Table(&Table {
                doc: "Smooth, clear glass: reflects and refracts by Fresnel's equations.",
                keys: &[Key {
                    name: "index",
                    kind: Kind::Number(Range::open(0.0, f64::INFINITY)),
                    absent: Absent::Error,
                    doc: "Index of refraction of the inside relative to the outside, such as 1.5.",
                }],
                rules: &[],
            }),
            absent: Absent::Nothing,
            doc: "Material: smooth, clear glass.",
        },
        Key {
            name: "emitter",
            kind: Kind::Table(&Table {
                doc: "Emits light and reflects none.",
                keys: &[
                    Key {
                        name: "radiance",
                        kind: Kind::Colour(Range::at_least(0.0)),
                        absent: Absent::Error,
                        doc: "Linear radiance, the same in every direction.",
                    },
                    Key {
                        name: "sides",
                        kind: Kind::Choice(&["front", "both"]),
                        absent: Absent::Default(Literal::Text("front")),
                        doc: "Sides that emit; the front of a closed shape is its outside.",
                    },
                ],
                rules: &[],
            }),
            absent: Absent::Nothing,
            doc: "Material: emits light.",
        },
    ],
    rules: &[
        Rule::ExactlyOne {
            what: "shape",
            keys: &["rectangle", "sphere", "box", "mesh"],
        },
        Rule::ExactlyOne {
            what: "material",
            keys: &["diffuse", "mirror", "glass", "emitter"],
        },
    ],
};

const REFLECTANCE: Key = Key {
    name: "reflectance",
    kind: Kind::Colour(Range::closed(0.0, 1.0)),
    absent: Absent::Error,
    doc: "Share of the light that is reflected, by channel, in [0, 1].",
};

/// A surface, of either kind.
pub(super) enum SurfaceKind {
    /// Scatters light.
    Object(Object),
    /// Emits light.
    AreaLight(AreaLight),
}

/// Reads one `[[radiative.surface]]`.
pub(super) fn read(
    reader: &Reader<'_, '_>,
    files: &mut Files<'_>,
) -> Result<SurfaceKind, Box<SceneError>> {
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

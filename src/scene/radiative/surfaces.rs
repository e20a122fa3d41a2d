//! Surfaces: a shape with a material.

use super::{AreaLight, Object, Radiative, shapes};
use crate::optics::{Material, Sides};
use crate::scene::SceneResult;
use crate::scene::files::Files;
use crate::scene::format::{Key, Kind, Range, Rule, Table};
use crate::scene::reader::Reader;
use crate::scene::record::{Choice, Record};
use glam::DVec3;

/// The declaration of `[[radiative.surface]]`.
pub(super) const SURFACE: Table = Table::new("A surface: one shape and its material.")
    .with(&shapes::SURFACE_KEYS)
    .keys(&[
        Key::optional("diffuse", Kind::Table(&DIFFUSE))
            .doc("Material: reflects with the same radiance in every direction."),
        Key::optional("mirror", Kind::Table(&MIRROR))
            .doc("Material: reflects as a perfect mirror."),
        Key::optional("glass", Kind::Table(&Glass::TABLE)).doc("Material: smooth, clear glass."),
        Key::optional("emitter", Kind::Table(&Emitter::TABLE)).doc("Material: emits light."),
    ])
    .rules(&[
        shapes::ONE_SHAPE,
        Rule::ExactlyOne("material", &["diffuse", "mirror", "glass", "emitter"]),
    ]);

choice! { impl Sides { Front = "front", Both = "both", } }

record! {
    struct Emitter in "Emits light and reflects none." {
        radiance: DVec3 = required Colour(Range::NOT_NEGATIVE), "Linear radiance, the same in every direction.";
        sides: Sides = or("'front'") Choice(Sides::WORDS),
            "Sides that emit; the front of a closed shape is its outside.";
    }
}

record! {
    struct Glass in "Smooth, clear glass: reflects and refracts by Fresnel's equations." {
        index: f64 = required Number(Range::POSITIVE),
            "Index of refraction of the inside relative to the outside, such as 1.5.";
    }
}

record! {
    struct Reflector in "Reflects with the same radiance in every direction (Lambert), on both sides." {
        reflectance: DVec3 = required Colour(Range::UNIT),
            "Fraction of the light that is reflected, by channel, in [0, 1].";
    }
}

const DIFFUSE: Table = Reflector::TABLE;

const MIRROR: Table = Table {
    doc: "Reflects as a perfect mirror, on both sides.",
    ..DIFFUSE
};

/// Reads one `[[radiative.surface]]` into `scene`.
pub(super) fn read(reader: &Reader, files: &mut Files, scene: &mut Radiative) -> SceneResult<()> {
    if let Some(table) = reader.table("emitter")? {
        let shape = shapes::luminous(reader, files)?;
        let Emitter { radiance, sides } = Record::read(&table)?;
        scene.area_lights.push(AreaLight {
            shape,
            radiance,
            sides,
        });
        return Ok(());
    }
    let glass = reader.table("glass")?;
    let shape = shapes::shape(reader, files, glass.is_some())?;
    let material = if let Some(diffuse) = reader.table_as("diffuse", Reflector::read)? {
        Material::Diffuse(diffuse.reflectance)
    } else if let Some(mirror) = reader.table_as("mirror", Reflector::read)? {
        Material::Mirror(mirror.reflectance)
    } else {
        Material::Glass(Glass::read(&glass.expect("one of the materials"))?.index)
    };
    scene.objects.push(Object { shape, material });
    Ok(())
}

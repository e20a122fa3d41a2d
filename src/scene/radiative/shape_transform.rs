//! The transform of a shape: scaled, then turned, then moved.

use crate::geometry::Transform;
use crate::scene::SceneResult;
use crate::scene::format::{Key, Kind, Range};
use crate::scene::reader::Reader;
use crate::scene::record::Record;
use glam::DVec3;

/// The keys that move a shape.
pub(in crate::scene) const KEYS: [&str; 3] = ["scale", "rotate", "translate"];

/// The same, declared.
pub(in crate::scene) const STEPS: [Key; 3] = [
    Key::optional("scale", Kind::Vector)
        .doc("Scales the shape along x, y, z about the origin, before its rotation; not 0, negative factors mirror."),
    Key::optional("rotate", Kind::Table(&Rotation::TABLE))
        .doc("Rotates the shape about an axis through the origin, after its scaling and before its translation."),
    Key::optional("translate", Kind::Vector)
        .doc("Translates the shape, after its scaling and rotation, world units."),
];

record! {
    struct Rotation in "A rotation about an axis through the origin." {
        axis: DVec3 = required Vector, "The axis, any length but 0.";
        angle: f64 = required Number(Range::FINITE), "Degrees; anticlockwise where the axis points at the viewer.";
    }
}

/// The transform of a shape.
pub(in crate::scene) struct ShapeTransform {
    /// The map to the world; none for a shape that stays, to the bit, where it is given.
    pub to_world: Option<Transform>,
    /// The factors of its scaling.
    pub scale: DVec3,
}

impl ShapeTransform {
    pub(in crate::scene) fn read(reader: &Reader) -> SceneResult<ShapeTransform> {
        let mut transform = Transform::IDENTITY;
        let mut scale = DVec3::ONE;
        if let Some(factors) = reader.optional("scale")? {
            scale = factors;
            transform = reader.accepted(Transform::scale(factors))?;
        }
        if let Some(rotation) = reader.table("rotate")? {
            let Rotation { axis, angle } = Record::read(&rotation)?;
            let turn = rotation.accepted(Transform::rotation(axis, angle))?;
            transform = transform.then(&turn);
        }
        if let Some(offset) = reader.optional("translate")? {
            let shift = reader.accepted(Transform::translation(offset))?;
            transform = transform.then(&shift);
        }
        Ok(ShapeTransform {
            to_world: (transform != Transform::IDENTITY).then_some(transform),
            scale,
        })
    }

    /// The common factor of a scaling that stretches nothing more than anything else.
    pub(in crate::scene) fn uniform_scale(&self) -> Option<f64> {
        let [x, y, z] = self.scale.abs().to_array();
        (x == y && y == z).then_some(x)
    }
}

//! Clips: planes and boxes that cut volumes.

use super::SceneResult;
use super::format::{Key, Kind, Rule, Table};
use super::radiative::shapes::{BOX, read_box};
use super::reader::Reader;
use crate::geometry::{Aabb, Direction, Ray, Span};
use crate::volume::PlacedBox;
use glam::DVec3;

/// The declaration of `[[classified.clip]]`.
pub(super) const CLIP: Table = Table::new("Cuts volumes: of each, what all its clips keep is seen and casts a shadow. Surfaces are not cut.")
    .keys(&[
        Key::optional("point", Kind::Vector)
            .doc("A point of the plane, world units."),
        Key::optional("normal", Kind::Vector)
            .doc("Normal of the plane, any length but 0: the side to which it points is kept."),
        BOX.doc("A box along the axes of the world, in place of a plane: its inside is kept."),
        Key::optional("volumes", Kind::Words)
            .doc("Names of the volumes that are cut. If left out, all are."),
    ])
    .rules(&[
        Rule::ExactlyOne("shape", &["normal", "box"]),
        Rule::Together(&["point", "normal"]),
    ]);

/// A plane or a box that cuts volumes.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// The part that is kept.
    pub kept: Kept,
    /// Indices of the volumes that are cut; none for all.
    pub volumes: Option<Vec<usize>>,
}

/// The part of space that a clip keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kept {
    /// The side of a plane to which its normal points.
    Side {
        /// A point of the plane.
        point: DVec3,
        /// Its normal.
        normal: Direction,
    },
    /// The inside of a box.
    Inside(Aabb),
}

impl Kept {
    /// The interval of the whole line of `ray` inside this region, also at negative distances; `None` if it is empty.
    pub fn span(&self, ray: &Ray) -> Option<Span> {
        let (point, normal) = match self {
            Kept::Inside(bounds) => return bounds.span(ray),
            Kept::Side { point, normal } => (*point, normal),
        };
        let (height, slope) = (normal.dot(ray.origin - point), normal.dot(*ray.direction));
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        if slope > 0.0 {
            near = -height / slope;
        } else if slope < 0.0 {
            far = -height / slope;
        } else {
            // In the plane itself a ray belongs to the side of larger coordinates.
            let first = normal.to_array().into_iter().find(|&n| n != 0.0);
            if height < 0.0 || height == 0.0 && first < Some(0.0) {
                return None;
            }
        }
        Some(Span { near, far })
    }
}

impl Clip {
    /// True if each of its planes keeps something of a box.
    pub(super) fn keeps_some(&self, extent: &PlacedBox) -> bool {
        let corners = extent.bounds.corners().map(|it| extent.in_world(it));
        let is_some_above = |n: DVec3, d: f64| corners.iter().any(|it| n.dot(*it) - d > 0.0);
        match self.kept {
            Kept::Side { point, normal } => is_some_above(*normal, normal.dot(point)),
            Kept::Inside(Aabb { min, max }) => (0..3).all(|axis| {
                let n = DVec3::AXES[axis];
                is_some_above(n, min[axis]) && is_some_above(-n, -max[axis])
            }),
        }
    }

    /// True if it cuts the volume of that index.
    pub fn cuts(&self, volume: usize) -> bool {
        let listed = self.volumes.as_ref();
        listed.is_none_or(|listed| listed.contains(&volume))
    }

    /// Reads a `[[classified.clip]]`, given the names of the volumes.
    pub(super) fn read(reader: &Reader, names: &[Option<String>]) -> SceneResult<Clip> {
        let kept = match reader.table_as("box", read_box)? {
            Some(inside) => Kept::Inside(inside),
            None => {
                let (point, normal) = (reader.get("point")?, reader.get::<DVec3>("normal")?);
                let normal = Direction::of(normal).ok_or_else(|| {
                    let message = "the normal of a plane cannot be 0";
                    reader.mistake("normal", message, "let it point to the side that is kept")
                })?;
                Kept::Side { point, normal }
            }
        };
        let named: Option<Vec<String>> = reader.get("volumes")?;
        let index = |name: String| {
            let index = names.iter().position(|known| known.as_ref() == Some(&name));
            let message = || format!("there is no volume whose `name` is {name:?}");
            index.ok_or_else(|| reader.error("volumes", message()))
        };
        let volumes = named.map(|named| named.into_iter().map(index).collect());
        let volumes = volumes.transpose()?;
        Ok(Clip { kept, volumes })
    }
}

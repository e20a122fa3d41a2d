//! Clips: planes and boxes that cut volumes.

use super::SceneResult;
use super::format::{Key, Kind, Rule, Table};
use super::radiative::shapes::{BOX, read_box};
use super::reader::Reader;
use crate::files::misspelling::nearest;
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
    /// The part of `ray` in it, behind the eye, too, if it has one.
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
        refuse! { reader:
            "volumes" if named.as_ref().is_some_and(Vec::is_empty), "`volumes` is empty: the clip cuts nothing",
                "name the volumes that are cut, or leave the key out: then all are";
        }
        let index = |name: String| index_of(reader, &name, names);
        let volumes = named.map(|named| named.into_iter().map(index).collect());
        let volumes = volumes.transpose()?;
        Ok(Clip { kept, volumes })
    }
}

fn index_of(reader: &Reader, name: &str, names: &[Option<String>]) -> SceneResult<usize> {
    let index = names
        .iter()
        .position(|known| known.as_deref() == Some(name));
    index.ok_or_else(|| {
        let known: Vec<&str> = names.iter().flatten().map(String::as_str).collect();
        let help = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean {near:?}?"),
            None if known.is_empty() => "give each volume a `name`".to_owned(),
            None => format!("the named volumes are {}", known.join(", ")),
        };
        reader.mistake(
            "volumes",
            format!("there is no volume named {name:?}"),
            help,
        )
    })
}

/// Half-spaces `n · x ≥ d` whose intersection a clip keeps.
fn half_spaces(kept: &Kept) -> Vec<(DVec3, f64)> {
    match kept {
        Kept::Side { point, normal } => vec![(**normal, normal.dot(*point))],
        Kept::Inside(Aabb { min, max }) => {
            let axes = (0..3).flat_map(|axis| {
                let n = DVec3::AXES[axis];
                [(n, min[axis]), (-n, -max[axis])]
            });
            axes.collect()
        }
    }
}

/// True if a clip keeps all of a box.
pub(super) fn keeps_all(clip: &Clip, extent: &PlacedBox) -> bool {
    half_spaces(&clip.kept).iter().all(|(normal, offset)| {
        let corners = extent.bounds.corners().into_iter();
        corners
            .map(|corner| normal.dot(extent.in_world(corner)))
            .all(|height| height >= *offset)
    })
}

/// A corner of a convex solid, and the numbers of the planes that meet there.
struct Corner {
    point: DVec3,
    planes: Vec<usize>,
}

/// True if the parts that all clips keep have something of a box in common.
///
/// The solid that is left is followed by its corners, half-space by half-space: those inside stay, and
/// edges (pairs of corners with two planes in common) that leave have a new one.
pub(super) fn leave_something<'c>(
    extent: &PlacedBox,
    clips: impl Iterator<Item = &'c Clip>,
) -> bool {
    let corners = extent.bounds.corners().into_iter().enumerate();
    let mut corners: Vec<Corner> = corners
        .map(|(corner, point)| Corner {
            point: extent.in_world(point),
            planes: (0..3).map(|axis| 2 * axis + (corner >> axis & 1)).collect(),
        })
        .collect();
    let half_spaces = clips.flat_map(|clip| half_spaces(&clip.kept));
    for (plane, (normal, offset)) in half_spaces.enumerate() {
        let height = |corner: &Corner| normal.dot(corner.point) - offset;
        let (inside, outside): (Vec<_>, Vec<_>) =
            corners.into_iter().partition(|corner| height(corner) > 0.0);
        let mut cut = Vec::new();
        for (a, b) in inside
            .iter()
            .flat_map(|a| outside.iter().map(move |b| (a, b)))
        {
            let mut planes = a.planes.clone();
            planes.retain(|plane| b.planes.contains(plane));
            if planes.len() >= 2 {
                planes.push(6 + plane);
                let share = height(a) / (height(a) - height(b));
                cut.push(Corner {
                    point: a.point.lerp(b.point, share),
                    planes,
                });
            }
        }
        corners = inside;
        if corners.is_empty() {
            return false;
        }
        corners.extend(cut);
    }
    true
}

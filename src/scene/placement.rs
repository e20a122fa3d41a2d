//! The place of a volume in the world: what its file says, and then what the scene says.

use super::SceneResult;
use super::format::{Key, Kind};
use super::radiative::shape_transform::{self, ShapeTransform};
use super::reader::Reader;
use crate::geometry::{Transform, length_of};
use crate::volume::{Grid, PlacedBox, cell_edges, voxel};
use std::sync::Arc;

/// A matrix.
pub(super) const TRANSFORM: Key = Key::optional("transform", Kind::Matrix(3)).doc(
    "Maps the volume, as it stands without this key, into the world: three rows of a 3 × 4 matrix, whose last column is a translation in world units. In place of `scale`, `rotate` and `translate`.",
);

/// The keys of a placement in place of [`TRANSFORM`]: those of a shape.
pub(super) const STEPS: [Key; 3] = {
    let [scale, rotate, translate] = shape_transform::STEPS;
    [
        scale.doc("Scales the volume, as it stands without this key, along x, y, z about the origin, before its rotation; not 0, negative factors mirror."),
        rotate.doc("Rotates the volume about an axis through the origin, after its scaling and before its translation."),
        translate.doc("Translates the volume, after its scaling and rotation, world units."),
    ]
};

/// Largest condition number of a map.
///
/// Rounding moves a point that is mapped to the volume and back by up to 8 · 2⁻⁵³ times the condition, as a share of its
/// distance from the origin of the map. At this condition that is 1e-7: a thousandth of a pixel of the largest image.
const MOST_CONDITION: f64 = 1e8;

/// A grid in the world.
#[derive(Clone, Debug)]
pub(super) struct PlacedGrid {
    pub grid: Arc<Grid<f32>>,
    /// The map to the world; none where the axes of the grid are those of the world.
    pub to_world: Option<Transform>,
}

impl PlacedGrid {
    /// This grid, moved as the table of its volume says.
    pub(super) fn moved(self, reader: &Reader) -> SceneResult<PlacedGrid> {
        let by_scene = match reader.optional("transform")? {
            Some(rows) => Some(reader.accepted(Transform::from_rows(rows))?),
            None => ShapeTransform::read(reader)?.to_world,
        };
        let to_world = match (self.to_world, by_scene) {
            (Some(file), Some(scene)) => Some(file.then(&scene)),
            (file, scene) => scene.or(file),
        };
        let placed = PlacedGrid {
            to_world: to_world.filter(|map| *map != Transform::IDENTITY),
            ..self
        };
        if placed.fits() {
            return Ok(placed);
        }
        let key = reader.first_of(&["transform", "scale", "rotate", "translate", "field"]);
        let message = format!(
            "the volume is mapped out of the range of numbers, or by a condition beyond {MOST_CONDITION:e}, with which \
             positions lose too many digits"
        );
        let help = "stretch and shear less, with numbers near 1";
        Err(reader.mistake(key.unwrap_or("file"), message, help))
    }

    fn fits(&self) -> bool {
        let bounds = self.extent().world_bounds();
        let edges = cell_edges(self.grid.lattice(), self.to_world.as_ref()).map(length_of);
        let is_finite = bounds.min.is_finite() && bounds.size().is_finite();
        let condition = self.to_world.map_or(1.0, |map| map.condition());
        is_finite && condition <= MOST_CONDITION && edges.iter().all(|edge| edge.is_normal())
    }

    /// Length of a voxel in the world.
    pub(super) fn voxel(&self) -> f64 {
        voxel(self.grid.lattice(), self.to_world.as_ref())
    }

    /// The box around the grid, as the map places it in the world.
    pub(super) fn extent(&self) -> PlacedBox {
        PlacedBox {
            bounds: self.grid.lattice().bounds(),
            to_world: self.to_world,
        }
    }
}

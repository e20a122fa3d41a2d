//! Classified scenes of several volumes, surfaces and clips.

use super::SceneResult;
use super::clip::{CLIP, Clip};
use super::files::Files;
use super::format::{Key, Kind, Range, Table};
use super::modulation::Modulation;
use super::radiative::shapes;
use super::reader::Reader;
use super::shadow::Shadow;
use crate::geometry::{Direction, Hit, Ray, Shape, Side, Surface as _, Transform};
use crate::optics::{Phong, TransferFunction};
use crate::volume::Grid;
use glam::DVec3;
use std::sync::Arc;

/// Volumes of a scene at most, and surfaces and clips: each pixel asks all of them.
pub(super) const MOST: usize = 64;

/// The declaration of `[[classified.surface]]`.
pub(super) const SURFACE: Table = Table::new("An opaque surface: one shape of one colour, which ends rays; lit as samples are, by Phong's model of `[classified.phong]`, on both sides.")
    .with(&shapes::SURFACE_KEYS)
    .keys(&[Key::required("colour", Kind::Colour(Range::NOT_NEGATIVE))
        .doc("Linear radiance of the material before shading.")])
    .rules(&[shapes::ONE_SHAPE]);

/// Surfaces.
pub(super) const SURFACES: Key = Key::optional("surface", Kind::Tables(&SURFACE))
    .doc("Opaque surfaces among the volumes, at most 64.");

/// Clips.
pub(super) const CLIPS: Key = Key::optional("clip", Kind::Tables(&CLIP))
    .doc("Planes and boxes that cut volumes, at most 64.");

/// Objects of a classified scene beside its first volume.
#[derive(Clone, Debug, Default)]
pub struct Objects {
    /// The volumes after the first.
    pub volumes: Vec<Volume>,
    /// Opaque surfaces.
    pub surfaces: Vec<OpaqueSurface>,
    /// Clips of volumes.
    pub clips: Vec<Clip>,
    /// Modulation of the opacity of the first volume.
    pub modulation: Option<Modulation>,
}

/// One volume of several.
#[derive(Clone, Debug)]
pub struct Volume {
    /// Values of the field.
    pub grid: Arc<Grid<f32>>,
    /// The map of the grid into the world.
    pub to_world: Option<Transform>,
    /// Colour and opacity by value.
    pub transfer_function: TransferFunction,
    /// Distance between samples along a ray, > 0.
    pub step: f64,
    /// Shading by gradient, if asked for.
    pub phong: Option<Phong>,
    /// Volume shadow, if asked for: lengths in voxels are this volume's.
    pub shadow: Option<Shadow>,
    /// Modulation of its opacity.
    pub modulation: Option<Modulation>,
}

/// An opaque surface.
#[derive(Clone, Debug)]
pub struct OpaqueSurface {
    /// Its shape.
    pub shape: Shape,
    /// Its colour.
    pub colour: DVec3,
    /// Shading, if asked for.
    pub phong: Option<Phong>,
}

impl OpaqueSurface {
    /// Its colour where `ray` hits it, on the side that is seen, lit from the point `light`.
    pub fn shaded(&self, ray: &Ray, hit: &Hit, light: DVec3) -> DVec3 {
        let Some(phong) = &self.phong else {
            return self.colour;
        };
        let inwards = *hit.point.normal * if hit.side == Side::Front { -1.0 } else { 1.0 };
        let to_light = Direction::of(light - hit.point.position);
        phong.shade(self.colour, inwards, to_light, -ray.direction)
    }
}

impl Objects {
    /// The nearest surface that `ray` hits, and where.
    pub(crate) fn nearest_surface(&self, ray: &Ray) -> Option<(Hit, &OpaqueSurface)> {
        let mut nearest = None;
        let mut limit = f64::INFINITY;
        for surface in &self.surfaces {
            if let Some(crossing) = surface.shape.crossing(ray, limit) {
                limit = crossing.t;
                nearest = Some((crossing, surface));
            }
        }
        let (crossing, surface) = nearest?;
        Some((surface.shape.hit_at(ray, &crossing), surface))
    }

    /// True if there is nothing but the first volume, and no modulation of its opacity.
    pub fn is_empty(&self) -> bool {
        self.are_one_volume() && self.clips.is_empty()
    }

    /// The same, but that the volume may be clipped.
    pub(super) fn are_one_volume(&self) -> bool {
        let is_alone = self.volumes.is_empty() && self.surfaces.is_empty();
        is_alone && self.modulation.is_none()
    }

    /// Reads surfaces and clips, given the names of all volumes.
    pub(super) fn read(
        reader: &Reader,
        files: &mut Files,
        names: &[Option<String>],
    ) -> SceneResult<Objects> {
        for key in ["surface", "clip"] {
            check_count(reader, key, reader.tables(key)?.len())?;
        }
        let surfaces = reader.tables_as("surface", |reader| {
            Ok(OpaqueSurface {
                shape: shapes::shape(reader, files, false)?,
                colour: reader.get("colour")?,
                phong: None,
            })
        })?;
        Ok(Objects {
            volumes: vec![],
            surfaces,
            clips: reader.tables_as("clip", |clip| Clip::read(clip, names))?,
            modulation: None,
        })
    }
}

/// Refuses more objects of a kind than a scene may have.
pub(super) fn check_count(reader: &Reader, key: &str, count: usize) -> SceneResult<()> {
    if count <= MOST {
        return Ok(());
    }
    let message = format!("{count} tables of `{key}` are too many: a scene has at most {MOST}");
    Err(reader.error(key, message))
}

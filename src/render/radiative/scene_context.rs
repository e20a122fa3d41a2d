//! A scene prepared for rendering.

use super::media::{Media, Set};
use super::surfaces::{Intersection, Surfaces};
use super::variance_reduction::guiding::Guiding;
use super::variance_reduction::light_vertex_shares::LightVertexShares;
use super::variance_reduction::specular_objects::SpecularObject;
use crate::geometry::{Emitter, EmitterExtent, Ray};
use crate::optics::Light;
use crate::render::counters::Counters;
use crate::render::plan::RadiativeFeatures;
use crate::scene::Radiative;
use glam::DVec3;

/// A scene and its media.
#[derive(Debug)]
pub struct SceneContext<'s> {
    /// The scene as it was read.
    pub radiative: &'s Radiative,
    /// Its media, prepared for tracking or for integrals.
    pub media: Media<'s>,
    /// Its surfaces, objects and area lights.
    pub surfaces: Surfaces<'s>,
    /// Centres and sizes of its area lights, in their order.
    pub area_light_extents: Vec<EmitterExtent>,
    /// Its mirrors and glass, if it has area lights.
    pub specular_objects: Vec<SpecularObject>,
    /// The places of its light vertices.
    pub light_vertex_shares: LightVertexShares,
    /// Its lights, as far as paths are guided by them.
    pub guiding: Guiding,
    /// The features that the scene calls for: others are not looked for.
    pub features: RadiativeFeatures,
}

/// A light at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PositionedLight<'s> {
    /// The light.
    pub light: &'s Light,
    /// Its position, world units.
    pub position: DVec3,
    /// Its index among the lights of the scene.
    pub index: usize,
}

impl<'s> SceneContext<'s> {
    /// `scene` prepared for random paths.
    pub fn new(scene: &'s Radiative, features: RadiativeFeatures) -> Self {
        let media = Media::new(&scene.media, features.vacuum_media);
        SceneContext::with(scene, features, media)
    }

    /// `scene` prepared for integrals along the line of sight.
    pub fn for_integrals(scene: &'s Radiative, features: RadiativeFeatures) -> Self {
        let media = Media::for_integrals(&scene.media, features.vacuum_media);
        SceneContext::with(scene, features, media)
    }

    fn with(radiative: &'s Radiative, features: RadiativeFeatures, media: Media<'s>) -> Self {
        let extents = radiative.area_lights.iter();
        let extents = extents.map(|light| light.shape.extent());
        SceneContext {
            area_light_extents: extents.collect(),
            specular_objects: if radiative.area_lights.is_empty() {
                vec![]
            } else {
                SpecularObject::of(radiative)
            },
            light_vertex_shares: LightVertexShares::new(radiative, media.scatter()),
            guiding: Guiding::new(radiative),
            radiative,
            media,
            surfaces: Surfaces::new(radiative),
            features,
        }
    }

    /// Whether any medium is heterogeneous.
    pub(crate) fn is_heterogeneous(&self) -> bool {
        self.features.heterogeneous && self.media.heterogeneous(Set::MAX) != 0
    }

    /// The nearest surface on `ray`; among several at the same distance, the first of the scene.
    pub(crate) fn intersect(&self, ray: &Ray, work: &mut Counters) -> Option<Intersection> {
        match self.features.surfaces {
            true => self.surfaces.nearest(ray, work),
            false => None,
        }
    }

    /// The lights at a point.
    pub(crate) fn positioned_lights(&self) -> impl Iterator<Item = PositionedLight<'s>> + use<'s> {
        let lights = self.radiative.lights.iter().enumerate();
        let shining = lights.filter(|(_, light)| light.strength() != DVec3::ZERO);
        shining.filter_map(|(index, light)| {
            Some(PositionedLight {
                light,
                position: light.position()?,
                index,
            })
        })
    }
}

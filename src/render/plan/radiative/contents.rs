//! Contents of a scene of surfaces, media and lights, by its exact values.

use crate::geometry::Boundary;
use crate::optics::{Density, Light, Material};
use crate::scene::{Body, KeyLines, Radiative, Scattering};
use glam::DVec3;

pub(super) const SURFACE: &str = "radiative.surface";
pub(super) const MEDIUM: &str = "radiative.medium";
pub(super) const SCATTERING: &str = "radiative.scattering";
pub(super) const LIGHT: &str = "radiative.light";
pub(super) const MAX_BOUNCES: &str = "radiative.max_bounces";

/// The keys of a medium that give a property, the most specific first.
pub(super) const ABSORPTION: &[&str] = &["sigma_a", "sigma_t", "albedo", "procedural"];
pub(super) const SCATTERS: &[&str] = &["sigma_s", "albedo", "procedural"];
pub(super) const EMISSION: &[&str] = &["emission"];
pub(super) const PHASE: &[&str] = &Radiative::PHASE_KEYS;
pub(super) const DENSITY: &[&str] = &Radiative::DENSITY_KEYS;

/// Contents of a scene. Media are those that have any density.
pub(super) struct Contents<'s> {
    pub scene: &'s Radiative,
    pub key_lines: &'s KeyLines,
    /// Number of media.
    pub media: usize,
    pub surfaces: usize,
    /// The first medium that absorbs.
    pub absorption: Option<usize>,
    /// Whether any medium absorbs or scatters.
    pub extinction: bool,
    /// The first medium that scatters.
    pub scattering: Option<usize>,
    /// The first medium that emits light.
    pub emission: Option<usize>,
    /// Coefficients of a medium differ between channels.
    pub chromatic: bool,
    /// The first medium that scatters anisotropically.
    pub anisotropic: Option<usize>,
    /// Heterogeneous media.
    pub heterogeneous: Vec<usize>,
    /// Whether each of those densities has an integral along lines.
    pub integrable: bool,
    /// Surfaces that reflect or refract anything at all.
    pub reflection: bool,
    /// Lights, with or without extent, other than the environment.
    pub lights: bool,
    pub environment: bool,
}

impl<'s> Contents<'s> {
    pub fn of(scene: &'s Radiative, key_lines: &'s KeyLines) -> Contents<'s> {
        // A medium whose density is 0 everywhere counts as none.
        let is_there = |(_, body): &(usize, &Body)| {
            let density = body.density.as_ref();
            density.is_none_or(|density| !density.is_nothing())
        };
        let there = || scene.media.iter().enumerate().filter(is_there);
        let first = |is: &dyn Fn(&Body) -> bool| {
            let mut those = there().filter(|(_, body)| is(body));
            those.next().map(|(index, _)| index)
        };
        let any = |value: DVec3| value != DVec3::ZERO;
        let differs = |value: DVec3| value.x != value.y || value.y != value.z;
        let attenuates = |body: &Body| any(body.medium.coefficients.sigma_t());
        let scatters = |body: &Body| any(body.medium.coefficients.sigma_s());
        let emits = |body: &Body| any(body.medium.emission);
        let is_chromatic = |body: &Body| {
            let coefficients = body.medium.coefficients;
            differs(coefficients.sigma_a()) || differs(coefficients.sigma_s())
        };
        // The density of a vacuum medium does not matter.
        let is_heterogeneous =
            |body: &Body| body.homogeneous().is_none() && (attenuates(body) || emits(body));
        let heterogeneous: Vec<usize> = there()
            .filter(|(_, body)| is_heterogeneous(body))
            .map(|(index, _)| index)
            .collect();
        let densities = heterogeneous
            .iter()
            .filter_map(|&index| scene.media[index].density.as_ref());
        let shines = |light: &Light| any(light.strength());
        Contents {
            media: there().count(),
            surfaces: scene.objects.len() + scene.area_lights.len(),
            absorption: first(&|body| any(body.medium.coefficients.sigma_a())),
            extinction: first(&attenuates).is_some(),
            scattering: first(&scatters),
            emission: first(&emits),
            chromatic: there().any(|(_, body)| is_chromatic(body)),
            anisotropic: first(&|body| scatters(body) && !body.medium.phase.is_isotropic()),
            integrable: densities.into_iter().all(Density::is_integrable),
            heterogeneous,
            reflection: scene.objects.iter().any(|object| match object.material {
                Material::Diffuse(reflectance) | Material::Mirror(reflectance) => any(reflectance),
                Material::Glass(_) => true,
            }),
            lights: scene.lights.iter().any(shines)
                || scene.area_lights.iter().any(|light| any(light.radiance)),
            environment: any(scene.environment),
            scene,
            key_lines,
        }
    }

    /// Whether there is light, and anything to scatter or reflect it.
    pub fn scatters(&self) -> bool {
        let light = self.lights || self.environment || self.emission.is_some();
        (self.scattering.is_some() || self.reflection) && light
    }

    /// Whether emission has no closed form: media may overlap, and one of them is heterogeneous.
    pub fn emission_is_integrated(&self) -> bool {
        self.emission.is_some() && !self.heterogeneous.is_empty() && self.media > 1
    }

    /// Whether light is scattered or reflected in this picture.
    pub fn is_scattered(&self) -> bool {
        self.scene.scattering != Scattering::None && self.scatters()
    }

    /// Whether single scattering is one complete integral along the line of sight: lights have no
    /// extent, and there are either scattering media without surfaces or diffuse surfaces. (The
    /// shadow that a surface or a mesh casts into a medium may be too narrow for quadrature.)
    pub fn is_one_integral(&self) -> bool {
        let objects = &self.scene.objects;
        let diffuse = |material| matches!(material, Material::Diffuse(_));
        self.scene.area_lights.is_empty()
            && !self.environment
            && self.emission.is_none()
            && self.heterogeneous.is_empty()
            && (objects.is_empty() || self.scattering.is_none())
            && objects.iter().all(|object| diffuse(object.material))
            && !self.mesh_shades()
    }

    /// One of several media is a mesh, which may cast shadows into those that scatter.
    pub fn mesh_shades(&self) -> bool {
        let is_mesh = |body: &Body| {
            matches!(
                body.boundary,
                Some(Boundary::Mesh(_) | Boundary::PlacedMesh(_))
            )
        };
        self.scattering.is_some() && self.media > 1 && self.scene.media.iter().any(is_mesh)
    }

    /// The first of `keys` that the file gives for medium `index`, or the first of all if it gives none.
    pub fn key_of(&self, index: usize, keys: &[&str]) -> String {
        let full = |key: &str| format!("{MEDIUM}[{index}].{key}");
        let given = keys.iter().find(|key| self.key_lines.has(&full(key)));
        full(given.unwrap_or(&keys[0]))
    }

    /// The key that shows that no medium has a property: that of the only medium, or all media.
    pub fn none_has(&self, keys: &[&str]) -> String {
        match self.scene.media.len() {
            1 => self.key_of(0, keys),
            _ => MEDIUM.to_owned(),
        }
    }
}

//! Scenes of surfaces, participating media and lights.

mod contradictions;
mod densities;
mod lights;
mod media;
mod phases;
pub(in crate::scene) mod shape_transform;
pub(in crate::scene) mod shapes;
mod surfaces;

use super::SceneResult;
use super::camera;
use super::files::Files;
use super::format::{Key, Kind, Range, Table};
use super::objects::check_count;
use super::reader::Reader;
use super::record::Record;
use super::sampling::SamplingTable;
use crate::geometry::{Boundary, Camera, Luminous, Shape};
use crate::optics::{Coefficients, Density, Homogeneous, Light, Material, Sides};
use contradictions::Contradictions;
use glam::DVec3;

/// The declaration of `[radiative]`.
pub(super) const RADIATIVE: Table = Table::new("Surfaces, participating media and lights.").keys(&[
    Key::or("scattering", Kind::Choice(&["none", "single", "multiple"]), "'multiple'")
        .doc("Scattering order of light on its way to the eye, bounces of media and surfaces together: none, one, or any number."),
    // A stream of random numbers counts the bounces of a path in 26 bits.
    Key::optional("max_bounces", Kind::Count(2, (1 << 26) - 1))
        .doc("Maximum scattering order, with `scattering = \"multiple\"`. If left out, it is unlimited."),
    Key::or("environment", Kind::Colour(Range::NOT_NEGATIVE), "[0.0, 0.0, 0.0]")
        .doc("Linear radiance from infinitely far away, the same from every direction."),
    Key::optional("surface", Kind::Tables(&surfaces::SURFACE))
        .doc("Surfaces."),
    Key::optional("medium", Kind::Tables(&media::MEDIUM))
        .doc("Participating media, at most 64."),
    Key::optional("light", Kind::Tables(&lights::LIGHT))
        .doc("Point, spot and directional lights. Area lights are surfaces with an emitter."),
]);

/// Scattering order of light on its way from a light to the eye: bounces of media and surfaces
/// together. The boundary of a medium is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scattering {
    /// None: lights are seen directly, through absorbing media.
    None,
    /// At most one.
    Single,
    /// Any number of times, or up to a limit of at least 2.
    Multiple(Option<u32>),
}

/// A surface that reflects or refracts.
#[derive(Clone, Debug)]
pub struct Object {
    /// Where it is.
    pub shape: Shape,
    /// Its material.
    pub material: Material,
}

/// A surface that emits light and reflects none.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// Where it is.
    pub shape: Luminous,
    /// Radiance by channel, the same in every direction.
    pub radiance: DVec3,
    /// Sides that emit.
    pub sides: Sides,
}

/// A medium and the space it fills.
#[derive(Clone, Debug)]
pub struct Body {
    /// The closed shape it fills; without one it fills all space.
    pub boundary: Option<Boundary>,
    /// Its properties at density 1. Where bodies overlap, their coefficients and emissions add up.
    pub medium: Homogeneous,
    /// Its density, a factor on coefficients and emission; 1 everywhere without. A medium with a
    /// density has a boundary.
    pub density: Option<Density>,
}

/// Surfaces, participating media and lights.
#[derive(Clone, Debug)]
pub struct Radiative {
    /// Scattering order.
    pub scattering: Scattering,
    /// Surfaces that reflect or refract.
    pub objects: Vec<Object>,
    /// Surfaces that emit.
    pub area_lights: Vec<AreaLight>,
    /// Media; at most 64: a set of them is a word of 64 bits.
    pub media: Vec<Body>,
    /// Point, spot and directional lights.
    pub lights: Vec<Light>,
    /// Radiance by channel from infinitely far away, the same from every direction.
    pub environment: DVec3,
    /// The eye.
    pub camera: Camera,
    /// Samples per pixel, where random numbers are needed.
    pub samples: u32,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Scattering {
    /// Scattering events of a path, at most; `None` without limit.
    pub fn max_bounces(self) -> Option<u32> {
        match self {
            Scattering::None => Some(0),
            Scattering::Single => Some(1),
            Scattering::Multiple(limit) => limit,
        }
    }
}

impl Body {
    /// Absorption at density 1, per world length.
    pub(crate) fn sigma_a(&self) -> DVec3 {
        self.medium.coefficients.sigma_a()
    }

    /// Scattering at density 1, per world length.
    pub(crate) fn sigma_s(&self) -> DVec3 {
        self.medium.coefficients.sigma_s()
    }

    /// The medium with its coefficients and its emission at this `density`; `None` if a coefficient leaves the range of
    /// numbers.
    pub(crate) fn at_density(&self, density: f64) -> Option<Homogeneous> {
        let coefficients = Coefficients::new(self.sigma_a() * density, self.sigma_s() * density);
        Some(Homogeneous {
            coefficients: coefficients.ok()?,
            emission: self.medium.emission * density,
            phase: self.medium.phase,
        })
    }

    /// The medium, if it is provably homogeneous: it has no density, or one that is constant and
    /// leaves its coefficients in the range of numbers.
    pub fn homogeneous(&self) -> Option<Homogeneous> {
        match &self.density {
            None => Some(self.medium),
            Some(density) => self.at_density(density.constant()?),
        }
    }
}

impl Radiative {
    /// The keys of a medium that give it a density.
    pub(crate) const DENSITY_KEYS: [&str; 6] = densities::KEYS;

    /// The keys of a medium that give it a phase function, the procedural block last.
    pub(crate) const PHASE_KEYS: [&str; 4] = phases::KEYS_AND_BLOCK;

    /// Reads `[radiative]`, `[camera]` and `[sampling]` of the file whose root table is `root`.
    pub(super) fn read(
        root: &Reader,
        reader: &Reader,
        files: &mut Files,
        size: [usize; 2],
    ) -> SceneResult<Radiative> {
        refuse! { root: "transfer_function", "a radiative scene has no densities for a transfer function"; }
        let camera = root.table_or_default("camera")?;
        let sampling = SamplingTable::read(&root.table_or_default("sampling")?)?;
        let camera = camera::given(&camera, size)?;
        let scattering = read_scattering(reader)?;
        let environment = reader.get("environment")?;
        let mut scene = Radiative {
            scattering,
            objects: vec![],
            area_lights: vec![],
            media: vec![],
            lights: vec![],
            environment,
            camera,
            samples: sampling.samples,
            seed: sampling.seed,
        };
        for surface in reader.tables("surface")? {
            surfaces::read(&surface, files, &mut scene)?;
        }
        let media = reader.tables("medium")?;
        check_count(reader, "medium", media.len())?;
        for medium in &media {
            scene.media.push(media::read(medium, files)?);
        }
        let lights = reader.tables("light")?;
        let read = lights.iter().map(lights::read);
        scene.lights = read.collect::<SceneResult<_>>()?;
        let contradictions = Contradictions {
            scene: &scene,
            reader,
            media: media.iter().zip(&scene.media).collect(),
            lights: lights.iter().zip(&scene.lights).collect(),
        };
        contradictions.check()?;
        Ok(scene)
    }
}

fn read_scattering(reader: &Reader) -> SceneResult<Scattering> {
    let scattering: String = reader.get("scattering")?;
    let limit = reader.get("max_bounces")?;
    refuse! { reader:
        "max_bounces" if scattering != "multiple", format!("`max_bounces` has no effect with {scattering} scattering"),
            "remove it, or set `scattering = \"multiple\"`";
    }
    Ok(match scattering.as_str() {
        "none" => Scattering::None,
        "single" => Scattering::Single,
        _ => Scattering::Multiple(limit),
    })
}

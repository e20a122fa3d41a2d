//! The choice of the place of a light vertex: in a medium or on a surface.

use crate::math::rng::Purpose;
use crate::optics::Material;
use crate::render::radiative::sampler::Sampler;
use crate::scene::Radiative;

/// Probabilities that the light vertices of a scene are in media and on surfaces; they sum to 1.
#[derive(Clone, Copy, Debug)]
pub struct LightVertexShares {
    /// Probability of one in a medium.
    pub medium: f64,
    /// Probability of one on a surface.
    pub surface: f64,
}

/// The place of a light vertex.
#[derive(Clone, Copy, Debug)]
pub enum LightVertexPlace {
    /// In a medium, with a number uniform in [0, 1) for its distance.
    Medium(f64),
    /// On a surface.
    Surface,
}

impl LightVertexShares {
    /// The shares of a `scene` whose media scatter or do not: equal where there are both places.
    pub fn new(scene: &Radiative, media_scatter: bool) -> LightVertexShares {
        let mut objects = scene.objects.iter();
        let any_diffuse = objects.any(|object| matches!(object.material, Material::Diffuse(_)));
        let medium = match (media_scatter, any_diffuse) {
            (true, true) => 0.5,
            (true, false) => 1.0,
            (false, _) => 0.0,
        };
        LightVertexShares {
            medium,
            surface: 1.0 - medium,
        }
    }

    /// The place of a light vertex, by the pair of numbers with this index; without media that
    /// scatter none is drawn.
    pub fn place(self, sampler: &mut Sampler, index: usize) -> LightVertexPlace {
        if self.medium == 0.0 {
            return LightVertexPlace::Surface;
        }
        let [u, choice] = sampler.pair(Purpose::LightVertex, index);
        if choice < self.medium {
            LightVertexPlace::Medium(u)
        } else {
            LightVertexPlace::Surface
        }
    }
}

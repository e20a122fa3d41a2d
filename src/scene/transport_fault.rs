//! Mistakes of path tracers that no edit of a scene amounts to.

use super::{Body, Radiative, Scattering};
use crate::optics::Material;
use glam::DVec3;

/// A mistake in the transport of light, made on purpose by the [faulty tracer](crate::faulty_tracer). No
/// scene file states one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportFault {
    /// Bounds of media block shadow rays as surfaces do.
    BoundsBlockLight,
    /// Shadow rays are not attenuated by media.
    ShadowRaysUnattenuated,
    /// Area lights are sampled and hit, and both count in full.
    LightsCountedTwice,
    /// Hits of area lights count in full, samples by their weight.
    HitsUnweighted,
    /// Samples of area lights count in full, hits by their weight.
    SamplesUnweighted,
    /// Samples of area lights count by their weight, hits after a bounce not at all.
    HitsLeftOut,
    /// The phase function is turned round where lights are sampled.
    PhaseReversedForLights,
    /// Direct light in media is multiplied by σ_t, not σ_s.
    AlbedoLeftOutOfDirectLight,
    /// Direct light in media is multiplied by the albedo twice.
    AlbedoSquaredInDirectLight,
    /// Direct light on diffuse surfaces is not multiplied by their reflectance.
    ReflectanceLeftOutOfDirectLight,
    /// Direct light on diffuse surfaces is multiplied by their reflectance twice.
    ReflectanceSquaredInDirectLight,
    /// Null collisions leave the throughput as it is.
    NullCollisionsUnweighted,
    /// Paths that survive Russian roulette keep their throughput.
    RouletteUncompensated,
}

impl TransportFault {
    /// True if `scene` is path traced and has what the mistake is about.
    pub(crate) fn has_occasion(self, scene: &Radiative) -> bool {
        let is_diffuse = |material: &Material| matches!(material, Material::Diffuse(_));
        let has_diffuse = scene.objects.iter().any(|it| is_diffuse(&it.material));
        let has_medium = |is: fn(&Body) -> bool| scene.media.iter().any(is);
        let has_lamps = !scene.area_lights.is_empty();
        let is_lit = has_lamps || !scene.lights.is_empty();
        let scatters = has_medium(|it| it.sigma_s() != DVec3::ZERO);
        let is_traced = matches!(scene.scattering, Scattering::Multiple(_))
            && (scatters || !scene.objects.is_empty());
        is_traced
            && match self {
                TransportFault::BoundsBlockLight => {
                    is_lit && has_medium(|it| it.boundary.is_some())
                }
                TransportFault::ShadowRaysUnattenuated => {
                    is_lit && has_medium(|it| it.sigma_a() + it.sigma_s() != DVec3::ZERO)
                }
                TransportFault::LightsCountedTwice
                | TransportFault::HitsUnweighted
                | TransportFault::SamplesUnweighted
                | TransportFault::HitsLeftOut => has_lamps,
                TransportFault::PhaseReversedForLights => {
                    is_lit && has_medium(|it| it.medium.phase.mean_cosine() != 0.0)
                }
                TransportFault::AlbedoLeftOutOfDirectLight
                | TransportFault::AlbedoSquaredInDirectLight => {
                    is_lit && has_medium(|it| it.sigma_a() * it.sigma_s() != DVec3::ZERO)
                }
                TransportFault::ReflectanceLeftOutOfDirectLight
                | TransportFault::ReflectanceSquaredInDirectLight => is_lit && has_diffuse,
                TransportFault::NullCollisionsUnweighted => {
                    has_medium(|it| it.sigma_a() != DVec3::ZERO)
                }
                TransportFault::RouletteUncompensated => true,
            }
    }
}

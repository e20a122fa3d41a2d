//! What a scene of surfaces, media and lights calls for.

use super::{Decisions, Effect, Finding, Kernel, Parts, Plan};
use crate::media::Density;
use crate::optics::{Light, Material};
use crate::scene::{Body, Radiative, Scattering};
use glam::DVec3;

/// The plan for a scene of surfaces, media and lights: the cheapest kernel that is exact for it.
pub(super) fn plan(scene: &Radiative, forced: &[Effect]) -> Plan {
    let contents = Contents::of(scene);
    let decisions = Decisions::new(|effect| contents.finding(effect, scene), forced);
    let on = |effect| decisions.is_on(effect);

    let of_media = [
        Effect::Absorption,
        Effect::Emission,
        Effect::ChromaticCoefficients,
        Effect::AnisotropicPhase,
        Effect::Heterogeneity,
    ];
    let null_media = of_media.into_iter().any(|effect| forced.contains(&effect));
    let parts = Parts {
        media: contents.extinction || contents.emission || null_media,
        null_media,
        surfaces: on(Effect::Surfaces),
        emission: on(Effect::Emission),
        chromatic: on(Effect::ChromaticCoefficients),
        anisotropic: on(Effect::AnisotropicPhase),
        heterogeneous: on(Effect::Heterogeneity),
    };
    let turned = on(Effect::SingleScattering) || on(Effect::MultipleScattering);
    // By what there is, not by what is forced: the path tracer looks through other places of a
    // pixel than its centre.
    let turns = scene.scattering != Scattering::None && contents.turns();
    let kernel = match scene.scattering {
        _ if !turns && contents.integrable => Kernel::LineOfSight { parts, turned },
        // Light that is not turned, through a density that has no integral.
        _ if !turns => Kernel::PathTracer {
            parts,
            limit: Some(0),
        },
        Scattering::Single if contents.is_one_integral(scene) => {
            Kernel::LineOfSight { parts, turned }
        }
        Scattering::None | Scattering::Single => Kernel::PathTracer {
            parts,
            limit: Some(1),
        },
        Scattering::Multiple(limit) => Kernel::PathTracer { parts, limit },
    };
    Plan {
        approximations: vec![],
        decisions: decisions.0,
        kernel,
    }
}

/// What there is in a scene.
struct Contents {
    /// Media that have any density.
    media: usize,
    surfaces: usize,
    absorption: bool,
    extinction: bool,
    scattering: bool,
    emission: bool,
    chromatic: bool,
    anisotropic: bool,
    /// Media whose density differs from place to place.
    heterogeneous: usize,
    /// Whether each of those densities has an integral along lines.
    integrable: bool,
    /// Surfaces that reflect or refract anything at all.
    reflection: bool,
    /// Lights, with or without extent, other than the environment.
    lights: bool,
    environment: bool,
}

impl Contents {
    fn of(scene: &Radiative) -> Contents {
        // A medium whose density is 0 everywhere is as good as none.
        let is_there = |body: &&Body| {
            let density = body.density.as_ref();
            density.is_none_or(|density| !density.is_nothing())
        };
        let there = || scene.media.iter().filter(is_there);
        let media = || there().map(|body| &body.medium);
        let any = |value: DVec3| value != DVec3::ZERO;
        // Of a medium that is nothing, its density says nothing.
        let varying = || {
            there().filter_map(|body| {
                let medium = &body.medium;
                let matters = any(medium.coefficients.sigma_t()) || any(medium.emission);
                body.density.as_ref().filter(|_| matters)
            })
        };
        let differs = |value: DVec3| value.x != value.y || value.y != value.z;
        let shines = |light: &Light| {
            any(match light {
                Light::Point(light) => light.intensity,
                Light::Spot(light) => light.intensity,
                Light::Directional(light) => light.irradiance,
            })
        };
        Contents {
            media: there().count(),
            surfaces: scene.objects.len() + scene.area_lights.len(),
            absorption: media().any(|medium| any(medium.coefficients.sigma_a())),
            extinction: media().any(|medium| any(medium.coefficients.sigma_t())),
            scattering: media().any(|medium| any(medium.coefficients.sigma_s())),
            emission: media().any(|medium| any(medium.emission)),
            chromatic: media().any(|medium| {
                let coefficients = medium.coefficients;
                differs(coefficients.sigma_a()) || differs(coefficients.sigma_s())
            }),
            anisotropic: media()
                .any(|medium| any(medium.coefficients.sigma_s()) && medium.phase.0.g() != 0.0),
            heterogeneous: varying().count(),
            integrable: varying().all(Density::is_integrable),
            reflection: scene.objects.iter().any(|object| match object.material {
                Material::Diffuse(reflectance) | Material::Mirror(reflectance) => any(reflectance),
                Material::Glass(_) => true,
            }),
            lights: scene.lights.iter().any(shines)
                || scene.area_lights.iter().any(|light| any(light.radiance)),
            environment: any(scene.environment),
        }
    }

    /// Whether anything turns light that is there.
    fn turns(&self) -> bool {
        (self.scattering || self.reflection) && (self.lights || self.environment || self.emission)
    }

    /// Whether what light does by one turn is an integral along the line of sight that finds all
    /// of it: lights have no extent, and there is either matter that scatters, all of it in the
    /// open, or diffuse surfaces. (The shadow that a surface throws into a medium may be too
    /// narrow for an integral to meet it.)
    fn is_one_integral(&self, scene: &Radiative) -> bool {
        let diffuse = |material| matches!(material, Material::Diffuse(_));
        scene.area_lights.is_empty()
            && !self.environment
            && !self.emission
            && self.heterogeneous == 0
            && (scene.objects.is_empty() || !self.scattering)
            && scene.objects.iter().all(|object| diffuse(object.material))
    }

    fn finding(&self, effect: Effect, scene: &Radiative) -> Finding {
        use Finding::{Absent, LeftOut, Matters, Null};
        const SURFACE: &str = "radiative.surface";
        const MEDIUM: &str = "radiative.medium";
        const SCATTERING: &str = "radiative.scattering";
        let null = |field, reason: &str| Null(field, reason.to_owned());
        let matters = |field, reason: &str| Matters(field, reason.to_owned());
        let no_media = || {
            null(
                MEDIUM,
                match scene.media.is_empty() {
                    true => "the scene has no media",
                    false => "the density is 0 everywhere in every medium",
                },
            )
        };
        let nothing_turns = || {
            null(
                SCATTERING,
                if self.scattering || self.reflection {
                    "the scene has no light"
                } else {
                    "no medium scatters and no surface reflects"
                },
            )
        };
        let asked = scene.scattering != Scattering::None;
        match effect {
            Effect::Surfaces if self.surfaces == 0 => null(SURFACE, "the scene has no surfaces"),
            Effect::Surfaces => Matters(
                SURFACE,
                match self.surfaces {
                    1 => "one surface".to_owned(),
                    many => format!("{many} surfaces"),
                },
            ),
            Effect::Absorption | Effect::Emission if self.media == 0 => no_media(),
            Effect::Absorption if !self.absorption => null(MEDIUM, "sigma_a is 0 in every medium"),
            Effect::Absorption => matters(MEDIUM, "a medium has sigma_a above 0"),
            Effect::Emission if !self.emission => null(MEDIUM, "no medium has emission"),
            Effect::Emission => matters(MEDIUM, "a medium has emission"),
            Effect::SingleScattering | Effect::MultipleScattering if !self.turns() => {
                nothing_turns()
            }
            Effect::SingleScattering if !asked => LeftOut(
                SCATTERING,
                "not asked for: light is never turned".to_owned(),
            ),
            Effect::SingleScattering => matters(
                SCATTERING,
                match (self.scattering, self.reflection) {
                    (true, true) => "media scatter and surfaces reflect",
                    (true, false) => "a medium scatters",
                    (false, _) => "a surface reflects",
                },
            ),
            Effect::MultipleScattering => match scene.scattering {
                Scattering::None => LeftOut(
                    SCATTERING,
                    "not asked for: light is never turned".to_owned(),
                ),
                Scattering::Single => LeftOut(
                    SCATTERING,
                    "not asked for: light is turned once at most".to_owned(),
                ),
                Scattering::Multiple(Some(limit)) => LeftOut(
                    "radiative.max_bounces",
                    format!("beyond {limit} turns: light turned more often is left out"),
                ),
                Scattering::Multiple(None) => matters(SCATTERING, "any number of turns"),
            },
            Effect::MediumShadow | Effect::SurfaceShadow
                if !(self.turns() && self.lights && asked) =>
            {
                null(SCATTERING, "no ray is sent to a light")
            }
            Effect::MediumShadow if !self.extinction => null(MEDIUM, "no medium takes light away"),
            Effect::MediumShadow => {
                matters(MEDIUM, "media take light away on its way from a light")
            }
            Effect::SurfaceShadow if self.surfaces == 0 => {
                null(SURFACE, "the scene has no surfaces")
            }
            Effect::SurfaceShadow => matters(SURFACE, "surfaces stand in the way of lights"),
            Effect::GradientShading => Absent("media are not shaded"),
            Effect::Heterogeneity if self.media == 0 => no_media(),
            Effect::Heterogeneity => match self.heterogeneous {
                0 => null(
                    MEDIUM,
                    "every medium that takes or gives light is homogeneous",
                ),
                1 => matters(
                    MEDIUM,
                    "the density of a medium differs from place to place",
                ),
                many => Matters(
                    MEDIUM,
                    format!("the densities of {many} media differ from place to place"),
                ),
            },
            Effect::ChromaticCoefficients | Effect::AnisotropicPhase if self.media == 0 => {
                no_media()
            }
            Effect::ChromaticCoefficients if !self.chromatic => {
                null(MEDIUM, "coefficients are the same for all channels")
            }
            Effect::ChromaticCoefficients => {
                matters(MEDIUM, "coefficients differ between channels")
            }
            Effect::AnisotropicPhase if !self.scattering => null(MEDIUM, "no medium scatters"),
            Effect::AnisotropicPhase if !self.anisotropic => {
                null(MEDIUM, "g is 0 wherever light is scattered")
            }
            Effect::AnisotropicPhase => {
                matters(MEDIUM, "a medium that scatters has g other than 0")
            }
        }
    }
}

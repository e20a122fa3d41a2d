//! What a classified volume calls for.

use super::{Approximation, Decisions, Effect, FieldKind, Finding, Kernel, Plan};
use crate::media::{Appearance, Phong};
use crate::scene::{Classified, Compositing};
use crate::volume::Interpolation;

/// The plan for a classified volume.
pub(super) fn plan(scene: &Classified, forced: &[Effect]) -> Plan {
    use Finding::{Absent, Matters, NotAsked, Null};
    let (least, most) = scene.grid.range();
    let constant = least == most;
    let transfer_function = &scene.transfer_function;
    let transparent = transfer_function.is_transparent_between(least, most);
    let (numbers, nothing, extent, light, darkness) = match transfer_function.appearance {
        Appearance::Formula { .. } => (
            "densities",
            format!("every density, up to {most}, has opacity 0"),
            format!("densities up to {most}"),
            "the colormap sends out light",
            "densities darken what lies behind",
        ),
        Appearance::Points(_) => (
            "values",
            format!("every value, from {least} to {most}, has opacity 0"),
            format!("values from {least} to {most}"),
            "the colours of the points send out light",
            "opacities darken what lies behind",
        ),
    };
    let nothing = || nothing.clone();

    let finding = |effect| match effect {
        Effect::Surfaces => Absent("the classified model has no surfaces"),
        Effect::Absorption | Effect::Emission if transparent => {
            Null("transfer_function", nothing())
        }
        Effect::Absorption => Matters("transfer_function", extent.clone()),
        Effect::Emission => Matters("transfer_function", light.to_owned()),
        Effect::SingleScattering | Effect::MultipleScattering => {
            Absent("the classified model scatters no light; shading stands in for it")
        }
        Effect::MediumShadow => match scene.shadow {
            None => NotAsked("classified.shadow"),
            Some(_) if transparent => Null("classified.shadow", nothing()),
            Some(_) => Matters("classified.shadow", darkness.to_owned()),
        },
        Effect::SurfaceShadow => Absent("the classified model has no surfaces"),
        Effect::GradientShading => match &scene.phong {
            None => NotAsked("classified.phong"),
            Some(_) if transparent => Null("classified.phong", nothing()),
            Some(_) if constant => Null(
                "classified.phong",
                "the density is constant: its gradient is 0".to_owned(),
            ),
            Some(_) if scene.grid.lattice().nodes().iter().all(|&nodes| nodes < 3) => Null(
                "classified.phong",
                "no axis has three nodes: the stored gradient is 0".to_owned(),
            ),
            Some(phong) if is_identity(phong) => Null(
                "classified.phong",
                "ambient 1, diffuse 0 and specular 0 leave colours as they are".to_owned(),
            ),
            Some(_) => Matters("classified.phong", "the density has a gradient".to_owned()),
        },
        Effect::Heterogeneity if transparent => Null("classified.volume", nothing()),
        Effect::Heterogeneity if constant => {
            Null("classified.volume", format!("every voxel holds {most}"))
        }
        Effect::Heterogeneity => Matters(
            "classified.volume",
            format!("{numbers} from {least} to {most}"),
        ),
        Effect::ChromaticCoefficients => Absent("opacity is the same for all colours"),
        Effect::AnisotropicPhase => Absent("the classified model has no phase function"),
    };
    let decisions = Decisions::new(finding, forced);
    let on = |effect| decisions.is_on(effect);

    let kernel = if !Effect::ALL.into_iter().any(on) {
        Kernel::Background
    } else {
        let field = match scene.interpolation {
            _ if constant && !on(Effect::Heterogeneity) => FieldKind::Constant,
            Interpolation::Nearest => FieldKind::Nearest,
            Interpolation::Trilinear => FieldKind::Trilinear,
        };
        Kernel::RayCaster {
            field,
            compositing: scene.compositing,
            shading: on(Effect::GradientShading),
            shadow: on(Effect::MediumShadow),
            // Where the volume is transparent everywhere, an effect was forced: its work is
            // wanted, so nothing is skipped.
            skip_empty: !transparent && transfer_function.may_be_transparent_between(least, most),
        }
    };
    Plan {
        decisions: decisions.0,
        approximations: match kernel {
            Kernel::RayCaster { .. } => early_termination(scene).into_iter().collect(),
            _ => vec![],
        },
        kernel,
    }
}

/// By what rays that are ended early may be off: less than the share that is still let through, of
/// the brightest radiance there is.
fn early_termination(scene: &Classified) -> Option<Approximation> {
    match scene.compositing {
        Compositing::EarlyTermination(below) => Some(Approximation {
            without: format!("light behind what lets through less than {below}"),
            field: "classified.early_termination",
            bias: below * scene.brightest(),
        }),
        Compositing::FrontToBack | Compositing::BackToFront => None,
    }
}

/// Whether shading returns every colour unchanged, to the bit.
fn is_identity(phong: &Phong) -> bool {
    phong.ambient == 1.0 && phong.diffuse == 0.0 && phong.specular == 0.0
}

//! The plan for a classified volume.

use super::{
    Approximation, Decisions, Effect, EffectFinding, Estimator, FieldKind, Kernel, Method, Plan,
    RayCasterFeatures, Reason, State,
};
use crate::optics::{Appearance, Phong};
use crate::scene::{Classified, Compositing, Conventions, KeyLines, Panel};
use crate::volume::Interpolation;

const TRANSFER_FUNCTION: &str = "transfer_function";
const VOLUME: &str = "classified.volume";
const PHONG: &str = "classified.phong";
const SHADOW: &str = "classified.shadow";
const LIGHT: &str = "classified.light";
const COMPOSITING: &str = "classified.compositing";
const EARLY_TERMINATION: &str = "classified.early_termination";

/// The plan for a classified volume.
pub(super) fn plan<'s>(panel: &'s Panel, scene: &'s Classified, forced: &[Effect]) -> Plan<'s> {
    let key_lines = &panel.key_lines;
    use EffectFinding::{Absent, NotAsked};
    let null = |field: &str, reason: String| EffectFinding::Null(field.to_owned(), reason);
    let matters = |field: &str, reason: String| EffectFinding::Matters(field.to_owned(), reason);
    let (least, most) = scene.grid.range();
    // Of what is provably null by volref's conventions others make something: nothing is left out.
    let is_conventional = scene.conventions != Conventions::default();
    let constant = !is_conventional && least == most;
    // Grids hold `f32`, whose digits are the shorter ones.
    let (shortest_least, shortest_most) = (least as f32, most as f32);
    let transfer_function = &scene.transfer_function;
    let transparent = !is_conventional && transfer_function.is_transparent_between(least, most);
    let (numbers, nothing, extent, light, darkness) = match transfer_function.appearance {
        Appearance::Formula { .. } => (
            "densities",
            format!("every density, up to {shortest_most}, has opacity 0"),
            format!("densities up to {shortest_most}"),
            "the colormap emits light",
            "densities attenuate light",
        ),
        Appearance::Points(_) => (
            "values",
            format!("every value, from {shortest_least} to {shortest_most}, has opacity 0"),
            format!("values from {shortest_least} to {shortest_most}"),
            "the colours of the points emit light",
            "opacities attenuate light",
        ),
    };
    let nothing = || nothing.clone();
    let has_no_gradient = scene.grid.lattice().nodes().iter().all(|&nodes| nodes < 3);

    let finding = |effect| match effect {
        Effect::Surfaces => Absent("the classified model has no surfaces"),
        Effect::Absorption | Effect::Emission if transparent => null(TRANSFER_FUNCTION, nothing()),
        Effect::Absorption => matters(TRANSFER_FUNCTION, extent.clone()),
        Effect::Emission => matters(TRANSFER_FUNCTION, light.to_owned()),
        Effect::SingleScattering | Effect::MultipleScattering => {
            Absent("the classified model has no scattering; shading replaces it")
        }
        Effect::MediumShadow => match scene.shadow {
            None => NotAsked(SHADOW),
            Some(_) if transparent => null(SHADOW, nothing()),
            Some(_) => matters(SHADOW, darkness.to_owned()),
        },
        Effect::SurfaceShadow => Absent("the classified model has no surfaces"),
        Effect::GradientShading => match &scene.phong {
            None => NotAsked(PHONG),
            Some(_) if transparent => null(PHONG, nothing()),
            Some(_) if constant => null(
                PHONG,
                "the density is constant: its gradient is 0".to_owned(),
            ),
            Some(_) if !is_conventional && has_no_gradient => null(
                PHONG,
                "no axis has three nodes: the stored gradient is 0".to_owned(),
            ),
            Some(phong) if !is_conventional && is_identity(phong) => null(
                PHONG,
                "ambient 1, diffuse 0 and specular 0 leave colours as they are".to_owned(),
            ),
            Some(_) if least == most || has_no_gradient => {
                let reason = "samples without a gradient are shaded, too, by some conventions";
                matters(PHONG, reason.to_owned())
            }
            Some(_) => matters(PHONG, "the density has a gradient".to_owned()),
        },
        Effect::Heterogeneity if transparent => null(VOLUME, nothing()),
        Effect::Heterogeneity if constant => {
            null(VOLUME, format!("every voxel holds {shortest_most}"))
        }
        Effect::Heterogeneity => matters(
            VOLUME,
            format!("{numbers} from {shortest_least} to {shortest_most}"),
        ),
        Effect::ChromaticCoefficients => Absent("opacity is the same for all colours"),
        Effect::AnisotropicPhase => Absent("the classified model has no phase function"),
    };
    let decisions = Decisions::new(finding, forced, key_lines);
    let on = |effect| decisions.is_on(effect);

    let compositing = || {
        let reason = "a classified volume is rendered by compositing samples one step apart";
        Reason::of("classified.step", reason, key_lines)
    };
    let (kernel, method, why) = if !Effect::ALL.into_iter().any(on) {
        let why = Reason::of(TRANSFER_FUNCTION, nothing(), key_lines);
        (Kernel::Background(scene), Method::Background, why)
    } else if scene.is_continuous() {
        let reason = "the integral itself is asked for, without samples";
        let why = Reason::of(COMPOSITING, reason, key_lines);
        (Kernel::Integral(scene), Method::Quadrature, why)
    } else if is_conventional {
        (
            Kernel::Conventional(scene),
            Method::RayCasting,
            compositing(),
        )
    } else {
        let field = match scene.interpolation {
            _ if constant && !on(Effect::Heterogeneity) => FieldKind::Constant,
            Interpolation::Nearest => FieldKind::Nearest,
            Interpolation::Trilinear => FieldKind::Trilinear,
        };
        let features = RayCasterFeatures {
            field,
            compositing: scene.compositing,
            shading: on(Effect::GradientShading),
            shadow: on(Effect::MediumShadow),
            // Where the volume is transparent everywhere, an effect was forced: its work is
            // wanted, so nothing is skipped.
            skip_empty: !transparent
                && !constant
                && transfer_function.may_be_transparent_between(least, most),
        };
        let kernel = Kernel::RayCaster { scene, features };
        (kernel, Method::RayCasting, compositing())
    };
    Plan {
        panel,
        approximations: match kernel {
            Kernel::RayCaster { .. } | Kernel::Conventional(_) => {
                early_termination(scene, key_lines).into_iter().collect()
            }
            _ => vec![],
        },
        warnings: warnings(scene, &decisions, key_lines),
        estimator: Estimator { method, why },
        decisions: decisions.0,
        kernel,
    }
}

/// Keys of the file without any effect.
fn warnings(scene: &Classified, decisions: &Decisions, key_lines: &KeyLines) -> Vec<Reason> {
    let mut warnings = Vec::new();
    let mut warn = |key: &str, message: String| {
        if key_lines.has(key) {
            warnings.push(Reason::of(key, message, key_lines));
        }
    };
    for (effect, key, what) in [
        (Effect::GradientShading, PHONG, "shading"),
        (Effect::MediumShadow, SHADOW, "the shadow"),
        (Effect::Absorption, EARLY_TERMINATION, "early termination"),
    ] {
        let decision = decisions.of(effect);
        if decision.state == State::Elided {
            warn(
                key,
                format!("{what} has no effect: {}", decision.why.reason),
            );
        }
    }
    let on = |effect| decisions.is_on(effect);
    let lights = |phong: Phong| phong.diffuse != 0.0 || phong.specular != 0.0;
    let lit = on(Effect::GradientShading) && scene.phong.is_some_and(lights);
    if !lit && !on(Effect::MediumShadow) {
        let message = "the light has no effect: nothing is shaded by it or casts a shadow";
        warn(LIGHT, message.to_owned());
    }
    warnings
}

/// Bias of early ray termination: at most the transmittance at which a ray ends, times the
/// brightest radiance of the scene.
fn early_termination(scene: &Classified, key_lines: &KeyLines) -> Option<Approximation> {
    match scene.compositing {
        Compositing::EarlyTermination(below) => Some(Approximation {
            without: format!("light behind a transmittance below {below}"),
            field: EARLY_TERMINATION,
            line: key_lines.line(EARLY_TERMINATION),
            bias: below * scene.brightest(),
        }),
        Compositing::FrontToBack | Compositing::BackToFront => None,
    }
}

/// Whether shading returns every colour unchanged, to the bit.
fn is_identity(phong: &Phong) -> bool {
    phong.ambient == 1.0 && phong.diffuse == 0.0 && phong.specular == 0.0
}

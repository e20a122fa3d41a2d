//! The plan for a classified volume.

use super::decision::{findings, stated};
use super::{
    Approximation, Decision, Decisions, Effect, EffectFinding, Kernel, Method, Plan,
    RayCasterFeatures, Reason, State,
};
use crate::optics::Phong;
use crate::scene::{Classified, Compositing, Conventions, KeyLines, Panel};

pub(super) const NO_SCATTERING: &str =
    "the classified model has no scattering; shading replaces it";
pub(super) const ONE_OPACITY: &str = "opacity is the same for all colours";
pub(super) const NO_PHASE: &str = "the classified model has no phase function";

pub(super) const TRANSFER_FUNCTION: &str = "transfer_function";
pub(super) const VOLUME: &str = "classified.volume";
pub(super) const PHONG: &str = "classified.phong";
pub(super) const SHADOW: &str = "classified.shadow";
pub(super) const LIGHT: &str = "classified.light";
pub(super) const COMPOSITING: &str = "classified.compositing";
const EARLY_TERMINATION: &str = "classified.early_termination";

/// The plan for a classified volume.
pub(super) fn plan<'s>(panel: &'s Panel, scene: &'s Classified, forced: &[Effect]) -> Plan<'s> {
    let key_lines = &panel.key_lines;
    let contents = Contents::new(scene);
    let decisions = Decisions::new(|effect| contents.finding(effect), forced, key_lines);
    let (kernel, method, why) = contents.kernel(&decisions, key_lines);
    Plan {
        warnings: warnings(scene, &decisions, key_lines),
        ..Plan::of(panel, decisions, kernel, method, why)
    }
}

/// Contents of a classified volume, as far as its effects depend on them.
struct Contents<'s> {
    scene: &'s Classified,
    /// Smallest and largest value, which grids hold as `f32`, whose digits are the shorter ones.
    range: [f64; 2],
    /// Other conventions make something of what is provably null by volref's own: nothing is left out.
    is_conventional: bool,
    is_constant: bool,
    is_transparent: bool,
    has_no_gradient: bool,
}

impl<'s> Contents<'s> {
    fn new(scene: &'s Classified) -> Contents<'s> {
        let (least, most) = scene.grid.range();
        let is_conventional = scene.conventions != Conventions::default();
        let transfer_function = &scene.transfer_function;
        Contents {
            scene,
            range: [least, most],
            is_conventional,
            is_constant: !is_conventional && least == most,
            is_transparent: !is_conventional
                && transfer_function.is_transparent_between(least, most),
            has_no_gradient: scene.grid.lattice().nodes().iter().all(|&nodes| nodes < 3),
        }
    }

    /// The finding for an effect.
    fn finding(&self, effect: Effect) -> EffectFinding {
        let Contents {
            scene,
            is_transparent,
            is_constant,
            ..
        } = *self;
        let [least, most] = self.range.map(|value| value as f32);
        let values = format!("values from {least} to {most}");
        findings! { effect;
            Surfaces | SurfaceShadow => absent("the classified model has no surfaces");
            Absorption | Emission if is_transparent => null(TRANSFER_FUNCTION, self.transparency());
            Absorption => matters(TRANSFER_FUNCTION, values);
            Emission => matters(TRANSFER_FUNCTION, "the colours of values emit light");
            SingleScattering | MultipleScattering => absent(NO_SCATTERING);
            MediumShadow if scene.shadow.is_none() => not_asked(SHADOW);
            MediumShadow if is_transparent => null(SHADOW, self.transparency());
            MediumShadow => matters(SHADOW, "opacities attenuate light");
            GradientShading if scene.phong.is_none() => not_asked(PHONG);
            GradientShading if is_transparent => null(PHONG, self.transparency());
            GradientShading if self.is_conventional => matters(PHONG, "conventions say how a sample is shaded");
            GradientShading if is_constant => null(PHONG, "the volume is constant: its gradient is 0");
            GradientShading if self.has_no_gradient
                => null(PHONG, "no axis has three nodes: the stored gradient is 0");
            GradientShading if scene.phong.as_ref().is_some_and(is_identity)
                => null(PHONG, "ambient 1, diffuse 0 and specular 0 leave colours as they are");
            GradientShading => matters(PHONG, "the volume has a gradient");
            Heterogeneity if is_transparent => null(VOLUME, self.transparency());
            Heterogeneity if is_constant => null(VOLUME, format!("every voxel holds {most}"));
            Heterogeneity => matters(VOLUME, values);
            ChromaticCoefficients => absent(ONE_OPACITY);
            AnisotropicPhase => absent(NO_PHASE);
        }
    }

    /// The reason for which the whole volume is transparent.
    fn transparency(&self) -> String {
        let [least, most] = self.range.map(|value| value as f32);
        format!("every value, from {least} to {most}, has opacity 0")
    }

    /// The kernel for the effects that are on, with the reason.
    fn kernel(&self, decisions: &Decisions, key_lines: &KeyLines) -> (Kernel<'s>, Method, Reason) {
        let scene = self.scene;
        let on = |effect| decisions.is_on(effect);
        if !Effect::ALL.into_iter().any(on) {
            let why = Reason::of(TRANSFER_FUNCTION, self.transparency(), key_lines);
            return (Kernel::Background(scene), Method::Background, why);
        }
        if scene.continuous {
            let reason = "the integral itself is asked for, without samples";
            let why = Reason::of(COMPOSITING, reason, key_lines);
            return (Kernel::Integral(scene), Method::Quadrature, why);
        }
        let reason = "a classified volume is rendered by compositing samples one step apart";
        let why = Reason::of("classified.step", reason, key_lines);
        let kernel = if self.is_conventional {
            Kernel::Conventional(scene)
        } else {
            let features = self.features(decisions);
            Kernel::RayCaster { scene, features }
        };
        (kernel, Method::RayCasting, why)
    }

    /// Features of the ray caster for the effects that are on.
    fn features(&self, decisions: &Decisions) -> RayCasterFeatures {
        let [least, most] = self.range;
        let on = |effect| decisions.is_on(effect);
        let transfer_function = &self.scene.transfer_function;
        RayCasterFeatures {
            constant: self.is_constant && !on(Effect::Heterogeneity),
            shading: on(Effect::GradientShading),
            shadow: on(Effect::MediumShadow),
            // Where the volume is transparent everywhere, an effect was forced: its work is
            // wanted, so nothing is skipped.
            skip_empty: !self.is_transparent
                && !self.is_constant
                && transfer_function.may_be_transparent_between(least, most),
        }
    }
}

/// Keys of the file without any effect.
fn warnings(scene: &Classified, decisions: &Decisions, key_lines: &KeyLines) -> Vec<Reason> {
    let elided = [
        (Effect::GradientShading, PHONG, "shading"),
        (Effect::MediumShadow, SHADOW, "the shadow"),
        (Effect::Absorption, EARLY_TERMINATION, "early termination"),
    ];
    let elided = elided.into_iter().filter_map(|(effect, key, what)| {
        let Decision { state, why, .. } = decisions.of(effect);
        let message = format!("{what} has no effect: {}", why.reason);
        (*state == State::Elided).then(|| (key.to_owned(), message))
    });
    let lights = |phong: Phong| phong.diffuse != 0.0 || phong.specular != 0.0;
    let lit = decisions.is_on(Effect::GradientShading) && scene.phong.is_some_and(lights);
    let unlit = (!lit && !decisions.is_on(Effect::MediumShadow)).then(|| {
        let message = "the light has no effect: nothing is shaded by it or casts a shadow";
        (LIGHT.to_owned(), message.to_owned())
    });
    let warnings = stated(elided.chain(unlit), key_lines);
    warnings.chain(without_effect(scene, key_lines)).collect()
}

/// The warning of a transfer function that no volume has, as each has its own.
pub(super) fn without_effect(scene: &Classified, key_lines: &KeyLines) -> Option<Reason> {
    let is_own = |volume: usize| {
        let names = [VOLUME.to_owned(), format!("{VOLUME}[{volume}]")];
        let keys = names.map(|name| format!("{name}.{TRANSFER_FUNCTION}"));
        keys.iter().any(|key| key_lines.has(key))
    };
    let occurs = key_lines.has(TRANSFER_FUNCTION) && (0..scene.volume_count()).all(is_own);
    let message = "the transfer function has no effect: every volume has one of its own";
    occurs.then(|| Reason::of(TRANSFER_FUNCTION, message, key_lines))
}

/// Bias of early ray termination: at most the transmittance at which a ray ends, times the
/// brightest radiance of the scene.
pub(super) fn early_termination(scene: &Classified, key_lines: &KeyLines) -> Option<Approximation> {
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

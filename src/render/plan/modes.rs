//! The plan for projections and isosurfaces of a classified volume.

use super::classified::*;
use super::decision::{findings, stated};
use super::{Decisions, Effect, EffectFinding, Kernel, Method, Plan, Reason};
use crate::scene::{
    Classified, Isosurface, Isosurfaces, KeyLines, Mode, Panel, Projected, Projection, Window,
};

const MODE: &str = "classified.mode";
const SURFACES: &str = "classified.isosurface[0]";
const WINDOW: &str = "classified.window";

/// The plan for a classified volume whose samples are not composited.
pub(super) fn plan<'s>(panel: &'s Panel, scene: &'s Classified, forced: &[Effect]) -> Plan<'s> {
    let key_lines = &panel.key_lines;
    let decisions = Decisions::new(|effect| finding(scene, effect), forced, key_lines);
    let is_seen = Effect::ALL
        .into_iter()
        .any(|effect| decisions.is_on(effect));
    let (kernel, method, key, reason) = if !is_seen {
        let kernel = Kernel::Background(scene);
        (kernel, Method::Background, SURFACES, unseen(scene))
    } else if scene.is_exact() {
        let kernel = Kernel::Field(scene);
        let reason = "exact values are asked for, without samples".to_owned();
        (kernel, Method::ClosedForm, COMPOSITING, reason)
    } else {
        let kernel = Kernel::Field(scene);
        let reason = "the field is sampled one step apart".to_owned();
        (kernel, Method::RayCasting, "classified.step", reason)
    };
    let why = Reason::of(key, reason, key_lines);
    Plan {
        warnings: warnings(scene, &decisions, key_lines),
        ..Plan::of(panel, decisions, kernel, method, why)
    }
}

fn finding(scene: &Classified, effect: Effect) -> EffectFinding {
    let (least, most) = scene.grid.range();
    let values = format!("values from {} to {}", least as f32, most as f32);
    let (has_surfaces, is_unseen, absorbs) = match &scene.mode {
        Mode::Isosurfaces(surfaces) => (true, surfaces.are_unseen_between(least, most), true),
        Mode::Projection(it) => (
            false,
            false,
            matches!(it.of, Projected::AttenuatedMaximum(_)),
        ),
        Mode::Composited => (false, false, false),
    };
    findings! { effect;
        Surfaces | SurfaceShadow if has_surfaces
            => absent("isosurfaces are values of the field: none stands beside it");
        Surfaces | SurfaceShadow => absent("a projection shows no surfaces");
        Absorption | Emission | Heterogeneity if is_unseen => null(SURFACES, unseen(scene));
        Absorption if absorbs => matters(MODE, "surfaces or values attenuate what is behind them");
        Absorption => absent("a projection absorbs nothing");
        Emission => matters(MODE, "values and surfaces have colours");
        GradientShading if !has_surfaces => absent("a projection has no normal");
        GradientShading if scene.phong.is_none() => not_asked(PHONG);
        GradientShading if is_unseen => null(PHONG, unseen(scene));
        GradientShading => matters(PHONG, "surfaces have normals");
        Heterogeneity => matters(VOLUME, values);
        MediumShadow => absent("nothing casts a shadow in this mode");
        SingleScattering | MultipleScattering => absent(NO_SCATTERING);
        ChromaticCoefficients => absent(ONE_OPACITY);
        AnisotropicPhase => absent(NO_PHASE);
    }
}

/// The reason for which no ray passes a surface.
fn unseen(scene: &Classified) -> String {
    let (least, most) = scene.grid.range();
    let [least, most] = [least as f32, most as f32];
    format!("no isosurface with an opacity parts the values of the volume, from {least} to {most}")
}

/// Keys of the file without any effect.
fn warnings(scene: &Classified, decisions: &Decisions, key_lines: &KeyLines) -> Vec<Reason> {
    let mut warnings = Vec::new();
    let mut warn = |key: &str, message: String| warnings.push((key.to_owned(), message));
    if !scene.mode.uses_transfer_function() {
        let message = "the transfer function has no effect: colours are those of the window or of the isosurfaces";
        warn(TRANSFER_FUNCTION, message.to_owned());
    }
    if !decisions.is_on(Effect::GradientShading) {
        let message = "the light has no effect: nothing is shaded by it";
        warn(LIGHT, message.to_owned());
    }
    let (least, most) = scene.grid.range();
    let [from, to] = [least as f32, most as f32];
    let values = format!("the values of the volume go from {from} to {to}");
    match &scene.mode {
        Mode::Isosurfaces(Isosurfaces { surfaces, .. }) => {
            for (index, Isosurface { value, .. }) in surfaces.iter().enumerate() {
                if *value <= least || *value > most {
                    let key = format!("classified.isosurface[{index}].value");
                    warn(
                        &key,
                        format!("no ray meets the surface of the value {value}: {values}"),
                    );
                }
            }
        }
        // An integral has another unit than the values.
        Mode::Projection(Projection {
            of,
            window: Some(Window { low, high }),
            ..
        }) if *of != Projected::Sum => {
            if *low >= most {
                warn(
                    WINDOW,
                    format!("all is black: the window begins at {low}, and {values}"),
                );
            } else if *high <= least && !matches!(of, Projected::AttenuatedMaximum(_)) {
                warn(
                    WINDOW,
                    format!("all is white: the window ends at {high}, and {values}"),
                );
            }
        }
        _ => {}
    }
    stated(warnings, key_lines).collect()
}

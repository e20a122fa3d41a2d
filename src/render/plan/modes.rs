//! The plan for projections and isosurfaces of a classified volume.

use super::EffectFinding::{self, Absent, Matters, NotAsked, Null};
use super::classified::early_termination;
use super::several::idle_clips;
use super::{Decisions, Effect, Estimator, Kernel, Method, Plan, Reason};
use crate::scene::{
    Classified, Isosurface, Isosurfaces, KeyLines, Mode, Panel, Projected, Projection, Window,
};

const MODE: &str = "classified.mode";
const ATTENUATION: &str = "classified.attenuation";
const SURFACES: &str = "classified.isosurface[0]";
const WINDOW: &str = "classified.window";
const PHONG: &str = "classified.phong";
const LIGHT: &str = "classified.light";
const COMPOSITING: &str = "classified.compositing";
const TRANSFER_FUNCTION: &str = "transfer_function";

/// The plan for a classified volume whose samples are not composited.
pub(super) fn plan<'s>(panel: &'s Panel, scene: &'s Classified, forced: &[Effect]) -> Plan<'s> {
    let key_lines = &panel.key_lines;
    let decisions = Decisions::new(|effect| finding(scene, effect), forced, key_lines);
    let is_seen = Effect::ALL
        .into_iter()
        .any(|effect| decisions.is_on(effect));
    let because = |field: &str, reason: String| Reason::of(field, reason, key_lines);
    let clipped = match scene.objects.clips.len() {
        0 => String::new(),
        1 => ", within what 1 clip keeps".to_owned(),
        count => format!(", within what {count} clips keep"),
    };
    let (kernel, method, why) = if !is_seen {
        let why = because(SURFACES, unseen(scene));
        (Kernel::Background(scene), Method::Background, why)
    } else if scene.is_exact() {
        let reason = format!("exact values are asked for, without samples{clipped}");
        (
            Kernel::Field(scene),
            Method::ClosedForm,
            because(COMPOSITING, reason),
        )
    } else {
        let reason = format!("the field is sampled one step apart{clipped}");
        (
            Kernel::Field(scene),
            Method::RayCasting,
            because("classified.step", reason),
        )
    };
    Plan {
        panel,
        approximations: early_termination(scene, key_lines).into_iter().collect(),
        warnings: (warnings(scene, &decisions, key_lines).into_iter())
            .chain(idle_clips(scene, key_lines))
            .collect(),
        estimator: Estimator { method, why },
        decisions: decisions.0,
        kernel,
    }
}

fn finding(scene: &Classified, effect: Effect) -> EffectFinding {
    let matters = |field: &str, reason: &str| Matters(field.to_owned(), reason.to_owned());
    let (least, most) = scene.grid.range();
    let surfaces = match &scene.mode {
        Mode::Isosurfaces(surfaces) => Some(surfaces),
        _ => None,
    };
    let is_unseen = surfaces.is_some_and(|surfaces| surfaces.are_unseen_between(least, most));
    let attenuates = matches!(&scene.mode,
        Mode::Projection(projection) if matches!(projection.of, Projected::AttenuatedMaximum(_)));
    match effect {
        Effect::Surfaces | Effect::SurfaceShadow if surfaces.is_some() => {
            Absent("isosurfaces are values of the field: none stands beside it")
        }
        Effect::Surfaces | Effect::SurfaceShadow => Absent("a projection shows no surfaces"),
        Effect::Absorption | Effect::Emission | Effect::Heterogeneity if is_unseen => {
            Null(SURFACES.to_owned(), unseen(scene))
        }
        Effect::Absorption if surfaces.is_some() => {
            matters(SURFACES, "surfaces hide what is behind them")
        }
        Effect::Absorption if attenuates => matters(ATTENUATION, "values attenuate those behind"),
        Effect::Absorption => Absent("a projection absorbs nothing"),
        Effect::Emission => matters(MODE, "values and surfaces have colours"),
        Effect::GradientShading if scene.phong.is_none() && surfaces.is_some() => NotAsked(PHONG),
        Effect::GradientShading if surfaces.is_none() => Absent("a projection has no normal"),
        Effect::GradientShading if is_unseen => Null(PHONG.to_owned(), unseen(scene)),
        Effect::GradientShading => matters(PHONG, "surfaces have normals"),
        Effect::Heterogeneity => {
            let reason = format!("values from {} to {}", least as f32, most as f32);
            Matters("classified.volume".to_owned(), reason)
        }
        Effect::MediumShadow => Absent("nothing casts a shadow in this mode"),
        Effect::SingleScattering | Effect::MultipleScattering => {
            Absent("the classified model has no scattering; shading replaces it")
        }
        Effect::ChromaticCoefficients => Absent("opacity is the same for all colours"),
        Effect::AnisotropicPhase => Absent("the classified model has no phase function"),
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
    let mut warn = |key: &str, message: &str| {
        if key_lines.has(key) {
            warnings.push(Reason::of(key, message, key_lines));
        }
    };
    if !scene.mode.uses_transfer_function() {
        let message = "the transfer function has no effect: colours are those of the window or of the isosurfaces";
        warn(TRANSFER_FUNCTION, message);
    }
    if !decisions.is_on(Effect::GradientShading) {
        warn(LIGHT, "the light has no effect: nothing is shaded by it");
    }
    let (least, most) = scene.grid.range();
    let values = format!(
        "the values of the volume go from {} to {}",
        least as f32, most as f32
    );
    match &scene.mode {
        Mode::Isosurfaces(Isosurfaces { surfaces, .. }) => {
            for (index, Isosurface { value, .. }) in surfaces.iter().enumerate() {
                if *value <= least || *value > most {
                    let message =
                        format!("no ray meets the surface of the value {value}: {values}");
                    warn(&format!("classified.isosurface[{index}].value"), &message);
                }
            }
        }
        // An integral has another unit than the values.
        Mode::Projection(Projection {
            of,
            window: Some(window),
            ..
        }) if *of != Projected::Sum => {
            let Window { low, high } = *window;
            if low >= most {
                warn(
                    WINDOW,
                    &format!("all is black: the window begins at {low}, and {values}"),
                );
            } else if high <= least && !matches!(of, Projected::AttenuatedMaximum(_)) {
                warn(
                    WINDOW,
                    &format!("all is white: the window ends at {high}, and {values}"),
                );
            }
        }
        _ => {}
    }
    warnings
}

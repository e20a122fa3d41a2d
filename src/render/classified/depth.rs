//! Depth of a classified volume, from the optical depths along a ray.
//!
//! A ray passes steps, pieces of several volumes, and surfaces. Their optical depths `τ` are summed: opacity is
//! `1 − e^(−τ)`, and half of it is reached at `ln 2`. So the sums keep their digits in thin volumes. The plain
//! definition is [`reference::depth`](crate::reference::depth).

use super::integral::RayIntegrator;
use super::modes::ExactField;
use super::several::{Caster, PassedLayer};
use crate::conventions::RayCaster;
use crate::film::Depth;
use crate::geometry::Ray;
use crate::math::{exp, exp_m1, ln, ln_1p};
use crate::scene::{Classified, Compositing, Conventions, Isosurface, Mode, Model, Panel, Scene};
use rayon::prelude::*;

/// Depth of each pixel of `scene`, world units, row by row from the top.
///
/// # Errors
///
/// If a panel has no depth: the message says why, and what to do.
pub fn depth(scene: &Scene, depth: Depth) -> Result<Vec<f32>, String> {
    let of_panel = |panel| {
        let volume = volume_with_depth(panel)?;
        Ok((panel, volume, depth_along(volume, depth.half)))
    };
    let panels: Result<Vec<_>, String> = scene.panels.iter().map(of_panel).collect();
    let panels = panels?;
    let pixels: Vec<_> = (0..scene.height())
        .flat_map(|row| {
            let panels = panels.iter();
            panels.flat_map(move |of| (0..of.0.width).map(move |column| (of, [column, row])))
        })
        .collect();
    let of_pixel =
        |&((panel, volume, along), pixel): &(&(&Panel, &Classified, DepthAlong<'_>), _)| {
            let ray = volume.camera.ray(pixel, [panel.width, panel.height]);
            let cosine = ray.direction.dot(*volume.camera.axis);
            let scale = if depth.along_view { cosine } else { 1.0 };
            (scale * along(&ray)) as f32
        };
    Ok(pixels.par_iter().map(of_pixel).collect())
}

/// The volume of `panel`, if its depth is defined.
fn volume_with_depth(panel: &Panel) -> Result<&Classified, String> {
    let reason = match &panel.model {
        Model::Classified(volume) if matches!(volume.mode, Mode::Projection(_)) => {
            "a projection has no depth: leave `mode` out, or ask for isosurfaces"
        }
        Model::Classified(volume) if volume.conventions != Conventions::default() => {
            "depth is that of volref's own conventions: leave out [classified.conventions]"
        }
        Model::Classified(volume) => return Ok(volume),
        _ => "depth is that of a classified volume, and the scene has none",
    };
    Err(reason.to_owned())
}

/// The depth along a ray, world units.
type DepthAlong<'s> = Box<dyn Fn(&Ray) -> f64 + Sync + 's>;

/// The depth along rays through `volume`: where opacity reaches one `half`, or else its mean.
fn depth_along(volume: &Classified, half: bool) -> DepthAlong<'_> {
    let of_layers = move |layers| depth_of(layers, volume.compositing, half);
    let of_surfaces = move |passed: Vec<(f64, Isosurface)>| {
        let layers = passed.into_iter().map(|(t, surface)| PassedLayer {
            t,
            length: 0.0,
            opacity: surface.opacity,
        });
        of_layers(layers.collect())
    };
    match &volume.mode {
        Mode::Isosurfaces(surfaces) if volume.is_exact() => {
            let field = ExactField::new(volume);
            Box::new(move |ray| of_surfaces(field.passed_along(surfaces, ray)))
        }
        Mode::Isosurfaces(surfaces) => {
            let caster = RayCaster::with_gradients(volume, None);
            Box::new(move |ray| of_surfaces(caster.passed_along(surfaces, ray)))
        }
        _ if volume.continuous => {
            let integrator = RayIntegrator::new(volume);
            Box::new(move |ray| integrator.depth(ray, half))
        }
        _ => {
            let caster = Caster::unlit(volume);
            Box::new(move |ray| of_layers(caster.passed(ray)))
        }
    }
}

/// Depth of these layers, from the eye on; infinite where there is none.
fn depth_of(layers: Vec<PassedLayer>, compositing: Compositing, half: bool) -> f64 {
    let half_of_it = ln(2.0);
    let (mut before, mut moments) = (0.0, 0.0);
    for PassedLayer { t, length, opacity } in layers {
        let depth = ln_1p(-opacity).abs();
        if half && before + depth >= half_of_it {
            let begin = t - 0.5 * length;
            return begin + length * ((half_of_it - before) / depth);
        }
        moments += t * exp(-before) * -exp_m1(-depth);
        before += depth;
        if matches!(compositing, Compositing::EarlyTermination(least) if exp(-before) < least) {
            break;
        }
    }
    if half || before == 0.0 {
        return f64::INFINITY;
    }
    moments / -exp_m1(-before)
}

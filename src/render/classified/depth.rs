//! Depth of a classified volume, from the optical depths along a ray.
//!
//! Steps, pieces of several volumes and surfaces that a ray passes are summed as optical depths `τ`, in which opacity is `1 − e^(−τ)` and half of it is reached at
//! `ln 2`: the sums keep their digits in thin volumes. The plain definition is
//! [`reference::depth`](crate::reference::depth).

use super::integral::RayIntegrator;
use super::modes::ExactField;
use super::several::Caster;
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
    of_pixels(
        scene,
        depth.along_view,
        |volume, passed, ray| match passed {
            Passed::Integral(integral) => integral.depth(ray, depth.half),
            Passed::Layers(layers) => along(&layers(ray), volume.compositing, depth.half),
        },
    )
}

/// A distance of each pixel, from the volume of its panel, what rays pass there, and its ray.
fn of_pixels(
    scene: &Scene,
    along_view: bool,
    distance: impl Fn(&Classified, &Passed<'_>, &Ray) -> f64 + Sync,
) -> Result<Vec<f32>, String> {
    let panels: Result<Vec<_>, String> = scene
        .panels
        .iter()
        .map(|panel| Ok((panel, passed(panel)?)))
        .collect();
    let panels = panels?;
    let pixels: Vec<_> = (0..scene.height())
        .flat_map(|row| {
            let pixels = panels.iter().map(move |(panel, passed)| {
                (0..panel.width).map(move |column| (panel, passed, [column, row]))
            });
            pixels.flatten()
        })
        .collect();
    let of_pixel = |(panel, (volume, passed), pixel): (&&Panel, &(&Classified, Passed<'_>), _)| {
        let ray = volume.camera.ray(pixel, [panel.width, panel.height]);
        let cosine = ray.direction.dot(*volume.camera.axis);
        let scale = if along_view { cosine } else { 1.0 };
        (scale * distance(volume, passed, &ray)) as f32
    };
    Ok(pixels.into_par_iter().map(of_pixel).collect())
}

/// A step of a ray through volumes, or a surface that it passes.
struct Layer {
    /// Distance of its middle from the eye.
    t: f64,
    /// Length along the ray; 0 for a surface.
    length: f64,
    /// Optical depth.
    depth: f64,
}

impl Layer {
    fn of((t, length, opacity): (f64, f64, f64)) -> Layer {
        Layer {
            t,
            length,
            depth: ln_1p(-opacity).abs(),
        }
    }

    fn of_surfaces(passed: Vec<(f64, Isosurface)>) -> Vec<Layer> {
        let layer = |(t, surface): (f64, Isosurface)| Layer::of((t, 0.0, surface.opacity));
        passed.into_iter().map(layer).collect()
    }
}

/// What a ray passes, from the eye on.
type LayersAlong<'s> = dyn Fn(&Ray) -> Vec<Layer> + Sync + 's;

/// What rays pass.
enum Passed<'s> {
    /// Steps, pieces of several volumes, or surfaces.
    Layers(Box<LayersAlong<'s>>),
    /// Volumes without steps, and a surface.
    Integral(Box<RayIntegrator<'s>>),
}

/// The volume of a panel, and what rays pass in it.
fn passed(panel: &Panel) -> Result<(&Classified, Passed<'_>), String> {
    let Model::Classified(volume) = &panel.model else {
        return Err("depth is that of a classified volume, and the scene has none".to_owned());
    };
    if matches!(volume.mode, Mode::Projection(_)) {
        return Err(
            "a projection has no depth: leave `mode` out, or ask for isosurfaces".to_owned(),
        );
    }
    if volume.conventions != Conventions::default() {
        return Err(
            "depth is that of volref's own conventions: leave out [classified.conventions]"
                .to_owned(),
        );
    }
    let passed = match &volume.mode {
        Mode::Isosurfaces(surfaces) if volume.is_exact() => {
            let field = ExactField::new(volume);
            Passed::Layers(Box::new(move |ray| {
                Layer::of_surfaces(field.passed_along(surfaces, ray))
            }))
        }
        Mode::Isosurfaces(surfaces) => {
            let caster = RayCaster::with_gradients(volume, None);
            Passed::Layers(Box::new(move |ray| {
                Layer::of_surfaces(caster.passed_along(surfaces, ray))
            }))
        }
        _ if volume.continuous => Passed::Integral(Box::new(RayIntegrator::new(volume))),
        _ => {
            let caster = Caster::unlit(volume);
            Passed::Layers(Box::new(move |ray| {
                caster.passed(ray).into_iter().map(Layer::of).collect()
            }))
        }
    };
    Ok((volume, passed))
}

/// Depth of these layers, from the eye on; infinite where there is none.
fn along(layers: &[Layer], compositing: Compositing, half: bool) -> f64 {
    let half_of_it = ln(2.0);
    let (mut before, mut moments) = (0.0, 0.0);
    for Layer { t, length, depth } in layers {
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

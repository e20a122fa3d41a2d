//! Depth of a classified volume, from the optical depths along a ray.
//!
//! The steps of a ray are summed as optical depths `τ`, in which opacity is `1 − e^(−τ)` and half of it is reached at
//! `ln 2`: the sums keep their digits in thin volumes. The plain definition is
//! [`reference::depth`](crate::reference::depth).

use super::steps::Steps;
use crate::film::Depth;
use crate::geometry::Ray;
use crate::math::{exp, exp_m1, ln, ln_1p};
use crate::scene::{Classified, Compositing, Conventions, Model, Scene};
use crate::volume::{Cell, NodeLine, Reconstruction as _};
use rayon::prelude::*;

/// Depth of each pixel of `scene`, world units, row by row from the top.
///
/// # Errors
///
/// If a panel has no depth of this kind: the message says why, and what to do.
pub fn depth(scene: &Scene, depth: Depth) -> Result<Vec<f32>, String> {
    let mut panels: Vec<(&Classified, [usize; 2])> = Vec::new();
    for panel in &scene.panels {
        let Model::Classified(volume) = &panel.model else {
            return Err("depth is that of a classified volume, and the scene has none".to_owned());
        };
        if volume.is_continuous() {
            return Err(
                "the integral without samples has no depth yet: state a step, in the scene or by --step".to_owned(),
            );
        }
        if volume.conventions != Conventions::default() {
            return Err(
                "depth is that of volref's own conventions: leave out [classified.conventions]"
                    .to_owned(),
            );
        }
        panels.push((volume, [panel.width, panel.height]));
    }
    let pixels: Vec<(&Classified, [usize; 2], [usize; 2])> = (0..scene.height())
        .flat_map(|row| {
            panels.iter().flat_map(move |&(volume, size)| {
                (0..size[0]).map(move |column| (volume, [column, row], size))
            })
        })
        .collect();
    let of_pixel = |(volume, pixel, size): (&Classified, _, _)| {
        let ray = volume.camera.ray(pixel, size);
        let cosine = ray.direction.dot(*volume.camera.forward());
        let scale = if depth.along_view { cosine } else { 1.0 };
        (scale * along(volume, &ray, depth.half)) as f32
    };
    Ok(pixels.into_par_iter().map(of_pixel).collect())
}

/// Depth along `ray`; infinite where there is none.
fn along(volume: &Classified, ray: &Ray, half: bool) -> f64 {
    let lattice = volume.grid.lattice();
    let extent = volume.extent();
    let Some(span) = extent.span(ray) else {
        return f64::INFINITY;
    };
    let line = NodeLine::new(extent.line(ray), lattice);
    let steps = Steps::over(span, volume.step);
    let least = match volume.compositing {
        Compositing::EarlyTermination(least) => least,
        _ => 0.0,
    };
    let half_of_it = ln(2.0);
    let (mut before, mut moments) = (0.0, 0.0);
    for index in 0..steps.count() {
        let (t, length) = steps.sample(index);
        let value = volume
            .interpolation
            .read(&*volume.grid, &Cell::around(lattice, line.at(t)));
        let own = (-ln_1p(-volume.transfer_function.opacity(value, length))).abs();
        if half && before + own >= half_of_it {
            let begin = t - 0.5 * length;
            return begin + length * (half_of_it - before) / own;
        }
        moments += t * exp(-before) * -exp_m1(-own);
        before += own;
        if exp(-before) < least {
            break;
        }
    }
    if half || before == 0.0 {
        return f64::INFINITY;
    }
    moments / -exp_m1(-before)
}

//! Depth of a classified volume, from the optical depths along a ray.
//!
//! Steps, pieces of several volumes and surfaces that a ray passes are summed as optical depths `τ`, in which opacity is `1 − e^(−τ)` and half of it is reached at
//! `ln 2`: the sums keep their digits in thin volumes. The plain definition is
//! [`reference::depth`](crate::reference::depth).

use super::modes::ExactField;
use super::several::Caster;
use super::several_integral::SeveralIntegrator;
use super::steps::Steps;
use crate::conventions::RayCaster;
use crate::film::Depth;
use crate::geometry::Ray;
use crate::math::{exp, exp_m1, ln, ln_1p};
use crate::scene::{Classified, Compositing, Conventions, Isosurface, Mode, Model, Panel, Scene};
use crate::volume::{Cell, NodeLine};
use rayon::prelude::*;

/// Depth of each pixel of `scene`, world units, row by row from the top.
///
/// # Errors
///
/// If a panel has no depth: the message says why, and what to do.
pub fn depth(scene: &Scene, depth: Depth) -> Result<Vec<f32>, String> {
    of_pixels(scene, depth.along_view, |panel, ray| match &panel.passed {
        Passed::Integral(integral) => integral.depth(ray, depth.half),
        _ => along(&panel.layers(ray), depth.half),
    })
}

/// Distance of the first sample or surface with any opacity, in place of a [`depth`].
///
/// # Errors
///
/// As of [`depth`].
pub fn first_opacity(scene: &Scene, along_view: bool) -> Result<Vec<f32>, String> {
    of_pixels(scene, along_view, |panel, ray| {
        if let Passed::Integral(integral) = &panel.passed {
            return integral.first_opacity(ray);
        }
        let layers = panel.layers(ray);
        let first = layers.iter().find(|layer| layer.depth > 0.0);
        first.map_or(f64::INFINITY, |layer| layer.t)
    })
}

/// A distance of each pixel, from its panel and its ray.
fn of_pixels(
    scene: &Scene,
    along_view: bool,
    distance: impl Fn(&LayersOfPanel<'_>, &Ray) -> f64 + Sync,
) -> Result<Vec<f32>, String> {
    let panels: Result<Vec<_>, _> = scene.panels.iter().map(LayersOfPanel::of).collect();
    let panels = panels?;
    let pixels: Vec<(&LayersOfPanel<'_>, [usize; 2])> = (0..scene.height())
        .flat_map(|row| {
            let columns = |panel: &LayersOfPanel<'_>| 0..panel.size[0];
            panels
                .iter()
                .flat_map(move |panel| columns(panel).map(move |column| (panel, [column, row])))
        })
        .collect();
    let of_pixel = |(panel, pixel): (&LayersOfPanel<'_>, [usize; 2])| {
        let camera = &panel.volume.camera;
        let ray = camera.ray(pixel, panel.size);
        let cosine = ray.direction.dot(*camera.axis());
        let scale = if along_view { cosine } else { 1.0 };
        (scale * distance(panel, &ray)) as f32
    };
    Ok(pixels.into_par_iter().map(of_pixel).collect())
}

/// A step of a ray through the volume, or a surface that it passes.
struct Layer {
    /// Distance of its middle from the eye.
    t: f64,
    /// Length along the ray; 0 for a surface.
    length: f64,
    /// Optical depth.
    depth: f64,
}

impl Layer {
    fn of((t, length): (f64, f64), opacity: f64) -> Layer {
        Layer {
            t,
            length,
            depth: ln_1p(-opacity).abs(),
        }
    }
}

/// The layers of a classified volume along rays.
struct LayersOfPanel<'s> {
    volume: &'s Classified,
    size: [usize; 2],
    passed: Passed<'s>,
}

/// Matter along a ray.
enum Passed<'s> {
    /// Steps of one volume.
    Steps,
    /// Pieces of several volumes, and a surface.
    Pieces(Box<Caster<'s>>),
    /// Volumes without steps, and a surface.
    Integral(Box<SeveralIntegrator<'s>>),
    /// Isosurfaces, found without samples.
    ExactSurfaces(Box<ExactField<'s>>),
    /// Isosurfaces, found by samples.
    SampledSurfaces(Box<RayCaster<'s>>),
}

impl<'s> LayersOfPanel<'s> {
    fn of(panel: &'s Panel) -> Result<LayersOfPanel<'s>, String> {
        let Model::Classified(volume) = &panel.model else {
            return Err("depth is that of a classified volume, and the scene has none".to_owned());
        };
        let refusal = match &volume.mode {
            Mode::Projection(_) => {
                Some("a projection has no depth: leave `mode` out, or ask for isosurfaces")
            }
            _ if volume.conventions != Conventions::default() => Some(
                "depth is that of volref's own conventions: leave out [classified.conventions]",
            ),
            _ => None,
        };
        match refusal {
            Some(reason) => Err(reason.to_owned()),
            None => Ok(LayersOfPanel {
                volume,
                size: [panel.width, panel.height],
                passed: match volume.mode {
                    Mode::Isosurfaces(_) if volume.is_exact() => {
                        Passed::ExactSurfaces(Box::new(ExactField::new(volume)))
                    }
                    Mode::Isosurfaces(_) => {
                        Passed::SampledSurfaces(Box::new(RayCaster::with_gradients(volume, None)))
                    }
                    _ if volume.is_continuous() => {
                        Passed::Integral(Box::new(SeveralIntegrator::new(volume)))
                    }
                    _ if volume.has_objects() => Passed::Pieces(Box::new(Caster::unlit(volume))),
                    _ => Passed::Steps,
                },
            }),
        }
    }

    fn layers(&self, ray: &Ray) -> Vec<Layer> {
        let surfaces = match (&self.volume.mode, &self.passed) {
            (Mode::Isosurfaces(surfaces), Passed::ExactSurfaces(field)) => {
                field.passed_along(surfaces, ray)
            }
            (Mode::Isosurfaces(surfaces), Passed::SampledSurfaces(caster)) => {
                caster.passed_along(surfaces, ray)
            }
            (_, Passed::Pieces(caster)) => {
                let pieces = caster.passed(ray).into_iter();
                return pieces
                    .map(|(t, length, opacity)| Layer::of((t, length), opacity))
                    .collect();
            }
            _ => return self.steps(ray),
        };
        let layer = |(t, surface): (f64, Isosurface)| Layer::of((t, 0.0), surface.opacity);
        surfaces.into_iter().map(layer).collect()
    }

    /// The steps of `ray` through the volume, as far as it goes.
    fn steps(&self, ray: &Ray) -> Vec<Layer> {
        let (volume, extent) = (self.volume, self.volume.extent());
        let lattice = volume.grid.lattice();
        let Some(span) = extent.span(ray) else {
            return vec![];
        };
        let line = NodeLine::new(extent.line(ray), lattice);
        let steps = Steps::over(span, volume.step);
        let least = match volume.compositing {
            Compositing::EarlyTermination(least) => least,
            _ => 0.0,
        };
        let mut before = 0.0;
        let mut layers = Vec::new();
        for index in 0..steps.count() {
            let (t, length) = steps.sample(index);
            let cell = Cell::around(lattice, line.at(t));
            let value = volume.interpolation.read(&*volume.grid, &cell);
            let layer = Layer::of((t, length), volume.transfer_function.opacity(value, length));
            before += layer.depth;
            layers.push(layer);
            if exp(-before) < least {
                break;
            }
        }
        layers
    }
}

/// Depth of these layers, from the eye on; infinite where there is none.
fn along(layers: &[Layer], half: bool) -> f64 {
    let half_of_it = ln(2.0);
    let (mut before, mut moments) = (0.0, 0.0);
    for Layer { t, length, depth } in layers {
        if half && before + depth >= half_of_it {
            let begin = t - 0.5 * length;
            return begin + length * ((half_of_it - before) / depth);
        }
        moments += t * exp(-before) * -exp_m1(-depth);
        before += depth;
    }
    if half || before == 0.0 {
        return f64::INFINITY;
    }
    moments / -exp_m1(-before)
}

//! The ray caster for classified volumes, as plainly as it can be written.
//!
//! A ray sees the volume-rendering integral over its span inside the volume, in front of the
//! background `B` (Max 1995, §4): at distance `t` the volume has an extinction `σ` and, towards the
//! eye, a colour `c`.
//!
//! ```text
//! L = ∫ c(t) σ(t) T(t) dt + B T(end),     T(t) = exp(−∫₀ᵗ σ(s) ds)
//! ```
//!
//! A sum over steps of length `h` replaces the integral; the middle of a step stands for all of it.
//! The transfer function states the opacity `a₀ = 1 − exp(−σ h₀)` of each density over a reference
//! length `h₀`, from which that of a step of any length follows (Levoy 1988):
//!
//! ```text
//! L = Σᵢ cᵢ aᵢ Tᵢ + B Tₙ,     Tᵢ = Π (1 − aⱼ) over j < i,     a = 1 − (1 − a₀)^(h/h₀)
//! c = shade(colour(d)) · strength(d) · visibility
//! ```
//!
//! The density `d` is interpolated in the grid. `shade` is Phong's model with minus the density
//! gradient as normal, if the scene asks for it; `strength` is `d²` for the formula of the
//! ray-casting assignment ([`TransferOpacity`](crate::media::TransferOpacity)) and 1 for a table of
//! points; `visibility` is the share of light that reaches the sample through the volume.
//!
//! Sources: Levoy 1988, "Display of surfaces from volume data"; Max 1995, "Optical models for
//! direct volume rendering"; Porter & Duff 1984, "Compositing digital images".

use crate::film::Film;
use crate::geometry::{Ray, Span, direction_of, length_of};
use crate::math::exp;
use crate::media::{Appearance, over_length};
use crate::scene::{Classified, Compositing};
use crate::volume::{Cell, Grid, NodeLine, NodePoint, Reconstruction, relative_gradients};
use glam::DVec3;
use rayon::prelude::*;

/// The image of `scene`: radiance, background included, and the opacity of the volume in front of
/// it; one ray through the centre of each pixel.
pub fn render(scene: &Classified, [width, height]: [usize; 2]) -> Film {
    let volume = Volume {
        scene,
        gradients: relative_gradients(&*scene.grid),
    };
    let pixels: Vec<[f32; 4]> = (0..width * height)
        .into_par_iter()
        .map(|index| {
            let pixel = [index % width, index / width];
            let seen = volume.cast(&scene.camera.ray(pixel, [width, height]));
            let radiance = seen.colour + scene.background * seen.transparency;
            [radiance.x, radiance.y, radiance.z, seen.opacity].map(|value| value as f32)
        })
        .collect();
    Film::with_opacity(width, height, pixels)
}

/// A scene, and the density gradient at every node of its grid, in a unit of the grid's own: shading
/// uses the direction alone.
struct Volume<'s> {
    scene: &'s Classified,
    gradients: Grid<[f32; 3]>,
}

/// The samples of a ray, composited.
struct Composite {
    /// Associated colour: multiplied by opacity.
    colour: DVec3,
    /// Share of the light from behind that is absorbed.
    opacity: f64,
    /// Share of the light from behind that passes.
    transparency: f64,
}

impl Volume<'_> {
    /// Marches along `ray` and composites its samples.
    fn cast(&self, ray: &Ray) -> Composite {
        let (scene, lattice) = (self.scene, self.scene.grid.lattice());
        let mut seen = Composite {
            colour: DVec3::ZERO,
            opacity: 0.0,
            transparency: 1.0,
        };
        let Some(span) = lattice.bounds().span(ray) else {
            return seen;
        };
        let line = NodeLine::new(ray, lattice);
        let steps = step_count(span, scene.step);
        for step in 0..steps {
            let index = match scene.compositing {
                Compositing::BackToFront => steps - 1 - step,
                Compositing::FrontToBack | Compositing::EarlyTermination(_) => step,
            };
            let (t, length) = sample(span, scene.step, steps, index);
            let nodes = line.at(t);
            let cell = Cell::around(lattice, nodes);
            let density = scene.interpolation.read(&*scene.grid, &cell);
            let opacity = scene.transfer_function.opacity(density, length);
            if opacity == 0.0 {
                continue; // nothing to add, whatever its colour
            }
            let point = ray.at(t);
            let light = scene.transfer_function.strength(density) * self.visibility(point, nodes);
            let colour = self.shade(ray, point, &cell, density) * light * opacity;

            // The operator "over" of Porter & Duff 1984.
            let passed = seen.transparency * (1.0 - opacity);
            if scene.compositing == Compositing::BackToFront {
                seen.colour = colour + seen.colour * (1.0 - opacity);
                seen.opacity = opacity + seen.opacity * (1.0 - opacity);
            } else {
                seen.colour += colour * seen.transparency;
                seen.opacity += opacity * seen.transparency;
            }
            seen.transparency = passed;
            // A thin volume keeps the digits of its opacity in the sum; the sum of a thick one could
            // exceed 1 by rounding, where the difference cannot.
            if passed < 0.5 {
                seen.opacity = 1.0 - passed;
            }
            if let Compositing::EarlyTermination(below) = scene.compositing
                && passed < below
            {
                break;
            }
        }
        seen
    }

    /// Colour of a sample of `density` at `point`, lit by Phong's model where the scene has one.
    fn shade(&self, ray: &Ray, point: DVec3, cell: &Cell, density: f64) -> DVec3 {
        let colour = self.scene.transfer_function.colour(density);
        let Some(phong) = &self.scene.phong else {
            return colour;
        };
        let gradient = self.scene.interpolation.read(&self.gradients, cell);
        let to_light = direction_of(self.scene.light - point).unwrap_or(DVec3::ZERO);
        phong.shade(colour, gradient, to_light, -ray.direction)
    }

    /// Transmittance from `point` to the light. With the formula of the assignment
    /// `min(1, exp(−S/100))`, `S` the sum of densities over steps of the reference length; with a
    /// table the product of `1 − a` over all steps.
    fn visibility(&self, point: DVec3, nodes: NodePoint) -> f64 {
        let (scene, lattice) = (self.scene, self.scene.grid.lattice());
        let to_light = scene.light - point;
        let (Some(shadow), Some(ray)) = (scene.shadow, Ray::new(point, to_light)) else {
            return 1.0;
        };
        let Some(inside) = lattice.bounds().span(&ray) else {
            return 1.0;
        };
        let span = Span {
            near: 0.0,
            far: inside.far.min(length_of(to_light)),
        };
        let line = NodeLine::from(nodes, ray.direction, lattice);
        let steps = step_count(span, shadow.step);
        let (mut sum, mut transparency) = (0.0, 1.0);
        for index in 0..steps {
            let (t, length) = sample(span, shadow.step, steps, index);
            let cell = Cell::around(lattice, line.at(t));
            let density = scene.interpolation.read(&*scene.grid, &cell);
            match &scene.transfer_function.appearance {
                Appearance::Formula { .. } => sum += density * length,
                Appearance::Points(points) => {
                    let opacity = points.opacity(density);
                    transparency *= 1.0 - over_length(opacity, length / shadow.reference_step);
                }
            }
        }
        exp(-(sum / shadow.reference_step) / 100.0).min(1.0) * transparency
    }
}

/// Number of steps of length `step` over `span`; the last one ends with the span. At least one where
/// the span has a length, even if the quotient underflows.
fn step_count(span: Span, step: f64) -> usize {
    let count = (span.length() / step).ceil() as usize;
    if span.length() > 0.0 {
        count.max(1)
    } else {
        count
    }
}

/// Distance of the middle of step `index` of `count`, and the length of the step. Computed from the
/// index: sums of lengths accumulate rounding errors.
fn sample(span: Span, step: f64, count: usize, index: usize) -> (f64, f64) {
    if index + 1 < count {
        return (span.near + (index as f64 + 0.5) * step, step);
    }
    let begin = index as f64 * step;
    let rest = (span.length() - begin).max(0.0);
    (span.near + (begin + 0.5 * rest), rest)
}

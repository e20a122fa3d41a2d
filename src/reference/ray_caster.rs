//! The ray caster for classified volumes, as plainly as it can be written.
//!
//! The transfer function gives every density along a ray a colour `c` and an extinction `σ`. The
//! ray sees the volume-rendering integral (Max 1995, eq. 8) over its span inside the volume, in
//! front of the background `B`:
//!
//! ```text
//! L = ∫ c(t) σ(t) T(t) dt + B T(end),     T(t) = exp(−∫₀ᵗ σ(s) ds)
//! ```
//!
//! A sum over steps of length `h` replaces the integral. The density in the middle of a step
//! stands for the whole step, whose opacity `a` follows from the opacity `a₀` that the transfer
//! function states over the length `h₀` (Levoy 1988, eq. 1–3):
//!
//! ```text
//! L = Σᵢ cᵢ aᵢ Tᵢ + B Tₙ,     Tᵢ = Π (1 − aⱼ) over j < i,     a = 1 − (1 − a₀)^(h/h₀)
//! ```
//!
//! Sources: Levoy 1988, "Display of surfaces from volume data"; Max 1995, "Optical models for
//! direct volume rendering".

use crate::film::Film;
use crate::geometry::{Ray, Span, direction_of, length_of};
use crate::math::exp;
use crate::media::{Appearance, over_length};
use crate::scene::{Classified, Compositing};
use crate::volume::{Cell, Grid, Reconstruction, relative_gradients};
use glam::DVec3;
use rayon::prelude::*;

/// The image of `scene`: radiance and opacity, one ray through the centre of each pixel.
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

/// A scene and the density gradient at every node of its grid.
struct Volume<'s> {
    scene: &'s Classified,
    gradients: Grid<[f32; 3]>,
}

/// The samples of a ray, composited.
struct Composite {
    /// Associated colour: multiplied by opacity.
    colour: DVec3,
    /// Share of the light from behind that is held back.
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
        let (origin, direction) = (
            lattice.to_nodes(ray.origin),
            ray.direction / lattice.spacing(),
        );
        let steps = step_count(span, scene.step);
        for step in 0..steps {
            let index = match scene.compositing {
                Compositing::BackToFront => steps - 1 - step,
                Compositing::FrontToBack | Compositing::EarlyTermination(_) => step,
            };
            let (t, length) = sample(span, scene.step, steps, index);
            let nodes = origin + direction * t;
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
            if passed < 0.5 {
                seen.opacity = 1.0 - passed; // never above 1, as the sum may be by rounding
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

    /// Share of the light that reaches `point` through the volume: `exp(−S/100)` by the formula of
    /// the assignment, `S` the sum of densities over reference lengths; by a table of points the
    /// transparency of all samples.
    fn visibility(&self, point: DVec3, nodes: DVec3) -> f64 {
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
        let direction = ray.direction / lattice.spacing();
        let steps = step_count(span, shadow.step);
        let (mut sum, mut transparency) = (0.0, 1.0);
        for index in 0..steps {
            let (t, length) = sample(span, shadow.step, steps, index);
            let cell = Cell::around(lattice, nodes + direction * t);
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

/// Number of steps of length `step` over `span`, the last one shorter.
fn step_count(span: Span, step: f64) -> usize {
    let count = (span.length() / step).ceil() as usize;
    if span.length() > 0.0 {
        count.max(1)
    } else {
        count
    }
}

/// Middle and length of step `index` of `count`. By the index, since adding up lengths drifts.
fn sample(span: Span, step: f64, count: usize, index: usize) -> (f64, f64) {
    if index + 1 < count {
        return (span.near + (index as f64 + 0.5) * step, step);
    }
    let begin = index as f64 * step;
    let rest = (span.length() - begin).max(0.0);
    (span.near + (begin + 0.5 * rest), rest)
}

//! Several volumes in one picture, among surfaces, as plainly as it can be written.
//!
//! Where volumes overlap, each absorbs and sends out light as if it were alone: at a distance `t` of a
//! ray their extinctions add, and their colours are averaged, weighted by extinction (Max 1995, §2: for
//! particles of several kinds, what they cover and what they glow add up).
//!
//! ```text
//! σ = Σᵢ σᵢ,     c = Σᵢ cᵢ σᵢ / Σᵢ σᵢ
//! ```
//!
//! Each volume is constant over each of its own steps, as [`ray_caster`](super::ray_caster) has it: they
//! are counted from where the ray enters it, or comes out of the planes that cut it (`clips.rs`), and
//! values are those at their midpoints. The ends of the steps of all volumes together cut the ray into
//! pieces. Over each, of length `l`, all is constant, so that the integral has a closed form:
//!
//! ```text
//! L = Σ c a T + B T(end),     a = 1 − Πᵢ (1 − aᵢ(l)),     aᵢ(l) = 1 − (1 − a₀ᵢ)^(l/h₀ᵢ)
//! ```
//!
//! An opacity `a₀` of 1 is an infinite extinction: it hides the finite ones, and several such share equally.
//! So the order of volumes changes nothing but rounding, and neither does an empty one.
//!
//! Where the opacity of a volume is modulated, `a₀` is that of its value times a factor, by a second number at
//! the same place, such as the length of the gradient (Levoy 1988, §3).
//!
//! The nearest surface (`clips.rs`) ends the ray: its radiance stands in the place of the background
//! `B`, and the pixel is opaque. The visibility of the light, where the scene asks for shadows, is the
//! product of those through all volumes, each by shadow steps of its own, counted from the point or from
//! where the ray towards the light enters it; 0 behind a surface. Parts that are cut away cast no shadow.
//!
//! Sources: Max 1995, "Optical models for direct volume rendering"; Levoy 1988, "Display of surfaces from
//! volume data".

use super::clips::{SeveralVolumes, nearest_hit, span, surface_radiance, visibility};
use super::placement::in_volume;
use super::ray_caster::{Layer, midpoint, step_count};
use crate::film::Film;
use crate::geometry::{Ray, Span};
use crate::math::ln_1p;
use crate::optics::over_length;
use crate::scene::{Classified, Modulation};
use crate::volume::{Cell, NodeLine};
use glam::DVec3;
use rayon::prelude::*;

/// The image of `scene`: radiance, background included, and opacity.
pub fn render(scene: &Classified, [width, height]: [usize; 2]) -> Film {
    let alone: Vec<Classified> = scene.each_alone().collect();
    let caster = SeveralVolumes::of(scene, &alone);
    let pixels: Vec<[f32; 4]> = (0..width * height)
        .into_par_iter()
        .map(|index| {
            let pixel = [index % width, index / width];
            let seen = caster.cast(&scene.camera.ray(pixel, [width, height]));
            let radiance = seen.colour + scene.background * seen.transparency;
            [radiance.x, radiance.y, radiance.z, seen.opacity].map(|value| value as f32)
        })
        .collect();
    Film::with_opacity(width, height, pixels)
}

/// A step of one volume, from `near` to `far`.
struct Step {
    near: f64,
    far: f64,
    /// Index of the volume.
    volume: usize,
    /// Opacity over the reference length at its midpoint.
    opacity: f64,
    /// Extinction, per world unit.
    extinction: f64,
    /// Colour towards the eye.
    colour: DVec3,
}

impl SeveralVolumes<'_> {
    /// Everything along `ray`, composited.
    fn cast(&self, ray: &Ray) -> Layer {
        let hit = nearest_hit(self.scene, ray);
        let end = hit.as_ref().map_or(f64::INFINITY, |(hit, _)| hit.t);
        let pieces = self.pieces(ray, end).into_iter();
        let seen = pieces.fold(Layer::EMPTY, |seen, (_, piece)| seen.over(piece));
        let Some((hit, surface)) = hit else {
            return seen;
        };
        seen.over(Layer {
            colour: surface_radiance(self, ray, &hit, surface),
            opacity: 1.0,
            transparency: 0.0,
        })
    }

    /// The pieces of `ray` up to `end`, each with its span.
    pub fn pieces(&self, ray: &Ray, end: f64) -> Vec<(Span, Layer)> {
        let of_volume = |volume| self.steps(volume, ray, end);
        let steps: Vec<Step> = (0..self.volumes.len()).flat_map(of_volume).collect();
        let mut ends: Vec<f64> = steps.iter().flat_map(|it| [it.near, it.far]).collect();
        ends.sort_by(f64::total_cmp);
        let pieces = ends.windows(2).filter(|piece| piece[0] < piece[1]);
        let pieces = pieces.map(|piece| {
            let covers = |step: &&Step| step.near <= piece[0] && piece[1] <= step.far;
            let steps: Vec<&Step> = steps.iter().filter(covers).collect();
            let span = Span::new(piece[0], piece[1]);
            (span, self.piece(&steps, span.length()))
        });
        pieces.collect()
    }

    /// The steps of a volume along `ray`, up to `end`.
    fn steps(&self, volume: usize, ray: &Ray, end: f64) -> Vec<Step> {
        let caster = &self.volumes[volume];
        let (alone, lattice) = (caster.scene, caster.scene.grid.lattice());
        let Some(span) = span(self, volume, ray, end) else {
            return vec![];
        };
        let line = NodeLine::new(in_volume(alone, ray), lattice);
        let count = step_count(span, alone.step);
        let begin = |index: usize| (span.near + index as f64 * alone.step).min(span.far);
        let step = |index: usize| {
            let (t, _) = midpoint(span, alone.step, count, index);
            let (point, cell) = (ray.at(t), Cell::around(lattice, line.at(t)));
            let density = alone.interpolation.read(&*alone.grid, &cell);
            let transfer_function = &alone.transfer_function;
            let factor = |modulation: &Modulation| modulation.factor(alone.interpolation, &cell);
            let factor = self.scene.modulation_of(volume).map_or(1.0, factor);
            let opacity = transfer_function.reference_opacity(density) * factor;
            let extinction = -ln_1p(-opacity) / transfer_function.reference_length;
            let mut colour = DVec3::ZERO;
            if extinction > 0.0 {
                let light = transfer_function.emission(density) * visibility(self, point);
                colour = caster.shade(ray, point, &cell, density) * light;
            }
            let is_last = index + 1 == count;
            Step {
                near: begin(index),
                far: if is_last { span.far } else { begin(index + 1) },
                volume,
                opacity,
                extinction,
                colour,
            }
        };
        (0..count).map(step).collect()
    }

    /// A piece of a ray of this `length`, within these steps.
    fn piece(&self, steps: &[&Step], length: f64) -> Layer {
        let is_opaque = |step: &Step| step.extinction == f64::INFINITY;
        let opaque = steps.iter().filter(|step| is_opaque(step)).count();
        let total: f64 = steps.iter().map(|step| step.extinction).sum();
        let (mut colour, mut opacity) = (DVec3::ZERO, 0.0);
        for step in steps.iter().filter(|step| step.extinction > 0.0) {
            let share = match (opaque, is_opaque(step)) {
                (0, _) => step.extinction / total,
                (_, true) => 1.0 / opaque as f64,
                (_, false) => 0.0,
            };
            colour += step.colour * share;
            let transfer_function = &self.volumes[step.volume].scene.transfer_function;
            let lengths = length / transfer_function.reference_length;
            // 1 − (1 − a)(1 − b), with the digits of thin volumes.
            opacity += over_length(step.opacity, lengths) * (1.0 - opacity);
        }
        Layer {
            colour: colour * opacity,
            opacity,
            transparency: 1.0 - opacity,
        }
    }
}

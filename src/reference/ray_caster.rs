//! The ray caster for classified volumes, as plainly as it can be written.
//!
//! The radiance along a ray is the volume-rendering integral over its span inside the volume, in
//! front of the background `B` (Max 1995, §4): at distance `t` the volume has an extinction `σ` and,
//! towards the eye, a colour `c`.
//!
//! ```text
//! L = ∫ c(t) σ(t) T(t) dt + B T(end),     T(t) = exp(−∫₀ᵗ σ(s) ds)
//! ```
//!
//! Over each step of length `h`, colour and extinction are taken as constant, with their values at
//! its midpoint. There the field has a value, interpolated between the nodes; it is the density `d`, or maps to it by
//! the scene's `range`. The transfer function states the opacity `a₀ = 1 − exp(−σ h₀)` of each density over a
//! reference length `h₀`; the opacity `a` over a step follows from it:
//!
//! ```text
//! L = Σᵢ cᵢ aᵢ Tᵢ + B Tₙ,     Tᵢ = Π (1 − aⱼ) over j < i,     a = 1 − (1 − a₀)^(h/h₀)
//! c = shade(colour(d)) · emission(d) · visibility
//! ```
//!
//! `shade` is Phong's model, if the scene asks for it, in the light of a point without fall-off. Its normal
//! points against the density gradient: central differences at the nodes, interpolated like the density;
//! a node of the border takes the gradient of the nearest inner one, and a sample without a gradient keeps
//! its colour. `emission` multiplies the shaded colour, the highlight and the ambient term included. `visibility` is
//! the transmittance from the light to the sample; it dims the ambient term, too. A shadow has a step `h′` and a
//! reference length `h₀′` of its own, and `a′` follows from `a₀` by them: `a′ = 1 − (1 − a₀)^(h′/h₀′)`.
//!
//! Transfer functions come in two forms:
//!
//! ```text
//!                       a₀(d)                                 emission(d)   visibility
//! a table of points     interpolated                          1             Π (1 − a′)
//! a formula             min(1, (1 − exp(−d²)) / (1 − f))      d²            min(1, exp(−S/100))
//! ```
//!
//! The formula is that of a ray-casting assignment: the scene gives `f`, the value of `exp(−d²)` at
//! which the volume becomes fully opaque. The assignment defines `S = Σ d h′/h₀′`, which is not the optical
//! depth of `σ`, and the constant 100. Only negative densities need the `min`: they would make light.
//!
//! A scene may composite front to back, back to front, or end a ray early, where the transmittance falls below a
//! threshold.
//!
//! A volume may be placed in the world by an affine map. The formulas are those of a volume without one; where a
//! map matters the code calls `placement.rs`.
//! `several_volumes.rs` renders several volumes, surfaces and clips in one picture. The parts of the physics are
//! short files: `volume/interpolation.rs` ([`Cell`] is the eight nodes around a point), `volume/node_line.rs` (a line
//! in node coordinates), `volume/gradient.rs`, `optics/transfer_function.rs`, `optics/opacity.rs` and `optics/phong.rs`.
//!
//! Other renderers differ from this in conventions, and a scene may state theirs: those are rendered
//! by the loop of [`conventions::RayCaster`](crate::conventions::RayCaster).
//!
//! Sources: Levoy 1988, "Display of surfaces from volume data"; Max 1995, "Optical models for
//! direct volume rendering"; Porter & Duff 1984, "Compositing digital images".

use super::placement;
use crate::film::Film;
use crate::geometry::{Direction, Ray, Span, length_of};
use crate::math::exp;
use crate::optics::{Appearance, over_length};
use crate::scene::{Classified, Compositing, Shadow};
use crate::volume::{Cell, Grid, NodeLine, NodePoint};
use glam::DVec3;
use rayon::prelude::*;

/// The image of `scene`: radiance, background included, and the opacity of the volume in front of
/// it; one ray through the centre of each pixel.
pub fn render(scene: &Classified, [width, height]: [usize; 2]) -> Film {
    let gradients = placement::gradients(scene);
    let caster = RayCaster { scene, gradients };
    let pixels: Vec<[f32; 4]> = (0..width * height)
        .into_par_iter()
        .map(|index| {
            let pixel = [index % width, index / width];
            let volume = caster.cast(&scene.camera.ray(pixel, [width, height]));
            let radiance = volume.colour + scene.background * volume.transparency;
            [radiance.x, radiance.y, radiance.z, volume.opacity].map(|value| value as f32)
        })
        .collect();
    Film::with_opacity(width, height, pixels)
}

pub(super) struct RayCaster<'s> {
    pub(super) scene: &'s Classified,
    /// Density gradients in the world at the nodes, scaled by one common factor, about a voxel, to fit `f32` whatever
    /// the size of the volume: shading uses their directions alone.
    pub(super) gradients: Grid<[f32; 3]>,
}

/// Samples of a ray, composited. [`crate::optics::Layer`] does the same; it is written again here, so that this file
/// can be read alone.
pub(super) struct Layer {
    /// Associated colour: multiplied by opacity.
    pub(super) colour: DVec3,
    /// Fraction of the light from behind that is absorbed.
    pub(super) opacity: f64,
    /// Fraction of the light from behind that passes.
    pub(super) transparency: f64,
}

impl Layer {
    pub(super) const EMPTY: Layer = Layer {
        colour: DVec3::ZERO,
        opacity: 0.0,
        transparency: 1.0,
    };

    /// This layer in front of `back`: the operator "over" of Porter & Duff 1984.
    pub(super) fn over(self, back: Layer) -> Layer {
        let passed = self.transparency * back.transparency;
        let sum = self.opacity + back.opacity * self.transparency;
        Layer {
            colour: self.colour + back.colour * self.transparency,
            // The sum is more accurate while it is small; near 1, rounding could carry it above 1. At a half
            // both are equally good.
            opacity: if passed < 0.5 { 1.0 - passed } else { sum },
            transparency: passed,
        }
    }
}

impl RayCaster<'_> {
    /// The samples along `ray`, composited.
    fn cast(&self, ray: &Ray) -> Layer {
        let (scene, lattice) = (self.scene, self.scene.grid.lattice());
        let mut seen = Layer::EMPTY;
        // The ray in volume coordinates. Its direction is not normalised, so that `t` stays the distance in the
        // world. A span is what lies ahead: with the eye inside the volume it begins at 0.
        let inside = placement::in_volume(scene, ray);
        let Some(span) = lattice.bounds().span_of(&inside) else {
            return seen;
        };
        // In node coordinates: 1 from one node to the next.
        let line = NodeLine::new(inside, lattice);
        let count = step_count(span, scene.step);
        let reversed = scene.compositing == Compositing::BackToFront;
        for done in 0..count {
            let index = if reversed { count - 1 - done } else { done };
            let (t, length) = midpoint(span, scene.step, count, index);
            let node_point = line.at(t);
            let cell = Cell::around(lattice, node_point);
            let value = scene.interpolation.read(&*scene.grid, &cell);
            let opacity = scene.transfer_function.opacity(value, length);
            if opacity == 0.0 {
                continue; // nothing to add, whatever its colour
            }
            let point = ray.at(t);
            let light =
                scene.transfer_function.emission(value) * self.visibility(point, node_point);
            let sample = Layer {
                colour: self.shade(ray, point, &cell, value) * light * opacity,
                opacity,
                transparency: 1.0 - opacity,
            };
            seen = if reversed {
                sample.over(seen)
            } else {
                seen.over(sample)
            };
            if let Compositing::EarlyTermination(threshold) = scene.compositing
                && seen.transparency < threshold
            {
                break; // the rest counts as background
            }
        }
        seen
    }

    /// Colour of a sample of `value` at `point`, lit by Phong's model where the scene has one.
    pub(super) fn shade(&self, ray: &Ray, point: DVec3, cell: &Cell, value: f64) -> DVec3 {
        let colour = self.scene.transfer_function.colour(value);
        let Some(phong) = &self.scene.phong else {
            return colour;
        };
        let gradient = self.scene.interpolation.read(&self.gradients, cell);
        let to_light = Direction::of(self.scene.light - point);
        phong.shade(colour, gradient, to_light, -ray.direction)
    }

    /// Visibility of the light from `point`. It is 1:
    /// - where the scene has no shadow;
    /// - at the light itself, to which there is no ray;
    /// - where rounding puts the sample outside the volume.
    fn visibility(&self, point: DVec3, node_point: NodePoint) -> f64 {
        let (scene, lattice) = (self.scene, self.scene.grid.lattice());
        let to_light = scene.light - point;
        let (Some(shadow), Some(ray)) = (scene.shadow, Ray::new(point, to_light)) else {
            return 1.0;
        };
        let inside = placement::in_volume(scene, &ray);
        let Some(span) = lattice.bounds().span_of(&inside) else {
            return 1.0;
        };
        // The ray begins at a sample, inside but for rounding, and ends at the light.
        let span = Span::new(0.0, span.far.min(length_of(to_light)));
        // Node coordinates of `point`, computed again, would lose digits far from the world's origin.
        let line = NodeLine::from(node_point, inside.direction, lattice);
        self.transmittance(&line, span, shadow)
    }

    /// Transmittance of the volume over the `span` of a shadow ray.
    pub(super) fn transmittance(&self, line: &NodeLine, span: Span, shadow: Shadow) -> f64 {
        let (scene, count) = (self.scene, step_count(span, shadow.step));
        let samples = (0..count).map(|index| {
            let (t, length) = midpoint(span, shadow.step, count, index);
            let cell = Cell::around(scene.grid.lattice(), line.at(t));
            (scene.interpolation.read(&*scene.grid, &cell), length)
        });
        match &scene.transfer_function.appearance {
            Appearance::Formula { .. } => {
                let sum: f64 = samples
                    .map(|(value, length)| scene.transfer_function.density(value) * length)
                    .sum();
                exp(-(sum / shadow.reference_step) / 100.0).min(1.0)
            }
            Appearance::Points(points) => samples
                .map(|(value, length)| {
                    1.0 - over_length(points.opacity(value), length / shadow.reference_step)
                })
                .product(),
        }
    }
}

/// Number of steps of length `step` over `span`; the last one ends with the span. At least one where
/// the span has a length, even if the quotient underflows.
pub(super) fn step_count(span: Span, step: f64) -> usize {
    let count = (span.length() / step).ceil() as usize;
    if span.length() > 0.0 { count.max(1) } else { 0 }
}

/// Distance of the midpoint of step `index` of `count`, and the length of the step. Computed from the
/// index, because adding up lengths would accumulate rounding errors.
pub(super) fn midpoint(span: Span, step: f64, count: usize, index: usize) -> (f64, f64) {
    if index + 1 < count {
        return (span.near + (index as f64 + 0.5) * step, step);
    }
    let begin = index as f64 * step;
    // `ceil` may have rounded up to one step too many.
    let rest = (span.length() - begin).max(0.0);
    (span.near + (begin + 0.5 * rest), rest)
}

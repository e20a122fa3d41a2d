//! Isosurfaces of a classified volume: surfaces on which the field has one value.
//!
//! A ray passes the surface of the value `c` where it goes from `f < c` to `f ≥ c`, or back. What it passes is
//! composited front to back, in order of the distance `t`, each surface with a colour and an opacity of its own;
//! the faces of the volume, and of what clips (`clips.rs`) keep of it, are no surfaces:
//!
//! ```text
//! L = Σ shade(cᵢ) aᵢ Π (1 − aⱼ) over j < i  +  B Π (1 − aⱼ) over all
//! ```
//!
//! Here the field is sampled as by the ray caster, and between two samples on either side of `c` the surface is
//! where the straight line between them has the value:
//!
//! ```text
//! t = tᵢ + (tᵢ₊₁ − tᵢ) (c − fᵢ) / (fᵢ₊₁ − fᵢ)
//! ```
//!
//! `shade` is Phong's model, if the scene has it. The gradient is that of the ray caster; it is interpolated at
//! `t`, and the normal is turned to the side of the eye, as surfaces have two sides. There is no shadow.
//!
//! Without samples (`compositing = "continuous"`) the surfaces are at the roots of the cubic that a trilinear field
//! is along a ray in a cell: `render::classified::modes`.
//!
//! Sources: Levoy 1988, "Display of surfaces from volume data"; Marmitt et al. 2004, "Fast and accurate ray-voxel
//! intersection techniques for iso-surface ray tracing".

use super::placement;
use super::projection::samples;
use super::ray_caster::Layer;
use crate::film::Film;
use crate::geometry::{Direction, Ray};
use crate::scene::{Classified, Isosurface, Isosurfaces};
use crate::volume::{Cell, Grid, NodeLine};
use glam::DVec3;
use rayon::prelude::*;

/// The image of the `isosurfaces` of `scene`; one ray through the centre of each pixel.
pub fn render(scene: &Classified, isosurfaces: &Isosurfaces, [width, height]: [usize; 2]) -> Film {
    let gradients = placement::gradients(scene);
    let pixel = |index: usize| {
        let ray = scene
            .camera
            .ray([index % width, index / width], [width, height]);
        let seen = cast(scene, &isosurfaces.surfaces, &gradients, &ray);
        let radiance = seen.colour + scene.background * seen.transparency;
        [radiance.x, radiance.y, radiance.z, seen.opacity].map(|value| value as f32)
    };
    let pixels = (0..width * height).into_par_iter().map(pixel);
    Film::with_opacity(width, height, pixels.collect())
}

/// The `surfaces` along `ray`, composited.
fn cast(
    scene: &Classified,
    surfaces: &[Isosurface],
    gradients: &Grid<[f32; 3]>,
    ray: &Ray,
) -> Layer {
    let mut seen = Layer::EMPTY;
    for (t, surface) in passed(scene, surfaces, ray) {
        seen = seen.over(Layer {
            colour: shade(scene, surface.colour, gradients, ray, t) * surface.opacity,
            opacity: surface.opacity,
            transparency: 1.0 - surface.opacity,
        });
    }
    seen
}

/// The `surfaces` that `ray` passes, with their distances, in order.
pub(super) fn passed<'s>(
    scene: &Classified,
    surfaces: &'s [Isosurface],
    ray: &Ray,
) -> Vec<(f64, &'s Isosurface)> {
    let mut passed = Vec::new();
    for pair in samples(scene, ray).windows(2) {
        let [from, to] = [&pair[0], &pair[1]];
        for surface in surfaces {
            if (from.value < surface.value) != (to.value < surface.value) {
                let part = (surface.value - from.value) / (to.value - from.value);
                passed.push((from.t + (to.t - from.t) * part, surface));
            }
        }
    }
    passed.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    passed
}

/// `colour` at the distance `t`, lit by Phong's model where the scene has one.
fn shade(
    scene: &Classified,
    colour: DVec3,
    gradients: &Grid<[f32; 3]>,
    ray: &Ray,
    t: f64,
) -> DVec3 {
    let Some(phong) = &scene.phong else {
        return colour;
    };
    let lattice = scene.grid.lattice();
    let line = NodeLine::new(placement::in_volume(scene, ray), lattice);
    let cell = Cell::around(lattice, line.at(t));
    let mut gradient = scene.interpolation.read(gradients, &cell);
    if gradient.dot(*ray.direction) < 0.0 {
        gradient = -gradient; // the normal points against it, and to the eye
    }
    let to_light = Direction::of(scene.light - ray.at(t));
    phong.shade(colour, gradient, to_light, -ray.direction)
}

//! Projections and isosurfaces of a field that is sampled along each ray, and the mistakes in them.
//!
//! The loops of [`reference::projection`](crate::reference::projection) and
//! [`reference::isosurface`](crate::reference::isosurface), to be read first, with a question at each place where a
//! mistake of the scene is made. Without one both give the same bits.

use super::ray_caster::Layer;
use super::steps::{StepRule, Steps};
use super::work::RayWork;
use crate::geometry::{Direction, Ray};
use crate::math::exp;
use crate::optics::Phong;
use crate::scene::{
    Classified, Isosurface, IsosurfaceFault, Isosurfaces, Mode, Projected, Projection,
    ProjectionFault,
};
use crate::volume::{Cell, Grid, NodeLine, PlacedBox, Reconstruction as _};
use glam::DVec3;

/// Renders the rays of a scene whose mode is a projection or isosurfaces.
pub struct FieldCaster<'s> {
    scene: &'s Classified,
    extent: PlacedBox,
    shading: Option<(Phong, Grid<[f32; 3]>)>,
}

/// A sample of the field.
struct Sample {
    /// Distance from the eye.
    t: f64,
    /// Length of its step.
    length: f64,
    value: f64,
}

impl<'s> FieldCaster<'s> {
    /// That of `scene`.
    pub fn new(scene: &'s Classified) -> FieldCaster<'s> {
        FieldCaster {
            scene,
            extent: scene.extent(),
            shading: scene.phong.map(|phong| (phong, scene.gradients())),
        }
    }

    /// Number of gradients computed for the nodes.
    pub fn gradients_computed(&self) -> u64 {
        let nodes = |(_, gradients): &(Phong, Grid<[f32; 3]>)| gradients.lattice().node_count();
        self.shading.as_ref().map_or(0, nodes) as u64
    }

    /// The pixel that `ray` is seen in, radiance and opacity, by samples, and its work.
    pub fn pixel(&self, ray: &Ray) -> ([f32; 4], RayWork) {
        let mut work = RayWork::default();
        let samples = samples(self.scene, ray);
        work.density_lookups = samples.len() as u64;
        let pixel = match &self.scene.mode {
            Mode::Composited => unreachable!("composited samples have kernels of their own"),
            Mode::Projection(projection) => {
                if matches!(projection.of, Projected::AttenuatedMaximum(_)) {
                    work.attenuations = samples.len() as u64;
                }
                self.of_number(projection, number(projection, &samples), &mut work)
            }
            Mode::Isosurfaces(surfaces) => {
                let mut passed = passed(surfaces, &samples);
                if surfaces.faults.contains(&IsosurfaceFault::FirstAlone) {
                    passed.truncate(1);
                }
                self.of_surfaces(ray, &passed, &surfaces.faults, &mut work)
            }
        };
        (pixel, work)
    }

    /// The pixel of a ray with this number; none where it misses the volume.
    pub fn of_number(
        &self,
        projection: &Projection,
        number: Option<f64>,
        work: &mut RayWork,
    ) -> [f32; 4] {
        work.emission_terms += u64::from(number.is_some());
        let (colour, opacity) = match number {
            Some(number) => (
                projection.colour(number, &self.scene.transfer_function),
                1.0,
            ),
            None => (self.scene.background, 0.0),
        };
        [colour.x, colour.y, colour.z, opacity].map(|value| value as f32)
    }

    /// The pixel of a ray that passes these surfaces, in the order of their distances.
    pub fn of_surfaces(
        &self,
        ray: &Ray,
        passed: &[(f64, Isosurface)],
        faults: &[IsosurfaceFault],
        work: &mut RayWork,
    ) -> [f32; 4] {
        let mut seen = Layer::EMPTY;
        for (t, surface) in passed {
            work.attenuations += 1;
            work.emission_terms += 1;
            seen = seen.over(Layer {
                colour: self.shade(ray, *t, surface.colour, faults, work) * surface.opacity,
                opacity: surface.opacity,
                transparency: 1.0 - surface.opacity,
            });
        }
        let DVec3 { x, y, z } = seen.colour + self.scene.background * seen.transparency;
        [x, y, z, seen.opacity].map(|value| value as f32)
    }

    /// `colour` at the distance `t`, lit where the scene says so.
    fn shade(
        &self,
        ray: &Ray,
        t: f64,
        colour: DVec3,
        faults: &[IsosurfaceFault],
        work: &mut RayWork,
    ) -> DVec3 {
        let Some((phong, gradients)) = &self.shading else {
            return colour;
        };
        work.gradient_lookups += 1;
        let (scene, lattice) = (self.scene, self.scene.grid.lattice());
        let line = NodeLine::new(self.extent.line(ray), lattice);
        let cell = Cell::around(lattice, line.at(t));
        let gradient = scene.interpolation.read(gradients, &cell);
        let leaves_the_eye = gradient.dot(*ray.direction) < 0.0;
        let is_turned = if faults.contains(&IsosurfaceFault::NotTurned) {
            false
        } else {
            leaves_the_eye != faults.contains(&IsosurfaceFault::TurnedAway)
        };
        let gradient = if is_turned { -gradient } else { gradient };
        let to_light = Direction::of(scene.light - ray.at(t));
        phong.shade(colour, gradient, to_light, -ray.direction)
    }
}

/// The surfaces that `ray` passes in `scene`, by samples, with their distances, in order.
pub fn sampled_surfaces(
    scene: &Classified,
    surfaces: &Isosurfaces,
    ray: &Ray,
) -> Vec<(f64, Isosurface)> {
    passed(surfaces, &samples(scene, ray))
}

/// The samples of `ray`, from the eye on; none where it misses the volume.
fn samples(scene: &Classified, ray: &Ray) -> Vec<Sample> {
    let (extent, lattice) = (scene.extent(), scene.grid.lattice());
    let Some(span) = extent.span(ray) else {
        return vec![];
    };
    let line = NodeLine::new(extent.line(ray), lattice);
    let steps = Steps::new(span, scene.step, StepRule::at(0.5));
    let sample = |index: usize| {
        let (t, length) = steps.sample(index);
        let cell = Cell::around(lattice, line.at(t));
        let value = scene.interpolation.read(&*scene.grid, &cell);
        Sample { t, length, value }
    };
    (0..steps.count).map(sample).collect()
}

/// The number of a ray with these samples.
fn number(projection: &Projection, samples: &[Sample]) -> Option<f64> {
    let first = samples.first()?;
    let fault = projection.fault;
    let begin = |begin: f64| match fault {
        Some(ProjectionFault::BeginsAtZero) => 0.0,
        _ => begin,
    };
    let counts =
        |sample: &&Sample| fault != Some(ProjectionFault::WithoutZeros) || sample.value != 0.0;
    let values = samples.iter().map(|sample| sample.value);
    let integral = || {
        samples
            .iter()
            .map(|sample| sample.value * sample.length)
            .sum::<f64>()
    };
    let way = || {
        samples
            .iter()
            .filter(counts)
            .map(|sample| sample.length)
            .sum::<f64>()
    };
    Some(match projection.of {
        Projected::Maximum if fault == Some(ProjectionFault::RefinedAtTheFront) => first.value,
        Projected::Maximum => values.fold(begin(f64::NEG_INFINITY), f64::max),
        Projected::Minimum => values.fold(begin(f64::INFINITY), f64::min),
        // Where nothing counts, there is nothing.
        Projected::Mean if way() == 0.0 => 0.0,
        Projected::Mean => integral() / way(),
        Projected::Sum => integral(),
        Projected::AttenuatedMaximum(attenuation) => {
            let (mut most, mut depth) = (0.0_f64, 0.0);
            for sample in samples {
                let position = projection.unit().position(sample.value);
                most = most.max(position * exp(-attenuation * depth));
                depth += match fault {
                    Some(ProjectionFault::AttenuatedByDistance) => sample.length,
                    _ => position * sample.length,
                };
            }
            most
        }
    })
}

/// The surfaces passed between samples, with their distances, in order.
fn passed(isosurfaces: &Isosurfaces, samples: &[Sample]) -> Vec<(f64, Isosurface)> {
    let are_at_samples = isosurfaces.faults.contains(&IsosurfaceFault::AtSamples);
    let mut passed = Vec::new();
    for pair in samples.windows(2) {
        let [from, to] = [&pair[0], &pair[1]];
        let before = passed.len();
        for surface in &isosurfaces.surfaces {
            if (from.value < surface.value) != (to.value < surface.value) {
                let part = if are_at_samples {
                    1.0
                } else {
                    (surface.value - from.value) / (to.value - from.value)
                };
                passed.push((from.t + (to.t - from.t) * part, *surface));
            }
        }
        passed[before..].sort_by(|(a, _), (b, _)| a.total_cmp(b));
    }
    passed
}

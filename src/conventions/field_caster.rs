//! Projections and isosurfaces of a field that is sampled along each ray, under conventions of other renderers, and the
//! mistakes in them.
//!
//! The loops of [`reference::projection`](crate::reference::projection) and
//! [`reference::isosurface`](crate::reference::isosurface), to be read first, with a question at each place where a
//! mistake of the scene is made or a convention is asked. Places of samples, values and normals are those of the
//! [`RayCaster`]: these are its modes. With default conventions and without mistakes both give the same bits.

use super::layer::rounded;
use super::ray_caster::RayCaster;
use super::shading::ShadedSample;
use super::steps::StepRule;
use super::work::RayWork;
use crate::geometry::Ray;
use crate::math::exp;
use crate::optics::Layer;
use crate::scene::{
    Compositing, Isosurface, IsosurfaceFault, Isosurfaces, Mode, Projected, Projection,
    ProjectionFault,
};
use crate::volume::Cell;
use glam::DVec3;

/// A sample of the field.
struct Sample {
    /// Distance from the eye.
    t: f64,
    /// Length of its step.
    length: f64,
    value: f64,
}

impl RayCaster<'_> {
    /// The pixel that `ray` is seen in, radiance and opacity, by samples.
    pub(super) fn of_field(&self, ray: &Ray, work: &mut RayWork) -> [f32; 4] {
        let samples = self.samples(ray, work);
        match &self.scene.mode {
            Mode::Composited => unreachable!("composited samples have a loop of their own"),
            Mode::Projection(projection) => {
                if matches!(projection.of, Projected::AttenuatedMaximum(_)) {
                    work.attenuations = samples.len() as u64;
                }
                self.of_number(projection, number(projection, &samples), work)
            }
            Mode::Isosurfaces(surfaces) => {
                let mut passed = self.passed(surfaces, &samples);
                if surfaces.faults.contains(&IsosurfaceFault::FirstAlone) {
                    passed.truncate(1);
                }
                self.of_surfaces(ray, &passed, &surfaces.faults, work)
            }
        }
    }

    /// The pixel of a ray with this number; none where it misses the volume.
    pub fn of_number(
        &self,
        projection: &Projection,
        number: Option<f64>,
        work: &mut RayWork,
    ) -> [f32; 4] {
        work.emission_terms += u64::from(number.is_some());
        let Some(number) = number else {
            return Layer::EMPTY.pixel(self.scene.background);
        };
        let colour = match self.greys {
            Some(greys) => DVec3::splat(greys.position(number)),
            None => projection.colour(number, &self.scene.transfer_function),
        };
        let precision = self.scene.conventions.precision;
        let DVec3 { x, y, z } = colour.map(|value| rounded(value, precision));
        [x, y, z, 1.0].map(|value| value as f32)
    }

    /// The pixel of a ray that passes these surfaces, in the order of their distances.
    pub(crate) fn of_surfaces(
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
            let colour = self.shade(ray, *t, surface.colour, faults, work);
            seen = seen.over(Layer::sample(colour * surface.opacity, surface.opacity));
            seen = seen.rounded(self.scene.conventions.precision);
            if let Compositing::EarlyTermination(threshold) = self.scene.compositing
                && seen.transparency < threshold
            {
                break;
            }
        }
        seen.pixel(self.scene.background)
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
        let (caster, conventions) = (self.first(), &self.scene.conventions);
        let Some((phong, gradients)) = &caster.shading else {
            return colour;
        };
        let lattice = self.scene.grid.lattice();
        let lines = caster.lines(ray);
        let node_point = lines.nodes.at(t);
        let looked_up = caster.looked_up(node_point);
        let cell = Cell::around(lattice, looked_up);
        let gradient = caster.gradient(gradients, lines.inside, looked_up, &cell, work);
        let leaves_the_eye = gradient.dot(*ray.direction) < 0.0;
        let is_turned =
            if conventions.one_sided_surfaces || faults.contains(&IsosurfaceFault::NotTurned) {
                false
            } else {
                leaves_the_eye != faults.contains(&IsosurfaceFault::TurnedAway)
            };
        let (to_light, to_eye) = caster.directions(ray.at(t), node_point, ray);
        let sample = ShadedSample {
            colour,
            gradient: if is_turned { -gradient } else { gradient },
            to_light,
            to_eye,
        };
        let shaded = sample.lit_by(phong, conventions);
        let lit = shaded.base + shaded.highlight;
        if conventions.clamped_samples {
            lit.min(DVec3::ONE)
        } else {
            lit
        }
    }

    /// The surfaces that `ray` passes, by samples, with their distances, in order.
    pub fn passed_along(&self, surfaces: &Isosurfaces, ray: &Ray) -> Vec<(f64, Isosurface)> {
        self.passed(surfaces, &self.samples(ray, &mut RayWork::default()))
    }

    fn passed(&self, surfaces: &Isosurfaces, samples: &[Sample]) -> Vec<(f64, Isosurface)> {
        if self.scene.conventions.surfaces_at_samples {
            found_at(samples, surfaces)
        } else {
            passed(surfaces, samples)
        }
    }

    /// The samples of `ray`, from the eye on; none where it misses the volume.
    fn samples(&self, ray: &Ray, work: &mut RayWork) -> Vec<Sample> {
        let rule = StepRule::of(&self.scene.conventions);
        let Some(way) = self.way(ray, f64::INFINITY, rule) else {
            return vec![];
        };
        let (caster, lines, _) = &way.parts[0];
        let sample = |index: usize| {
            let (t, length) = way.steps.sample(index);
            let point = caster.looked_up(lines.nodes.at(t));
            let cell = Cell::around(self.scene.grid.lattice(), point);
            let value = caster.density(&cell, work);
            Sample { t, length, value }
        };
        (0..way.count).map(sample).collect()
    }
}

/// The number of a ray with these samples.
fn number(projection: &Projection, samples: &[Sample]) -> Option<f64> {
    let first = samples.first()?;
    let fault = projection.fault;
    let begin = |begin: f64| match fault {
        Some(ProjectionFault::BeginsAtZero) => 0.0,
        _ => begin,
    };
    let values = samples.iter().map(|sample| sample.value);
    let integral = || samples.iter().map(|it| it.value * it.length).sum::<f64>();
    Some(match projection.of {
        Projected::Maximum if fault == Some(ProjectionFault::RefinedAtTheFront) => first.value,
        Projected::Maximum => values.fold(begin(f64::NEG_INFINITY), f64::max),
        Projected::Minimum => values.fold(begin(f64::INFINITY), f64::min),
        Projected::Mean => {
            let leaves_zeros_out = fault == Some(ProjectionFault::WithoutZeros);
            let counts = |it: &&Sample| !leaves_zeros_out || it.value != 0.0;
            let counted = samples.iter().filter(counts);
            let way: f64 = counted.map(|it| it.length).sum();
            // Where nothing counts, there is nothing.
            if way == 0.0 { 0.0 } else { integral() / way }
        }
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

/// The surfaces that `samples` find, one at most at each, with their distances.
fn found_at(samples: &[Sample], isosurfaces: &Isosurfaces) -> Vec<(f64, Isosurface)> {
    let mut surfaces = isosurfaces.surfaces.clone();
    surfaces.sort_by(|a, b| a.value.total_cmp(&b.value));
    let mut found = Vec::new();
    let Some((first, rest)) = samples.split_first() else {
        return found;
    };
    // Surfaces whose value is not above that of the ray so far, but for those that wait for a sample.
    let mut below = surfaces.partition_point(|surface| surface.value <= first.value);
    for Sample { t, value, .. } in rest {
        if below > 0 && *value < surfaces[below - 1].value {
            below -= 1;
            found.push((*t, surfaces[below]));
        } else if below < surfaces.len() && *value > surfaces[below].value {
            found.push((*t, surfaces[below]));
            below += 1;
        }
    }
    found
}

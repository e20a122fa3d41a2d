//! The reference ray caster for classified volumes: what one ray sees.
//!
//! Source: Levoy 1988, "Display of surfaces from volume data"; Max 1995, "Optical models for
//! direct volume rendering".

use super::compositing::{Layers, Order};
use super::empty_space::Space;
use super::field::{Field, NodePath};
use super::steps::Steps;
use super::volume_shadow::{Sample, Visibility};
use crate::geometry::{Aabb, Ray, direction_of};
use crate::media::{Phong, TransferFunction};
use crate::render::counters::{Event, Work};
use crate::volume::Grid;
use glam::DVec3;

/// Colours samples by their surroundings.
pub trait Shading: Sync {
    /// The colour of the light that a sample of unshaded `colour` sends back along `ray`.
    fn shade<F: Field, W: Work>(
        &self,
        colour: DVec3,
        field: &F,
        place: &F::Place,
        point: DVec3,
        ray: &Ray,
        work: &mut W,
    ) -> DVec3;
}

/// The colour as it is; no gradient is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Unshaded;

impl Shading for Unshaded {
    fn shade<F: Field, W: Work>(
        &self,
        colour: DVec3,
        _: &F,
        _: &F::Place,
        _: DVec3,
        _: &Ray,
        _: &mut W,
    ) -> DVec3 {
        colour
    }
}

/// Phong shading by stored gradients.
#[derive(Clone, Debug)]
pub struct Shaded {
    /// Weights of the reflection model.
    pub phong: Phong,
    /// Gradients at the nodes, in any unit: only their directions matter.
    pub gradients: Grid<[f32; 3]>,
    /// World position of the light.
    pub light: DVec3,
}

impl Shading for Shaded {
    fn shade<F: Field, W: Work>(
        &self,
        colour: DVec3,
        field: &F,
        place: &F::Place,
        point: DVec3,
        ray: &Ray,
        work: &mut W,
    ) -> DVec3 {
        let gradient = field.gradient(&self.gradients, place, work);
        // A light inside the sample itself shines from nowhere: only ambient light is left.
        let to_light = direction_of(self.light - point).unwrap_or(DVec3::ZERO);
        self.phong.shade(colour, gradient, to_light, -ray.direction)
    }
}

/// Everything a ray needs to know. The parts are types, so that a scene's image is rendered by
/// code compiled for exactly the effects it asks for.
#[derive(Clone, Debug)]
pub struct RayCaster<'c, F, O, S, V, E> {
    /// Density between the nodes.
    pub field: F,
    /// Order of compositing.
    pub order: O,
    /// Colour by gradient.
    pub shading: S,
    /// Light by what lies in its way.
    pub visibility: V,
    /// Regions known to be transparent.
    pub space: E,
    /// What a value of the field looks like.
    pub transfer_function: &'c TransferFunction,
    /// Distance between samples, world units.
    pub step: f64,
    /// Extent of the volume.
    pub bounds: Aabb,
}

impl<F: Field, O: Order, S: Shading, V: Visibility, E: Space> RayCaster<'_, F, O, S, V, E> {
    /// The samples of `ray`, put together.
    pub fn layers<W: Work>(&self, ray: &Ray, work: &mut W) -> Layers {
        self.layers_by(self.step, ray, work)
    }

    /// The same with samples `step` apart.
    pub fn layers_by<W: Work>(&self, step: f64, ray: &Ray, work: &mut W) -> Layers {
        let mut layers = Layers::default();
        let Some(span) = self.bounds.span(ray) else {
            return layers;
        };
        let steps = Steps::over(span, step);
        let path = NodePath::new(ray, self.field.lattice());
        let reach = path.reach(step);
        let mut done = 0;
        while done < steps.count() {
            let (t, length) = steps.sample(O::index(done, steps.count()));
            let nodes = path.at(t);
            let transparent = self.space.transparent_samples(nodes, reach, work);
            if transparent > 0 {
                done += transparent;
                continue;
            }
            done += 1;

            let place = self.field.locate(nodes);
            let density = self.field.density(&place, work);
            work.count(Event::Attenuation);
            let opacity = self.transfer_function.opacity(density, length);
            if opacity == 0.0 {
                continue; // adds exactly nothing, whatever its colour
            }
            let sample = Sample {
                world: ray.at(t),
                nodes,
            };
            let radiance = self.source(ray, sample, &place, density, work);
            layers = O::add(layers, radiance * opacity, opacity);
            if self.order.is_over(&layers) {
                break;
            }
        }
        layers
    }

    /// The light that an opaque sample of `density` sends back along `ray`.
    fn source<W: Work>(
        &self,
        ray: &Ray,
        sample: Sample,
        place: &F::Place,
        density: f64,
        work: &mut W,
    ) -> DVec3 {
        work.count(Event::EmissionTerm);
        let colour = self.transfer_function.colour(density);
        let shaded = self
            .shading
            .shade(colour, &self.field, place, sample.world, ray, work);
        let visibility = self.visibility.at(sample, &self.field, &self.space, work);
        shaded * (self.transfer_function.strength(density) * visibility)
    }

    /// What there is at the world point `world` of `ray`: the density, and the light that an
    /// opaque sample would send back; none where it is transparent.
    pub fn at<W: Work>(&self, ray: &Ray, world: DVec3, work: &mut W) -> (f64, DVec3) {
        let nodes = self.field.lattice().to_nodes(world);
        let place = self.field.locate(nodes);
        let density = self.field.density(&place, work);
        if self.transfer_function.reference_opacity(density) == 0.0 {
            return (density, DVec3::ZERO);
        }
        let sample = Sample { world, nodes };
        (density, self.source(ray, sample, &place, density, work))
    }
}

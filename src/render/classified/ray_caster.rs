//! The loop along one ray through a classified volume, for any kernel.
//!
//! ```text
//! C = Σᵢ Lᵢ aᵢ Tᵢ,     Tᵢ = Π (1 − aⱼ) over the samples j before i
//! ```
//!
//! The density of sample `i` is interpolated ([`field`](super::field)) and classified: `aᵢ` is its
//! opacity over its step ([`steps`](super::steps)), `Lᵢ` its colour, shaded
//! ([`shading`](super::shading)), times the visibility of the light
//! ([`volume_shadow`](super::volume_shadow)); [`compositing`](super::compositing) adds up. A part
//! that a scene does not call for is left out of the compiled loop and changes no bit.
//! `src/reference/ray_caster.rs` is the same loop without parts.
//!
//! Source: Levoy 1988, "Display of surfaces from volume data"; Max 1995, "Optical models for
//! direct volume rendering".

use super::compositing::{CompositingOrder, Layers};
use super::empty_space::Skipping;
use super::field::ScalarField;
use super::shading::Shading;
use super::steps::Steps;
use super::volume_shadow::{SamplePoint, Visibility};
use crate::geometry::{Aabb, Ray};
use crate::media::TransferFunction;
use crate::render::counters::{Event, Work};
use crate::volume::NodeLine;
use glam::DVec3;

/// A ray caster. Its parts are types, so that an image is rendered by code compiled for exactly the
/// effects that the scene asks for.
#[derive(Clone, Debug)]
pub struct RayCaster<'c, F, O, S, V, E> {
    /// Density, reconstructed between the nodes.
    pub field: F,
    /// Order of compositing.
    pub order: O,
    /// Shading by the gradient.
    pub shading: S,
    /// Visibility of the light.
    pub visibility: V,
    /// Empty-space skipping.
    pub skipping: E,
    /// Opacity and colour by density.
    pub transfer_function: &'c TransferFunction,
    /// Distance between samples, world units.
    pub step: f64,
    /// Extent of the volume.
    pub bounds: Aabb,
}

impl<F: ScalarField, O: CompositingOrder, S: Shading, V: Visibility, E: Skipping>
    RayCaster<'_, F, O, S, V, E>
{
    /// The samples of `ray`, composited.
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
        let line = NodeLine::new(ray, self.field.lattice());
        let reach = line.reach(step);
        let mut done = 0;
        while done < steps.count() {
            let (t, length) = steps.sample(O::index(done, steps.count()));
            let nodes = line.at(t);
            let skipped = self.skipping.transparent_samples(nodes, reach, work);
            if skipped > 0 {
                done += skipped;
                continue;
            }
            done += 1;

            let location = self.field.locate(nodes);
            let density = self.field.density(&location, work);
            work.count(Event::Attenuation);
            let opacity = self.transfer_function.opacity(density, length);
            if opacity == 0.0 {
                continue; // adds exactly nothing, whatever its colour
            }
            let sample = SamplePoint {
                world: ray.at(t),
                nodes,
            };
            let radiance = self.source(ray, sample, &location, density, work);
            layers = O::add(layers, radiance * opacity, opacity);
            if self.order.is_over(&layers) {
                break;
            }
        }
        layers
    }

    /// Radiance of an opaque sample of `density`, as seen along `ray`.
    fn source<W: Work>(
        &self,
        ray: &Ray,
        sample: SamplePoint,
        location: &F::Location,
        density: f64,
        work: &mut W,
    ) -> DVec3 {
        work.count(Event::EmissionTerm);
        let colour = self.transfer_function.colour(density);
        let shaded = self
            .shading
            .shade(colour, &self.field, location, sample.world, ray, work);
        let visibility = self
            .visibility
            .at(sample, &self.field, &self.skipping, work);
        shaded * (self.transfer_function.emission(density) * visibility)
    }

    /// Density at the world point `world` of `ray`, and the radiance of an opaque sample there; 0
    /// where it is transparent.
    pub fn at<W: Work>(&self, ray: &Ray, world: DVec3, work: &mut W) -> (f64, DVec3) {
        let nodes = self.field.lattice().to_nodes(world);
        let location = self.field.locate(nodes);
        let density = self.field.density(&location, work);
        if self.transfer_function.reference_opacity(density) == 0.0 {
            return (density, DVec3::ZERO);
        }
        let sample = SamplePoint { world, nodes };
        (density, self.source(ray, sample, &location, density, work))
    }
}

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
use crate::media::{TransferFunction, over_length};
use crate::render::counters::{Event, Work};
use crate::volume::{NodeLine, NodePoint};
use arrayvec::ArrayVec;
use glam::DVec3;

/// Samples that are looked up before the first of them is composited. None waits for another, so that
/// a processor works on several at once: one by one, they take a tenth longer.
const BATCH: usize = 8;

/// The field at a point, classified.
struct Sample<L> {
    nodes: NodePoint,
    location: L,
    density: f64,
    /// Over the reference length.
    opacity: f64,
    colour: DVec3,
}

/// A sample that waits to be composited.
struct Step<L> {
    t: f64,
    length: f64,
    /// Over that length.
    opacity: f64,
    sample: Sample<L>,
}

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
        let mut batch = ArrayVec::<Step<F::Location>, BATCH>::new();
        let (mut done, mut in_empty_space) = (0, true);
        while done < steps.count() {
            while done < steps.count() && !batch.is_full() {
                let (t, length) = steps.sample(O::index(done, steps.count()));
                let nodes = line.at(t);
                // Behind a sample that is not transparent, the block is most likely not empty.
                if in_empty_space {
                    let skipped = self.skipping.transparent_samples(nodes, reach, work);
                    if skipped > 0 {
                        done += skipped;
                        continue;
                    }
                }
                done += 1;
                let sample = self.sample(nodes, work);
                in_empty_space = sample.opacity == 0.0;
                if !in_empty_space {
                    let opacity = 0.0;
                    batch.push(Step {
                        t,
                        length,
                        opacity,
                        sample,
                    });
                }
            }
            for step in &mut batch {
                work.count(Event::Attenuation);
                let lengths = step.length / self.transfer_function.reference_length;
                step.opacity = over_length(step.sample.opacity, lengths);
            }
            for step in &batch {
                if step.opacity == 0.0 {
                    continue; // adds exactly nothing, whatever its colour
                }
                let radiance = self.source(ray, ray.at(step.t), &step.sample, work);
                layers = O::add(layers, radiance * step.opacity, step.opacity);
                if self.order.is_over(&layers) {
                    return layers;
                }
            }
            batch.clear();
        }
        layers
    }

    /// The sample at `nodes`.
    #[inline(always)]
    fn sample<W: Work>(&self, nodes: NodePoint, work: &mut W) -> Sample<F::Location> {
        let location = self.field.locate(nodes);
        let density = self.field.density(&location, work);
        let (opacity, colour) = self.transfer_function.look(density);
        Sample {
            nodes,
            location,
            density,
            opacity,
            colour,
        }
    }

    /// Radiance of `sample`, at the world point `world`, if it were opaque, as seen along `ray`.
    #[inline]
    fn source<W: Work>(
        &self,
        ray: &Ray,
        world: DVec3,
        sample: &Sample<F::Location>,
        work: &mut W,
    ) -> DVec3 {
        work.count(Event::EmissionTerm);
        let (field, location) = (&self.field, &sample.location);
        let shaded = self
            .shading
            .shade(sample.colour, field, location, world, ray, work);
        let point = SamplePoint {
            world,
            nodes: sample.nodes,
        };
        let visibility = self.visibility.at(point, field, &self.skipping, work);
        shaded * (self.transfer_function.emission(sample.density) * visibility)
    }

    /// Density at the world point `world` of `ray`, and the radiance of an opaque sample there; 0
    /// where it is transparent.
    pub fn at<W: Work>(&self, ray: &Ray, world: DVec3, work: &mut W) -> (f64, DVec3) {
        let sample = self.sample(self.field.lattice().to_nodes(world), work);
        let radiance = if sample.opacity == 0.0 {
            DVec3::ZERO
        } else {
            self.source(ray, world, &sample, work)
        };
        (sample.density, radiance)
    }
}

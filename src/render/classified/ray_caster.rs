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
use crate::media::{TransferFunction, over_lengths};
use crate::render::counters::{Event, Work};
use crate::volume::{NodeLine, NodePoint};
use arrayvec::ArrayVec;
use glam::DVec3;

/// Samples that are looked up before the first of them is composited. None waits for another, so that
/// a processor works on several at once, and their opacities over their steps are computed together.
const BATCH: usize = 8;

/// A sample of a ray, before it is classified.
struct Sample<L> {
    /// Distance from the origin of the ray.
    t: f64,
    located: Located<L>,
}

/// The density at a location of the field.
struct Located<L> {
    density: f64,
    /// As much of the location as shading needs.
    location: L,
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
        let reference_length = self.transfer_function.reference_length;
        let whole_step = step / reference_length;
        let mut batch = ArrayVec::<Sample<S::Location<F>>, BATCH>::new();
        let (mut opacities, mut lengths) = ([0.0; BATCH], [0.0; BATCH]);
        let mut colours = [DVec3::ZERO; BATCH];
        let (mut done, mut in_empty_space) = (0, true);
        while done < steps.count() {
            while done < steps.count() && !batch.is_full() {
                let (t, length) = steps.sample(O::index(done, steps.count()));
                let nodes = line.at(t);
                // Behind a batch whose last sample is not transparent, the block is most likely not empty. To ask
                // after each sample would make each wait for the one before.
                if in_empty_space {
                    let skipped = self.skipping.transparent_samples(nodes, reach, work);
                    if skipped > 0 {
                        done += skipped;
                        continue;
                    }
                }
                done += 1;
                // The last step of a ray is shorter.
                lengths[batch.len()] = if length == step {
                    whole_step
                } else {
                    length / reference_length
                };
                let located = self.located(nodes, work);
                batch.push(Sample { t, located });
            }
            for (index, sample) in batch.iter().enumerate() {
                let (opacity, colour) = self.transfer_function.look(sample.located.density);
                (opacities[index], colours[index]) = (opacity, colour);
                in_empty_space = opacity == 0.0;
                work.count_times(Event::Attenuation, u64::from(opacity != 0.0));
            }
            // Over the steps; those behind the end of the batch are not used.
            let opacities = over_lengths(opacities, lengths);
            for (index, sample) in batch.drain(..).enumerate() {
                let opacity = opacities[index];
                if opacity == 0.0 {
                    continue; // adds exactly nothing, whatever its colour
                }
                let (world, nodes) = (ray.at(sample.t), line.at(sample.t));
                let point = SamplePoint { world, nodes };
                let radiance = self.source(ray, point, &sample.located, colours[index], work);
                layers = O::add(layers, radiance * opacity, opacity);
                if self.order.is_over(&layers) {
                    return layers;
                }
            }
        }
        layers
    }

    /// The density at `nodes`.
    #[inline(always)]
    fn located<W: Work>(&self, nodes: NodePoint, work: &mut W) -> Located<S::Location<F>> {
        let location = self.field.locate(nodes);
        let density = self.field.density(&location, work);
        let location = S::location::<F>(location);
        Located { density, location }
    }

    /// Radiance of `sample`, at `point`, if it were opaque, as seen along `ray`; `colour` is that of its density.
    #[inline]
    fn source<W: Work>(
        &self,
        ray: &Ray,
        point: SamplePoint,
        sample: &Located<S::Location<F>>,
        colour: DVec3,
        work: &mut W,
    ) -> DVec3 {
        work.count(Event::EmissionTerm);
        let (field, location) = (&self.field, &sample.location);
        let shaded = self
            .shading
            .shade(colour, field, location, point.world, ray, work);
        let visibility = self.visibility.at(point, field, &self.skipping, work);
        shaded * (self.transfer_function.emission(sample.density) * visibility)
    }

    /// Density at the world point `world` of `ray`, and the radiance of an opaque sample there; 0
    /// where it is transparent.
    pub fn at<W: Work>(&self, ray: &Ray, world: DVec3, work: &mut W) -> (f64, DVec3) {
        let nodes = self.field.lattice().to_nodes(world);
        let located = self.located(nodes, work);
        let density = located.density;
        let (opacity, colour) = self.transfer_function.look(density);
        if opacity == 0.0 {
            return (density, DVec3::ZERO);
        }
        let radiance = self.source(ray, SamplePoint { world, nodes }, &located, colour, work);
        (density, radiance)
    }
}

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

use super::batches::{Batch, Batches};
use super::compositing::{CompositingOrder, Layers};
use super::empty_space::Skipping;
use super::field::ScalarField;
use super::shading::Shading;
use super::steps::{SamplePoint, Steps};
use super::volume_shadow::Visibility;
use crate::geometry::Ray;
use crate::optics::{TransferFunction, over_lengths};
use crate::render::counters::{Event, Work};
use crate::volume::{NodeLine, PlacedBox};
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
    pub extent: PlacedBox,
}

impl<F: ScalarField, O: CompositingOrder, S: Shading, V: Visibility, E: Skipping>
    RayCaster<'_, F, O, S, V, E>
{
    /// The samples of `ray`, composited.
    // Always, as all in the loop below: compiled into the loop over pixels it takes a twentieth less time.
    #[inline(always)]
    pub fn layers<W: Work>(&self, ray: &Ray, work: &mut W) -> Layers {
        self.layers_by(self.step, ray, work)
    }

    /// The same with samples `step` apart.
    #[inline(always)]
    pub(crate) fn layers_by<W: Work>(&self, step: f64, ray: &Ray, work: &mut W) -> Layers {
        let mut layers = Layers::default();
        let Some(span) = self.extent.span(ray) else {
            return layers;
        };
        let line = NodeLine::new(self.extent.line(ray), self.field.lattice());
        let reference_length = self.transfer_function.reference_length;
        let mut batches = Batches::new(Steps::over(span, step), line, reference_length);
        let mut batch = Batch::default();
        let mut in_empty_space = true;
        loop {
            // Behind a batch whose last sample is not transparent, the block is most likely not empty. To ask
            // after each sample would make each wait for the one before.
            let skipping = in_empty_space.then_some(&self.skipping);
            batches.next::<O, W>(&mut batch, skipping, work);
            let count = batch.count;
            if count == 0 {
                return layers;
            }
            // Samples behind the end of a batch are computed too, and not used.
            let locations = self.field.locate_several(&batch.points);
            let densities = self.field.densities(&locations, count, work);
            let (opacities, colours) = self.transfer_function.look_at_several(densities);
            let visible = opacities[..count].iter().filter(|opacity| **opacity != 0.0);
            let visible = visible.count() as u64;
            work.count_times(Event::Attenuation, visible);
            in_empty_space = opacities[count - 1] == 0.0;
            if visible == 0 {
                continue; // spares the opacities over the steps
            }
            // Over the steps.
            let opacities = over_lengths(opacities, batch.lengths);
            for index in 0..count {
                let opacity = opacities[index];
                if opacity == 0.0 {
                    continue; // adds exactly nothing, whatever its colour
                }
                let t = batch.distances[index];
                let (world, nodes) = (ray.at(t), line.at(t));
                let point = SamplePoint { world, nodes };
                let (density, colour) = (densities[index], colours[index]);
                let radiance = self.source(ray, point, (&locations, index), density, colour, work);
                layers = O::add(layers, radiance * opacity, opacity);
                if self.order.is_over(&layers) {
                    return layers;
                }
            }
        }
    }

    /// Radiance of a sample of the given `density` at `point`, which is the `location` of this index in the field, if
    /// it were opaque, as seen along `ray`; `colour` is that of its density.
    #[inline(always)]
    fn source<const N: usize, W: Work>(
        &self,
        ray: &Ray,
        point: SamplePoint,
        location: (&F::Locations<N>, usize),
        density: f64,
        colour: DVec3,
        work: &mut W,
    ) -> DVec3 {
        work.count(Event::EmissionTerm);
        let field = &self.field;
        let shaded = self
            .shading
            .shade(colour, field, location, point.world, ray, work);
        let visibility = self.visibility.at(point, field, &self.skipping, work);
        shaded * (self.transfer_function.emission(density) * visibility)
    }

    /// Density at the world point `world` of `ray`, and the radiance of an opaque sample there; 0
    /// where it is transparent.
    pub fn at<W: Work>(&self, ray: &Ray, world: DVec3, work: &mut W) -> (f64, DVec3) {
        let nodes = self.field.lattice().to_nodes(self.extent.to_volume(world));
        let locations = self
            .field
            .locate_several(&nodes.0.to_array().map(|place| [place]));
        let [density] = self.field.densities(&locations, 1, work);
        let (opacity, colour) = self.transfer_function.look(density);
        if opacity == 0.0 {
            return (density, DVec3::ZERO);
        }
        let point = SamplePoint { world, nodes };
        let radiance = self.source(ray, point, (&locations, 0), density, colour, work);
        (density, radiance)
    }
}

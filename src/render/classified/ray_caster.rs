//! The loop along one ray through a classified volume.
//!
//! `src/reference/ray_caster.rs` states the method, and this file gives the same bits. It adds leaps over transparent
//! blocks ([`EmptySpace`]), computes opacities of several samples together, and counts its work.
//!
//! Source: Levoy 1988, "Display of surfaces from volume data"; Max 1995, "Optical models for
//! direct volume rendering".

use super::empty_space::EmptySpace;
use super::steps::Steps;
use crate::geometry::{Direction, Ray, Span, length_of};
use crate::math::exp;
use crate::optics::{Appearance, Layer, Phong, over_length, over_lengths};
use crate::render::counters::{Counters, Event};
use crate::render::pixels::{Pixels, each};
use crate::render::plan::RayCasterFeatures;
use crate::scene::{Classified, Compositing, Shadow};
use crate::volume::{Cell, Grid, NodeLine, NodePoint, PlacedBox};
use glam::DVec3;

/// The pixels of `scene` by a ray caster with `features`.
pub(in crate::render) fn cast(
    scene: &Classified,
    features: RayCasterFeatures,
    pixels: &Pixels<'_>,
) -> (Vec<[f32; 4]>, Counters) {
    let caster = RayCaster::new(scene, features);
    let size = [pixels.width, pixels.height];
    let (image, mut work) = each(pixels, |pixel, work| {
        caster
            .layers(&scene.camera.ray(pixel, size), work)
            .pixel(scene.background)
    });
    if caster.shading.is_some() {
        let nodes = scene.grid.lattice().node_count() as u64;
        work.count_times(Event::GradientComputed, nodes);
    }
    (image, work)
}

/// A ray caster for one volume.
pub struct RayCaster<'s> {
    scene: &'s Classified,
    /// The reflection model, and gradients of the world at the nodes, in any unit: only directions matter.
    shading: Option<(Phong, Grid<[f32; 3]>)>,
    shadow: Option<Shadow>,
    /// The one value of a grid that has no other.
    constant: Option<f64>,
    empty_space: Option<EmptySpace>,
    extent: PlacedBox,
}

/// Samples whose opacities are computed together: eight take a third of the time that they take one by one.
const BATCH: usize = 8;

/// A sample of a ray that is not transparent.
#[derive(Clone, Copy, Default)]
struct Sample {
    /// Distance from the origin of the ray, world units.
    t: f64,
    /// Length of its step, relative to the reference length of the opacity.
    relative_length: f64,
    value: f64,
    /// Over the reference length.
    opacity: f64,
    colour: DVec3,
}

/// Places along a ray, or along one to the light.
struct Walk {
    line: NodeLine,
    steps: Steps,
    /// Largest change of a node coordinate from one sample to the next.
    reach: f64,
    /// From the end to the beginning.
    is_reversed: bool,
    /// Number of steps taken.
    done: usize,
    /// True where the sample before was transparent.
    in_empty_space: bool,
}

impl Walk {
    fn new(line: NodeLine, span: Span, step: f64, is_reversed: bool) -> Walk {
        Walk {
            line,
            steps: Steps::over(span, step),
            reach: line.reach(step),
            is_reversed,
            done: 0,
            in_empty_space: true,
        }
    }
}

impl<'s> RayCaster<'s> {
    /// One that leaves out nothing of `scene`, and leaps over nothing.
    pub fn plain(scene: &'s Classified) -> RayCaster<'s> {
        RayCaster::new(scene, RayCasterFeatures::asked_for(scene))
    }

    fn new(scene: &'s Classified, features: RayCasterFeatures) -> RayCaster<'s> {
        let phong = scene.phong.filter(|_| features.shading);
        let leaps = features.skip_empty;
        RayCaster {
            scene,
            shading: phong.map(|phong| (phong, scene.gradients())),
            shadow: scene.shadow.filter(|_| features.shadow),
            constant: features.constant.then(|| scene.grid.values()[0].into()),
            empty_space: leaps.then(|| EmptySpace::of(&*scene.grid, &scene.transfer_function)),
            extent: scene.extent(),
        }
    }

    /// The samples along `ray`, composited.
    pub fn layers(&self, ray: &Ray, work: &mut Counters) -> Layer {
        let mut layers = Layer::EMPTY;
        let Some(span) = self.extent.span(ray) else {
            return layers;
        };
        let line = NodeLine::new(self.extent.line(ray), self.scene.grid.lattice());
        let is_reversed = self.scene.compositing == Compositing::BackToFront;
        let mut walk = Walk::new(line, span, self.scene.step, is_reversed);
        let mut batch = [Sample::default(); BATCH];
        loop {
            let count = self.fill(&mut batch, &mut walk, work);
            // Entries from `count` on are old, and what they give is ignored.
            let opacities = over_lengths(
                batch.map(|it| it.opacity),
                batch.map(|it| it.relative_length),
            );
            for (sample, opacity) in batch[..count].iter().zip(opacities) {
                let radiance = self.radiance(ray, &walk.line, sample, work);
                let sample = Layer::sample(radiance * opacity, opacity);
                layers = if is_reversed {
                    sample.over(layers)
                } else {
                    layers.over(sample)
                };
                if let Compositing::EarlyTermination(threshold) = self.scene.compositing
                    && layers.transparency < threshold
                {
                    return layers;
                }
            }
            if count < BATCH {
                return layers;
            }
        }
    }

    /// Puts the next samples that are not transparent into `batch`, and returns how many there are: fewer than it has
    /// room for at the end of the ray.
    #[inline(always)]
    fn fill(&self, batch: &mut [Sample; BATCH], walk: &mut Walk, work: &mut Counters) -> usize {
        let transfer_function = &self.scene.transfer_function;
        let mut count = 0;
        while count < BATCH
            && let Some((t, length, value)) = self.next(walk, work)
        {
            let (opacity, colour) = transfer_function.look(value);
            walk.in_empty_space = opacity == 0.0;
            if opacity != 0.0 {
                batch[count] = Sample {
                    t,
                    relative_length: length / transfer_function.reference_length,
                    value,
                    opacity,
                    colour,
                };
                count += 1;
            }
        }
        work.count_times(Event::Attenuation, count as u64);
        count
    }

    /// The next sample of a walk that is not known to be transparent: its distance, the length of its step, its value.
    // Inlined, like its callees: with a call for each sample an unshaded scan took a quarter more time.
    #[inline(always)]
    fn next(&self, walk: &mut Walk, work: &mut Counters) -> Option<(f64, f64, f64)> {
        let all = walk.steps.count();
        while walk.done < all {
            let index = if walk.is_reversed {
                all - 1 - walk.done
            } else {
                walk.done
            };
            let (t, length) = walk.steps.sample(index);
            let point = walk.line.at(t);
            // Behind a sample that is not transparent, the block is most likely not empty.
            if walk.in_empty_space
                && let Some(leap) = self.leap(point, walk.reach, work)
            {
                walk.done += leap;
                continue;
            }
            walk.done += 1;
            return Some((t, length, self.value(point, work)));
        }
        None
    }

    /// Radiance of a sample, if it were opaque, as seen along `ray`.
    fn radiance(&self, ray: &Ray, line: &NodeLine, sample: &Sample, work: &mut Counters) -> DVec3 {
        work.count(Event::EmissionTerm);
        let (point, node_point) = (ray.at(sample.t), line.at(sample.t));
        let visibility = self.visibility(point, node_point, work);
        let light = self.scene.transfer_function.emission(sample.value) * visibility;
        let Some((phong, gradients)) = &self.shading else {
            return sample.colour * light;
        };
        work.count(Event::GradientLookup);
        let cell = Cell::around(gradients.lattice(), node_point);
        let gradient = self.scene.interpolation.read(gradients, &cell);
        let to_light = Direction::of(self.scene.light - point);
        phong.shade(sample.colour, gradient, to_light, -ray.direction) * light
    }

    /// Number of samples from `point` on that are certainly transparent, if there are any.
    #[inline(always)]
    fn leap(&self, point: NodePoint, reach: f64, work: &mut Counters) -> Option<usize> {
        let empty_space = self.empty_space.as_ref()?;
        work.count(Event::CellWalked);
        let samples = empty_space.transparent_samples(point, reach);
        (samples > 0).then_some(samples)
    }

    #[inline(always)]
    fn value(&self, point: NodePoint, work: &mut Counters) -> f64 {
        if let Some(value) = self.constant {
            return value;
        }
        work.count(Event::DensityLookup);
        let grid = &*self.scene.grid;
        let cell = Cell::around(grid.lattice(), point);
        self.scene.interpolation.read(grid, &cell)
    }

    /// Visibility of the light from `point`, in [0, 1].
    pub fn visibility(&self, point: DVec3, node_point: NodePoint, work: &mut Counters) -> f64 {
        let to_light = self.scene.light - point;
        // `Ray::new` normalises the direction, which takes time: only where there is a shadow.
        let with_ray = |shadow| Some((shadow, Ray::new(point, to_light)?));
        let Some((shadow, ray)) = self.shadow.and_then(with_ray) else {
            return 1.0;
        };
        let Some(span) = self.extent.span(&ray) else {
            return 1.0;
        };
        work.count(Event::ShadowRay);
        let direction = self.extent.vector_to_volume(*ray.direction);
        let line = NodeLine::from(node_point, direction, self.scene.grid.lattice());
        let span = Span::new(0.0, span.far.min(length_of(to_light)));
        self.transmittance(Walk::new(line, span, shadow.step, false), shadow, work)
    }

    /// Transmittance of the volume along a shadow ray.
    fn transmittance(&self, mut walk: Walk, shadow: Shadow, work: &mut Counters) -> f64 {
        let (mut sum, mut transmittance) = (0.0, 1.0);
        while let Some((_, length, value)) = self.next(&mut walk, work) {
            match &self.scene.transfer_function.appearance {
                Appearance::Formula { .. } => {
                    let density = self.scene.transfer_function.density(value);
                    sum += density * length;
                    walk.in_empty_space = density == 0.0;
                }
                Appearance::Points(points) => {
                    let opacity = points.opacity(value);
                    transmittance *= 1.0 - over_length(opacity, length / shadow.reference_step);
                    if transmittance == 0.0 {
                        return 0.0; // nothing behind it matters
                    }
                    walk.in_empty_space = opacity == 0.0;
                }
            }
        }
        exp(-(sum / shadow.reference_step) / 100.0).min(1.0) * transmittance
    }
}

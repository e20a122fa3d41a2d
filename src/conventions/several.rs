//! Several volumes sampled by common steps, as renderers have them that march once through all.
//!
//! The steps are as long as the shortest of all volumes, and are counted from where a ray enters the box along the axes
//! of the world around all of them, with faces on the outermost nodes unless the convention `box` says otherwise. At
//! each place every volume that it lies in has a sample, as its own [`RayCaster`] has it, and these samples lie one over
//! the next, in the order of the scene: of volumes that overlap, the first hides the others, by as much as one step.
//!
//! [`reference::several_volumes`](crate::reference::several_volumes) states what volref has in its place.

use super::layer::pixel_of;
use super::ray_caster::{RayCaster, behind, extent, kept, near_depth};
use super::steps::{StepRule, StepsInParts, taken};
use super::stored_values::as_stored;
use super::work::RayWork;
use crate::geometry::{Aabb, Ray};
use crate::optics::Layer;
use crate::scene::{Classified, Clip};

/// Renders rays through several volumes by common steps.
pub(crate) struct CommonSteps<'s> {
    scene: &'s Classified,
    /// Casters of the volumes, with the clips of each that are not of all.
    volumes: Vec<(RayCaster<'s>, Vec<&'s Clip>)>,
    /// Clips of all volumes: they cut the ray.
    clips: Vec<&'s Clip>,
    /// The box around all volumes, along the axes of the world.
    bounds: Aabb,
    /// Depth along the view nearer than which nothing is seen of any volume.
    near_depth: f64,
    /// Length of a step.
    step: f64,
}

/// The scenes of the volumes of `scene`, each alone, as their casters take them.
pub(crate) fn each_alone(scene: &Classified) -> Vec<Classified> {
    let (_, step) = scene.common_box_and_step();
    let volumes = scene.each_alone().map(|mut alone| {
        alone.step = step;
        alone.conventions.voxel_box |= alone.conventions.voxel_boxes;
        as_stored(&alone).into_owned()
    });
    volumes.collect()
}

impl<'s> CommonSteps<'s> {
    /// The march through `scene`; `volumes` are its volumes, [`each_alone`].
    pub fn new(scene: &'s Classified, volumes: &'s [Classified]) -> CommonSteps<'s> {
        let boxes = scene
            .each_alone()
            .map(|alone| extent(&alone).world_bounds());
        let near_depths = scene.each_alone().map(|alone| near_depth(&alone));
        let clips = scene.objects.clips.iter();
        // Clips of all volumes cut the ray, however they are written.
        let cuts_all = |clip: &&Clip| (0..volumes.len()).all(|volume| clip.cuts(volume));
        let (of_all, of_some): (Vec<_>, Vec<_>) = clips.partition(cuts_all);
        let of_volume = |volume| of_some.iter().copied().filter(move |it| it.cuts(volume));
        CommonSteps {
            scene,
            volumes: (volumes.iter().enumerate())
                .map(|(volume, alone)| (RayCaster::new(alone), of_volume(volume).collect()))
                .collect(),
            clips: of_all,
            bounds: boxes.reduce(Aabb::union).expect("a first volume"),
            near_depth: near_depths.fold(0.0, f64::max),
            step: volumes[0].step,
        }
    }

    /// Radiance of a pixel of an image of `size`, background included, and the opacity of the volumes; and the work
    /// of its ray.
    pub fn pixel(&self, pixel: [usize; 2], size: [usize; 2]) -> ([f32; 4], RayWork) {
        pixel_of(self.scene, pixel, size, |ray, end, rule, work| {
            self.cast(ray, end, rule, work)
        })
    }

    /// Number of gradients computed for the nodes.
    pub fn gradients_computed(&self) -> u64 {
        let casters = self.volumes.iter().map(|(caster, _)| caster);
        casters.map(RayCaster::gradients_computed).sum()
    }

    /// The samples along `ray` as far as `end`, composited.
    fn cast(&self, ray: &Ray, end: f64, rule: StepRule, work: &mut RayWork) -> Layer {
        let mut seen = Layer::EMPTY;
        let whole = self.bounds.span(ray);
        let Some(whole) = whole.and_then(|it| behind(self.near_depth, it, ray, self.scene)) else {
            return seen;
        };
        let Some(span) = kept(whole, end, ray, self.clips.iter().copied()) else {
            return seen;
        };
        let parts = self.volumes.iter().filter_map(|(caster, clips)| {
            let clips = clips.iter().copied();
            let inside = kept(caster.span(ray)?, f64::INFINITY, ray, clips)?;
            Some((caster, caster.lines(ray), inside))
        });
        let parts: Vec<_> = parts.collect();
        let conventions = &self.scene.conventions;
        let (steps, count) = taken(conventions, span, whole.far, |span| {
            StepsInParts::new(span, self.step, rule, &[])
        });
        for index in 0..count {
            let (t, length) = steps.sample(index);
            for (caster, lines, inside) in &parts {
                if inside.near <= t
                    && t <= inside.far
                    && let Some(sample) = caster.sample(ray, lines, t, length, work)
                {
                    seen = seen.with(sample, self.scene);
                }
            }
            if seen.ends(self.scene) {
                break;
            }
        }
        seen
    }
}

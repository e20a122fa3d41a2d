//! The ray caster for classified volumes under conventions of other renderers.
//!
//! The loop of [`reference::ray_caster`](crate::reference::ray_caster), to be read first, with a
//! question at each place where ray casters differ: where a step is sampled (`steps`), how a value
//! is classified (`classifier`), how its opacity is corrected for a step (`opacity`), which gradient is
//! taken (`normals`), how a sample is shaded (`shading`), and the rest here and in `volume_caster`. With the default
//! [conventions](crate::scene::Conventions) both give the same bits.
//!
//! Several volumes are sampled by common steps, as renderers have them that march once through all. The steps are as
//! long as the shortest of all volumes, and are counted from where a ray enters the box along the axes
//! of the world around all of them, with faces on the outermost nodes unless the convention `box` says otherwise. At
//! each place every volume that it lies in has a sample, and these samples lie one over
//! the next, in the order of the scene: of volumes that overlap, the first hides the others, by as much as one step.
//! [`reference::several_volumes`](crate::reference::several_volumes) states what volref has in its place.
//!
//! Work is counted as the kernels of [`render`](crate::render) count it; nothing is left out but
//! what a scene does not ask for.

use super::normals::NodeGradients;
use super::steps::{StepRule, StepsInParts, taken};
use super::stored_values::as_stored;
use super::volume_caster::{Lines, VolumeCaster, behind, extent, near_depth};
use super::work::RayWork;
use crate::geometry::{Aabb, Ray, Span};
use crate::math::rng::philox4x32_10;
use crate::optics::Layer;
use crate::scene::{Classified, Clip, Compositing, Mode, Projected, Window};
use glam::DVec3;
use std::borrow::Cow;

/// A ray caster for a scene.
pub struct RayCaster<'s> {
    pub(super) scene: &'s Classified,
    /// Casters of the volumes, with the clips of each that are not of all.
    volumes: Vec<(VolumeCaster<'s>, Vec<&'s Clip>)>,
    /// Clips of all volumes: they cut the ray.
    clips: Vec<&'s Clip>,
    /// Steps of several volumes.
    common: Option<CommonSteps>,
    /// Greys of a mean, where they are those of the range of the grid.
    pub(super) greys: Option<Window>,
}

/// Steps that several volumes have in common.
struct CommonSteps {
    /// The box around all volumes, along the axes of the world.
    bounds: Aabb,
    /// Depth along the view nearer than which nothing is seen of any volume.
    near_depth: f64,
    /// Length of a step.
    step: f64,
}

/// The way of a ray through the volumes.
pub(super) struct Way<'c, 's> {
    /// The volumes that it meets, and where.
    pub parts: Vec<(&'c VolumeCaster<'s>, Lines, Span)>,
    pub steps: StepsInParts,
    /// Number of steps that are taken.
    pub count: usize,
}

impl<'s> RayCaster<'s> {
    /// The ray caster of `scene`.
    pub fn new(scene: &'s Classified) -> RayCaster<'s> {
        RayCaster::with_gradients(scene, Some(&NodeGradients::default()))
    }

    /// The same, with gradients at nodes that are `known` from other sets of conventions for the volume, if it is
    /// the only one; none if nothing is to be shaded.
    pub(crate) fn with_gradients(
        scene: &'s Classified,
        known: Option<&NodeGradients>,
    ) -> RayCaster<'s> {
        let count = scene.volume_count();
        // Clips of all volumes cut the ray, however they are written.
        let cuts_all = |clip: &&Clip| (0..count).all(|volume| clip.cuts(volume));
        let (clips, of_some): (Vec<_>, Vec<_>) = scene.objects.clips.iter().partition(cuts_all);
        let clips_of = |volume| of_some.iter().copied().filter(move |it| it.cuts(volume));
        let each_alone: Vec<Classified> = match count {
            1 => Vec::new(),
            _ => scene.each_alone().collect(),
        };
        let common = (count > 1).then(|| {
            let boxes = each_alone.iter().map(|it| extent(it).world_bounds());
            let near_depths = each_alone.iter().map(near_depth);
            CommonSteps {
                bounds: boxes.reduce(Aabb::union).expect("a first volume"),
                near_depth: near_depths.fold(0.0, f64::max),
                step: scene.common_box_and_step().1,
            }
        });
        let volumes = match &common {
            None => vec![(VolumeCaster::new(as_stored(scene), known), Vec::new())],
            Some(common) => (each_alone.into_iter().enumerate())
                .map(|(volume, mut alone)| {
                    alone.step = common.step;
                    alone.conventions.voxel_box |= alone.conventions.voxel_boxes;
                    let alone = Cow::Owned(as_stored(&alone).into_owned());
                    let caster = VolumeCaster::new(alone, Some(&NodeGradients::default()));
                    (caster, clips_of(volume).collect())
                })
                .collect(),
        };
        RayCaster {
            scene,
            volumes,
            clips,
            common,
            greys: greys(scene),
        }
    }

    /// The caster of the first volume, which modes have alone.
    pub(super) fn first(&self) -> &VolumeCaster<'s> {
        &self.volumes[0].0
    }

    /// Number of gradients computed for the nodes.
    pub fn gradients_computed(&self) -> u64 {
        let casters = self.volumes.iter().map(|(caster, _)| caster);
        casters.map(VolumeCaster::gradients_computed).sum()
    }

    /// Radiance of pixel (`column`, `row`) of an image of `size`, columns and rows, background
    /// included, and the opacity of the volumes; and the work of its ray.
    pub fn pixel(&self, [column, row]: [usize; 2], size: [usize; 2]) -> ([f32; 4], RayWork) {
        let scene = self.scene;
        let mut work = RayWork::default();
        if scene.mode != Mode::Composited {
            return (
                self.of_field(&scene.camera.ray([column, row], size), &mut work),
                work,
            );
        }
        let ray = if scene.conventions.pixel_corner {
            scene.camera.ray_through([column as f64, row as f64], size)
        } else {
            scene.camera.ray([column, row], size)
        };
        let mut rule = StepRule::of(&scene.conventions);
        if scene.conventions.is_random() {
            let pixel = (row * size[0] + column) as u32;
            work.random_draws += 1;
            let random = philox4x32_10([pixel, 0, 0, 0], [0; 2])[0];
            let random = f64::from(random) / (1_u64 << 32) as f64;
            if scene.conventions.has_random_place() {
                rule.position = random;
            } else {
                rule.first = random;
            }
        }
        let hit = scene.objects.nearest_surface(&ray);
        let end = hit.as_ref().map_or(f64::INFINITY, |(hit, _)| hit.t);
        let volume = self.cast(&ray, end, rule, &mut work);
        let (behind, opacity) = match hit {
            None => (scene.background, volume.opacity),
            Some((hit, surface)) => (surface.shaded(&ray, &hit, scene.light), 1.0),
        };
        let DVec3 { x, y, z } = volume.colour + behind * volume.transparency;
        ([x, y, z, opacity].map(|value| value as f32), work)
    }

    /// The way of `ray` through what clips keep of the volumes, as far as `end`.
    pub(super) fn way(&self, ray: &Ray, end: f64, rule: StepRule) -> Option<Way<'_, 's>> {
        let only = self.first();
        let whole = match &self.common {
            None => only.span(ray)?,
            Some(common) => behind(common.near_depth, common.bounds.span(ray)?, ray, self.scene)?,
        };
        let span = kept(whole, end, ray, self.clips.iter().copied())?;
        let everywhere = Span::new(f64::NEG_INFINITY, f64::INFINITY);
        let parts = self.volumes.iter().filter_map(|(caster, clips)| {
            let inside = match self.common {
                None => everywhere,
                Some(_) => {
                    let clips = clips.iter().copied();
                    kept(caster.span(ray)?, f64::INFINITY, ray, clips)?
                }
            };
            Some((caster, caster.lines(ray), inside))
        });
        let parts: Vec<_> = parts.collect();
        let steps_over = |span: Span| match &self.common {
            None => only.steps(&parts[0].1, span, rule),
            Some(common) => StepsInParts::new(span, common.step, rule, &[]),
        };
        let (steps, count) = taken(&self.scene.conventions, span, whole.far, steps_over);
        Some(Way {
            parts,
            steps,
            count,
        })
    }

    /// The samples along `ray` as far as `end`, composited.
    fn cast(&self, ray: &Ray, end: f64, rule: StepRule, work: &mut RayWork) -> Layer {
        let scene = self.scene;
        let mut seen = Layer::EMPTY;
        let Some(way) = self.way(ray, end, rule) else {
            return seen;
        };
        let is_alone = self.common.is_none();
        let reversed = is_alone && scene.compositing == Compositing::BackToFront;
        for done in 0..way.count {
            let index = if reversed { way.count - 1 - done } else { done };
            let (t, length) = way.steps.sample(index);
            let length = if is_alone && scene.conventions.nominal_opacity {
                length / way.steps.step * scene.step
            } else {
                length
            };
            for (caster, lines, inside) in &way.parts {
                if inside.near <= t
                    && t <= inside.far
                    && let Some(sample) = caster.sample(ray, lines, t, length, work)
                {
                    seen = seen.with(sample, scene);
                }
            }
            if seen.ends(scene) {
                break;
            }
        }
        seen
    }
}

/// Greys of a mean, where they are those of the range of the grid.
fn greys(scene: &Classified) -> Option<Window> {
    let is_mean = matches!(&scene.mode, Mode::Projection(it) if it.of == Projected::Mean);
    let greys = (is_mean && scene.conventions.mean_of_range).then(|| scene.grid.range());
    let greys = greys.filter(|(low, high)| low < high);
    greys.map(|(low, high)| Window { low, high })
}

/// The part of `whole`, a span of `ray`, that `clips` keep, as far as `end`.
pub(crate) fn kept<'c>(
    whole: Span,
    end: f64,
    ray: &Ray,
    clips: impl Iterator<Item = &'c Clip>,
) -> Option<Span> {
    let mut span = Span::new(whole.near, whole.far.min(end));
    for clip in clips {
        span = span.within(clip.kept.span(ray)?);
    }
    (span.near <= span.far).then_some(span)
}

//! Surfaces among volumes, clips of volumes, and shadows of all on all.
//!
//! A clip keeps the side of a plane to which its normal `n` points, or the inside of a box. Along a ray
//! `e + t d` a plane through `p` is crossed at
//!
//! ```text
//! t = n·(p − e) / n·d
//! ```
//!
//! which is where the kept part begins if `n·d > 0`, and where it ends if `n·d < 0`. What all clips of a
//! volume keep of its box is convex, so that a ray has one span in it. A ray in the plane itself belongs
//! to the side of larger coordinates, as with faces of boxes.
//!
//! Surfaces are opaque, and lit as samples are: by Phong's model on the side that is seen, times the
//! visibility of the light.

use super::placement::{gradients, in_volume};
use super::ray_caster::RayCaster;
use crate::geometry::{Direction, Hit, Ray, Side, Span, Surface as _, length_of};
use crate::scene::{Classified, Kept, OpaqueSurface};
use crate::volume::NodeLine;
use glam::DVec3;

/// The volumes of a scene, each with the caster of a scene of it alone.
pub(super) struct SeveralVolumes<'s> {
    pub(super) scene: &'s Classified,
    pub(super) volumes: Vec<RayCaster<'s>>,
}

impl<'s> SeveralVolumes<'s> {
    /// The volumes of `scene`, the scenes of each alone being these.
    pub fn of(scene: &'s Classified, alone: &'s [Classified]) -> SeveralVolumes<'s> {
        let caster = |scene| RayCaster {
            scene,
            gradients: gradients(scene),
        };
        let volumes = alone.iter().map(caster).collect();
        SeveralVolumes { scene, volumes }
    }
}

/// The part of `ray` before `end` that lies in a volume and in what its clips keep, if any.
pub(super) fn span(volumes: &SeveralVolumes, volume: usize, ray: &Ray, end: f64) -> Option<Span> {
    let alone = volumes.volumes[volume].scene;
    let bounds = alone.grid.lattice().bounds();
    let mut span = bounds.span_of(&in_volume(alone, ray))?;
    span.far = span.far.min(end);
    kept(volumes.scene, volume, ray, span)
}

/// The part of `span` of `ray` in what the clips of a volume of `scene` keep, if any.
pub(super) fn kept(scene: &Classified, volume: usize, ray: &Ray, mut span: Span) -> Option<Span> {
    for clip in scene.clips_of(volume) {
        let kept = match clip.kept {
            Kept::Inside(bounds) => bounds.span(ray)?,
            Kept::Side { point, normal } => on_side(ray, point, normal)?,
        };
        span.near = span.near.max(kept.near);
        span.far = span.far.min(kept.far);
    }
    (span.near < span.far).then_some(span)
}

/// The part of a ray on the side of a plane to which its normal points, if any.
fn on_side(ray: &Ray, point: DVec3, normal: Direction) -> Option<Span> {
    let (distance, slope) = (normal.dot(point - ray.origin), normal.dot(*ray.direction));
    let t = distance / slope;
    if slope > 0.0 {
        Some(Span::new(t, f64::INFINITY))
    } else if slope < 0.0 {
        Some(Span::new(f64::NEG_INFINITY, t))
    } else {
        let is_of_larger = || normal.to_array().into_iter().find(|&n| n != 0.0) > Some(0.0);
        let is_kept = distance < 0.0 || distance == 0.0 && is_of_larger();
        is_kept.then_some(Span::new(f64::NEG_INFINITY, f64::INFINITY))
    }
}

/// The nearest hit of a surface, and the surface; of two at the same distance the first.
pub(super) fn nearest_hit<'s>(
    scene: &'s Classified,
    ray: &Ray,
) -> Option<(Hit, &'s OpaqueSurface)> {
    let surfaces = scene.objects.surfaces.iter();
    let hits =
        surfaces.filter_map(|surface| Some((surface.shape.hit(ray, f64::INFINITY)?, surface)));
    hits.min_by(|(a, _), (b, _)| a.t.total_cmp(&b.t))
}

/// Visibility of the light from a point of a volume.
pub(super) fn visibility(volumes: &SeveralVolumes, point: DVec3) -> f64 {
    let to_light = volumes.scene.light - point;
    let ray = Ray::new(point, to_light);
    ray.map_or(1.0, |ray| {
        visibility_along(volumes, &ray, length_of(to_light))
    })
}

/// Visibility of the light at the `distance` along `ray`; 1 where the scene has no shadow.
fn visibility_along(volumes: &SeveralVolumes, ray: &Ray, distance: f64) -> f64 {
    if volumes.scene.shadow.is_none() {
        return 1.0;
    }
    let mut surfaces = volumes.scene.objects.surfaces.iter();
    if surfaces.any(|surface| surface.shape.blocks(ray, distance)) {
        return 0.0;
    }
    let through = |(volume, caster): (usize, &RayCaster)| {
        let (Some(shadow), Some(span)) =
            (caster.scene.shadow, span(volumes, volume, ray, distance))
        else {
            return 1.0;
        };
        let line = NodeLine::new(in_volume(caster.scene, ray), caster.scene.grid.lattice());
        caster.transmittance(&line, span, shadow)
    };
    volumes.volumes.iter().enumerate().map(through).product()
}

/// Radiance of a surface at a hit.
pub(super) fn surface_radiance(
    volumes: &SeveralVolumes,
    ray: &Ray,
    hit: &Hit,
    surface: &OpaqueSurface,
) -> DVec3 {
    let light = volumes.scene.light;
    let to_light = Direction::of(light - hit.point.position);
    let colour = surface.phong.map_or(surface.colour, |phong| {
        let outwards = match hit.side {
            Side::Front => *hit.point.normal,
            Side::Back => -*hit.point.normal,
        };
        phong.shade(surface.colour, -outwards, to_light, -ray.direction)
    });
    let way = hit.point.towards_point(light);
    colour
        * way.map_or(1.0, |(ray, distance)| {
            visibility_along(volumes, &ray, distance)
        })
}

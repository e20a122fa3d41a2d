//! Depth of a classified volume, as plainly as it can be written.
//!
//! A ray sees a volume over a range of distances. The sample `i` of the [ray caster](super::ray_caster), in the middle
//! of its step at the distance `tᵢ`, adds `aᵢ Tᵢ` to the opacity `α`, and so does a surface of the
//! [isosurfaces](super::isosurface). The mean depth weighs the distances by that; the half depth is where opacity
//! reaches one half: at a surface, or within a step of constant extinction.
//!
//! ```text
//! mean = Σᵢ tᵢ aᵢ Tᵢ / Σᵢ aᵢ Tᵢ
//! half = tᵢ + (x − ½) h,     Tᵢ (1 − aᵢ)ˣ = ½,     0 ≤ x ≤ 1
//! ```
//!
//! Along the view, a distance is multiplied by the cosine of the angle between the ray and the direction in which
//! the camera looks. Where several volumes are merged, a piece takes the place of a step, and
//! the surface that ends the ray adds the rest. A ray that meets no opacity has no depth, nor has one a half depth whose opacity stays below one
//! half: these are infinite.
//!
//! Source: Mildenhall et al. 2020, "NeRF: Representing scenes as neural radiance fields for view synthesis" (the weights
//! `aᵢ Tᵢ` as a distribution over distances: its mean and its median).

use super::clips::{SeveralVolumes, nearest_hit};
use super::{isosurface, projection};
use crate::film::Depth;
use crate::geometry::Ray;
use crate::math::ln;
use crate::scene::{Classified, Compositing, Isosurface, Mode};

/// Depth of each pixel, world units, row by row from the top.
pub fn render(scene: &Classified, [width, height]: [usize; 2], depth: Depth) -> Vec<f32> {
    let alone: Vec<Classified> = scene.each_alone().collect();
    let several = scene
        .has_objects()
        .then(|| SeveralVolumes::of(scene, &alone));
    let pixel = |index: usize| {
        let camera = &scene.camera;
        let ray = camera.ray([index % width, index / width], [width, height]);
        let cosine = ray.direction.dot(*camera.axis);
        let scale = if depth.along_view { cosine } else { 1.0 };
        let layers = match &several {
            Some(several) => merged_layers(several, &ray),
            None => layers(scene, &ray),
        };
        (scale * along(scene, &layers, depth.half)) as f32
    };
    (0..width * height).map(pixel).collect()
}

/// Depth of `layers`, from the eye on.
fn along(scene: &Classified, layers: &[(f64, f64, f64)], half: bool) -> f64 {
    let (mut transmittance, mut weights, mut moments) = (1.0, 0.0, 0.0);
    for &(t, length, opacity) in layers {
        let after = transmittance * (1.0 - opacity);
        if half && after <= 0.5 {
            let part = ln(0.5 / transmittance) / ln(1.0 - opacity);
            return t + (part - 0.5) * length;
        }
        weights += transmittance * opacity;
        moments += t * transmittance * opacity;
        transmittance = after;
        if matches!(scene.compositing, Compositing::EarlyTermination(least) if after < least) {
            break;
        }
    }
    if half || weights == 0.0 {
        return f64::INFINITY;
    }
    moments / weights
}

/// Distance of the middle, length and opacity of what `ray` passes: pieces of several volumes, and a surface at its
/// end, which has no length.
fn merged_layers(several: &SeveralVolumes<'_>, ray: &Ray) -> Vec<(f64, f64, f64)> {
    let hit = nearest_hit(several.scene, ray).map(|(hit, _)| hit.t);
    let pieces = several
        .pieces(ray, hit.unwrap_or(f64::INFINITY))
        .into_iter();
    let pieces =
        pieces.map(|(span, piece)| (0.5 * (span.near + span.far), span.length(), piece.opacity));
    pieces.chain(hit.map(|t| (t, 0.0, 1.0))).collect()
}

/// Distance, length and opacity of what `ray` passes in one volume: samples, or surfaces, which have no length.
fn layers(scene: &Classified, ray: &Ray) -> Vec<(f64, f64, f64)> {
    if let Mode::Isosurfaces(of) = &scene.mode {
        let passed = isosurface::passed(scene, &of.surfaces, ray);
        let layer = |(t, surface): (f64, &Isosurface)| (t, 0.0, surface.opacity);
        return passed.into_iter().map(layer).collect();
    }
    let samples = projection::samples(scene, ray).into_iter();
    let opacity = |value, length| scene.transfer_function.opacity(value, length);
    let layers = samples.map(|it| (it.t, it.length, opacity(it.value, it.length)));
    layers.collect()
}

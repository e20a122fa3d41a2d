//! The image of a classified volume by the ray caster for conventions of other renderers, and of its projections and
//! isosurfaces, exact or by samples.

use super::modes::ExactField;
use crate::conventions::RayCaster;
use crate::render::counters::{Counters, Event};
use crate::render::pixels::{Pixels, each};
use crate::scene::Classified;

/// The pixels of `scene`.
pub(in crate::render) fn cast(
    scene: &Classified,
    pixels: &Pixels<'_>,
) -> (Vec<[f32; 4]>, Counters) {
    let caster = RayCaster::new(scene);
    let exact = scene.is_exact().then(|| ExactField::new(scene));
    let size = [pixels.width, pixels.height];
    let surfaces = scene.objects.surfaces.len() as u64;
    let (image, mut work) = each(pixels, |position, work| {
        let (pixel, of_ray) = match &exact {
            Some(field) => field.pixel(&caster, &scene.camera.ray(position, size), work),
            None => caster.pixel(position, size),
        };
        work.count_times(Event::SurfaceTest, surfaces);
        work.count_times(Event::DensityLookup, of_ray.density_lookups);
        work.count_times(Event::GradientLookup, of_ray.gradient_lookups);
        work.count_times(Event::Attenuation, of_ray.attenuations);
        work.count_times(Event::EmissionTerm, of_ray.emission_terms);
        work.count_times(Event::ShadowRay, of_ray.shadow_rays);
        work.count_times(Event::RandomDraw, of_ray.random_draws);
        pixel
    });
    work.count_times(Event::GradientComputed, caster.gradients_computed());
    (image, work)
}

//! The image of a classified volume under conventions of other renderers, by their own ray caster.

use crate::conventions::{RayCaster, RayWork};
use crate::render::counters::{Counters, Event};
use crate::render::pixels::{Pixels, each};
use crate::scene::Classified;

/// The pixels of `scene`.
pub(in crate::render) fn cast(
    scene: &Classified,
    pixels: &Pixels<'_>,
) -> (Vec<[f32; 4]>, Counters) {
    let size = [pixels.width, pixels.height];
    let caster = RayCaster::new(scene);
    let (image, mut work) = each(pixels, |position, work| {
        let (pixel, of_ray) = caster.pixel(position, size);
        count(of_ray, work);
        work.count_times(Event::SurfaceTest, scene.objects.surfaces.len() as u64);
        pixel
    });
    work.count_times(Event::GradientComputed, caster.gradients_computed());
    (image, work)
}

/// Counts the work of a ray.
pub(super) fn count(of_ray: RayWork, work: &mut Counters) {
    work.count_times(Event::DensityLookup, of_ray.density_lookups);
    work.count_times(Event::GradientLookup, of_ray.gradient_lookups);
    work.count_times(Event::Attenuation, of_ray.attenuations);
    work.count_times(Event::EmissionTerm, of_ray.emission_terms);
    work.count_times(Event::ShadowRay, of_ray.shadow_rays);
    work.count_times(Event::RandomDraw, of_ray.random_draws);
}

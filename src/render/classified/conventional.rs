//! The image of a classified volume under conventions of other renderers, by their own ray caster.

use crate::conventions::{CommonSteps, RayWork, as_stored, each_alone, ray_caster::RayCaster};
use crate::render::counters::{Counters, Event};
use crate::render::pixels::{Pixels, rows};
use crate::scene::Classified;

/// The pixels of `scene`.
pub(in crate::render) fn cast(
    scene: &Classified,
    pixels: &Pixels<'_>,
) -> (Vec<[f32; 4]>, Counters) {
    let size = [pixels.width, pixels.height];
    if scene.volume_count() > 1 {
        let volumes = each_alone(scene);
        let caster = CommonSteps::new(scene, &volumes);
        let gradients = caster.gradients_computed();
        return by(scene, pixels, gradients, |pixel| caster.pixel(pixel, size));
    }
    let scene = as_stored(scene);
    let caster = RayCaster::new(&scene);
    let gradients = caster.gradients_computed();
    by(&scene, pixels, gradients, |pixel| caster.pixel(pixel, size))
}

/// The pixels of `scene`, each by `cast`, after so many `gradients` were computed.
fn by(
    scene: &Classified,
    pixels: &Pixels<'_>,
    gradients: u64,
    cast: impl Fn([usize; 2]) -> ([f32; 4], RayWork) + Sync,
) -> (Vec<[f32; 4]>, Counters) {
    let (image, mut work) = rows(
        pixels,
        || (),
        |position, _, (), work| {
            let (pixel, of_ray) = cast(position);
            count(of_ray, work);
            work.count_times(Event::SurfaceTest, scene.objects.surfaces.len() as u64);
            pixel
        },
    );
    work.count_times(Event::GradientComputed, gradients);
    (image, work)
}

/// Counts the work of a ray.
pub(super) fn count(of_ray: RayWork, work: &mut Counters) {
    let RayWork {
        density_lookups,
        gradient_lookups,
        attenuations,
        emission_terms,
        shadow_rays,
        random_draws,
    } = of_ray;
    work.count_times(Event::DensityLookup, density_lookups);
    work.count_times(Event::GradientLookup, gradient_lookups);
    work.count_times(Event::Attenuation, attenuations);
    work.count_times(Event::EmissionTerm, emission_terms);
    work.count_times(Event::ShadowRay, shadow_rays);
    work.count_times(Event::RandomDraw, random_draws);
}

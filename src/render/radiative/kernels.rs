//! The one place where a plan for surfaces and media becomes code: each part of the plan picks a
//! constant, and the last call compiles the renderer for the constants picked.

use super::context::Scratch;
use super::effects::{Effects, Everything, Only};
use super::line_of_sight::{LineOfSight, TOLERANCE};
use super::path_tracer::{PathFault, PathTracer};
use super::sampler::Sampler;
use super::scene_context::SceneContext;
use crate::math::Moments;
use crate::math::rng::{Purpose, Stream};
use crate::render::counters::Work;
use crate::render::pixels::{Pixels, rows};
use crate::render::plan::RadiativeFeatures;
use crate::render::progress::SAMPLES_A_STEP;
use crate::scene::Radiative;
use glam::DVec3;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicU32, Ordering};

/// A task run by code compiled for certain effects.
pub(in crate::render) trait KernelTask {
    /// Its result.
    type Output;

    /// Light may be scattered in heterogeneous media.
    const SCATTERS_IN_HETEROGENEOUS: bool;

    /// Runs it for the effects `E`.
    fn run<E: Effects>(self) -> Self::Output;
}

/// Runs `task` by the code compiled for `features`.
pub(in crate::render) fn with_features<R: KernelTask>(
    features: RadiativeFeatures,
    task: R,
) -> R::Output {
    // Unit tests are spared compiling all of it once more: the general code gives the same bits,
    // as tests/library/transport shows.
    if cfg!(test) {
        return task.run::<Everything>();
    }
    with_special_features(features, task)
}

fn with_special_features<R: KernelTask>(features: RadiativeFeatures, task: R) -> R::Output {
    if features.heterogeneous {
        return with_heterogeneous_media(features, task);
    }
    match (features.media, features.surfaces) {
        (false, false) => task.run::<Only<false, false, false, false, false, false>>(),
        (false, true) => task.run::<Only<false, true, false, false, false, false>>(),
        // To cut rays at the boundaries of several media costs more than to find no surfaces.
        (true, _) if features.single_medium => with_emission::<R, false>(features, task),
        (true, _) => with_emission::<R, true>(features, task),
    }
}

/// Tracking light through heterogeneous media costs far more than to find that there are no
/// surfaces: no code is compiled without them.
fn with_heterogeneous_media<R: KernelTask>(features: RadiativeFeatures, task: R) -> R::Output {
    // Without scattering there is no phase function.
    if features.anisotropic || !R::SCATTERS_IN_HETEROGENEOUS {
        match (features.emission, features.chromatic) {
            (false, false) => task.run::<Only<true, true, false, false, true, true>>(),
            (false, true) => task.run::<Only<true, true, false, true, true, true>>(),
            (true, false) => task.run::<Only<true, true, true, false, true, true>>(),
            (true, true) => task.run::<Only<true, true, true, true, true, true>>(),
        }
    } else {
        match (features.emission, features.chromatic) {
            (false, false) => task.run::<Only<true, true, false, false, false, true>>(),
            (false, true) => task.run::<Only<true, true, false, true, false, true>>(),
            (true, false) => task.run::<Only<true, true, true, false, false, true>>(),
            (true, true) => task.run::<Only<true, true, true, true, false, true>>(),
        }
    }
}

fn with_emission<R: KernelTask, const SURFACES: bool>(
    features: RadiativeFeatures,
    task: R,
) -> R::Output {
    if features.emission {
        with_colour::<R, SURFACES, true>(features, task)
    } else {
        with_colour::<R, SURFACES, false>(features, task)
    }
}

fn with_colour<R: KernelTask, const SURFACES: bool, const EMISSION: bool>(
    features: RadiativeFeatures,
    task: R,
) -> R::Output {
    match (features.chromatic, features.anisotropic) {
        (false, false) => task.run::<Only<true, SURFACES, EMISSION, false, false, false>>(),
        (false, true) => task.run::<Only<true, SURFACES, EMISSION, false, true, false>>(),
        (true, false) => task.run::<Only<true, SURFACES, EMISSION, true, false, false>>(),
        (true, true) => task.run::<Only<true, SURFACES, EMISSION, true, true, false>>(),
    }
}

/// Renders a scene by integrals along the line of sight.
pub(in crate::render) struct ByLineOfSight<'p, W> {
    pub scene: &'p Radiative,
    pub features: RadiativeFeatures,
    pub scattering: bool,
    pub pixels: &'p Pixels<'p>,
    pub work: PhantomData<W>,
}

impl<W: Work> KernelTask for ByLineOfSight<'_, W> {
    type Output = (Vec<Result<[f32; 3], PathFault>>, W);

    const SCATTERS_IN_HETEROGENEOUS: bool = false;

    fn run<E: Effects>(self) -> Self::Output {
        let renderer = LineOfSight::<E> {
            scene: SceneContext::for_integrals(self.scene, self.features.vacuum_media),
            scattering: self.scattering,
            tolerance: TOLERANCE,
        };
        let size = [self.pixels.width, self.pixels.height];
        rows(
            self.pixels,
            Scratch::default,
            |pixel, _, scratch, work: &mut W| {
                let ray = self.scene.camera.ray(pixel, size);
                let radiance = renderer.radiance(&ray, scratch, work);
                finite(radiance).map(|radiance| radiance.as_vec3().to_array())
            },
        )
    }
}

/// Renders a scene by tracing paths, each through a random point of its pixel.
pub(in crate::render) struct ByPathTracing<'p, W> {
    pub scene: &'p Radiative,
    pub features: RadiativeFeatures,
    pub max_order: Option<u32>,
    pub seed: u64,
    pub pixels: &'p Pixels<'p>,
    pub work: PhantomData<W>,
}

impl<W: Work> KernelTask for ByPathTracing<'_, W> {
    /// By pixel, the moments of its samples by channel.
    type Output = (Vec<Result<[Moments; 3], PathFault>>, W);

    const SCATTERS_IN_HETEROGENEOUS: bool = true;

    fn run<E: Effects>(self) -> Self::Output {
        let scene = self.scene;
        let tracer = PathTracer::<E>::new(scene, self.max_order, self.features.vacuum_media);
        let size = [self.pixels.width, self.pixels.height];
        let edge = self.pixels.edge();
        let given_up = GivenUp::default();
        rows(
            self.pixels,
            Scratch::default,
            |[column, row], samples, scratch, work: &mut W| {
                let index = (row * size[0] + column) as u32;
                if given_up.is_before(index) {
                    return Err(PathFault::Endless);
                }
                let mut moments = [Moments::default(); 3];
                for sample in 0..samples {
                    let mut sampler = Sampler::new(Stream::new(self.seed, index, sample));
                    let [x, y] = sampler.pair(Purpose::Camera, 0);
                    let place = [column as f64 + edge * x, row as f64 + edge * y];
                    let ray = scene.camera.ray_through(place, size);
                    let radiance = tracer.radiance(ray, sampler, scratch, work);
                    if radiance == Err(PathFault::Endless) {
                        given_up.at(index);
                    }
                    let radiance = finite(radiance?)?;
                    for (moments, channel) in moments.iter_mut().zip(radiance.to_array()) {
                        moments.add(channel);
                    }
                    if (sample + 1) % SAMPLES_A_STEP == 0 {
                        self.pixels.progress.step();
                    }
                }
                Ok(moments)
            },
        )
    }
}

/// A radiance that overflows has no mean: together with others it would become NaN.
fn finite(radiance: DVec3) -> Result<DVec3, PathFault> {
    if radiance.to_array().contains(&f64::INFINITY) {
        Err(PathFault::Infinite)
    } else {
        Ok(radiance)
    }
}

/// The first pixel, in the order of the image, that has a path without an end. Each such path
/// takes seconds, and one of them makes the image worthless: those after it need not be traced.
/// All before it are, so on any number of threads the same one is found.
#[derive(Debug)]
struct GivenUp(AtomicU32);

impl Default for GivenUp {
    fn default() -> GivenUp {
        GivenUp(AtomicU32::new(u32::MAX))
    }
}

impl GivenUp {
    fn at(&self, index: u32) {
        self.0.fetch_min(index, Ordering::Relaxed);
    }

    fn is_before(&self, index: u32) -> bool {
        self.0.load(Ordering::Relaxed) < index
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::documented_kernels;
    use std::any::type_name;
    use std::collections::BTreeSet;

    /// The name of the effects that are picked.
    struct EffectsName<const SCATTERS: bool>;

    impl<const SCATTERS: bool> KernelTask for EffectsName<SCATTERS> {
        type Output = &'static str;

        const SCATTERS_IN_HETEROGENEOUS: bool = SCATTERS;

        fn run<E: Effects>(self) -> &'static str {
            type_name::<E>()
        }
    }

    fn kernels<const SCATTERS: bool>() -> usize {
        let choices = (0..64).map(|switches| RadiativeFeatures {
            media: switches & 1 != 0,
            vacuum_media: false,
            single_medium: switches & 1 != 0 && switches & (2 | 32) == 0,
            surfaces: switches & 2 != 0,
            emission: switches & 4 != 0,
            chromatic: switches & 8 != 0,
            anisotropic: switches & 16 != 0,
            heterogeneous: switches & 32 != 0,
        });
        let kernels: BTreeSet<_> = choices
            .map(|features| with_special_features(features, EffectsName::<SCATTERS>))
            .collect();
        assert!(kernels.contains(type_name::<Everything>()));
        kernels.len()
    }

    #[test]
    fn as_many_kernels_as_the_documentation_says() {
        assert_eq!(documented_kernels("path tracer"), kernels::<true>());
        assert_eq!(documented_kernels("line of sight"), kernels::<false>());
    }

    #[test]
    fn the_first_pixel_without_an_end_is_found_in_any_order() {
        let given_up = GivenUp::default();
        assert!(!given_up.is_before(u32::MAX));
        given_up.at(7);
        given_up.at(9);
        assert!(given_up.is_before(8) && !given_up.is_before(7));
        given_up.at(3);
        assert!(given_up.is_before(4) && !given_up.is_before(3));
    }

    #[test]
    fn light_without_bound_is_no_radiance() {
        let red = DVec3::new(f64::INFINITY, 0.0, 1.0);
        assert_eq!(finite(red), Err(PathFault::Infinite));
        assert_eq!(finite(DVec3::MAX), Ok(DVec3::MAX));
    }
}

//! From plans to an image: the kernel of each panel, and panels side by side.

use super::classified::{conventional, curve, integral, ray_caster, several};
use super::counters::Counters;
use super::error::RenderError;
use super::footprint::footprint;
use super::pixels::{Detail, Pixels};
use super::plan::{Kernel, Plan};
use super::progress::{Progress, steps_of};
use super::radiative::faulty_paths;
use super::radiative::kernels;
use super::radiative::path_tracer::PathFault;
use crate::film::Film;
use crate::scene::{Radiative, Sampling};

/// A finished image.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The panels, side by side.
    pub film: Film,
    /// Work done, by panel.
    pub work: Vec<Counters>,
    /// Bound on the error of a pixel, before it is rounded to 32 bits, relative to the brightest of
    /// the image: where a panel is an integral that states one.
    pub error_bound: Option<f64>,
}

/// The image of the panels of `plans`, side by side. Its bits depend only on the plans and the
/// `sampling`, not on the number of threads or the build.
pub fn render(
    plans: &[Plan<'_>],
    sampling: Sampling,
    progress: Progress<'_>,
) -> Result<Rendering, RenderError> {
    render_part(plans, sampling, Detail::Whole, &|| false, progress)
}

/// [`render`] of a part of the image, or of fewer, larger pixels: the same bits as there.
///
/// # Errors
///
/// The errors of [`render`] for the pixels rendered, and [`RenderError::Stopped`] once `stopped` returns
/// true; it is called before every row, from any thread.
pub(crate) fn render_part(
    plans: &[Plan<'_>],
    sampling: Sampling,
    detail: Detail,
    stopped: &(dyn Fn() -> bool + Sync),
    progress: Progress<'_>,
) -> Result<Rendering, RenderError> {
    let bytes = footprint(plans, sampling).most;
    if !has_memory(bytes) {
        return Err(RenderError::Memory {
            width: plans.iter().map(|plan| plan.panel.width).sum(),
            height: plans
                .iter()
                .map(|plan| plan.panel.height)
                .max()
                .unwrap_or(0),
            bytes,
        });
    }
    let of_panels = plans.iter().map(|plan| Pixels {
        width: plan.panel.width,
        height: plan.panel.height,
        samples: plan.samples(sampling),
        detail,
        stopped,
        progress,
    });
    let of_panels: Vec<(&Plan<'_>, Pixels<'_>)> = plans.iter().zip(of_panels).collect();
    let steps = of_panels.iter().map(|(plan, pixels)| steps(plan, pixels));
    progress.begin(steps.sum());
    let mut films = Vec::new();
    let mut work = Vec::new();
    let mut error = None::<f64>;
    for (plan, pixels) in &of_panels {
        let panel = render_panel(plan, sampling, pixels)?;
        films.push(panel.film);
        work.push(panel.work);
        error = error.into_iter().chain(panel.error).reduce(f64::max);
    }
    let film = Film::side_by_side(&films);
    match film.first_without_radiance() {
        None => Ok(Rendering {
            error_bound: error.map(|error| match error {
                0.0 => 0.0,
                _ => error / film.brightest(),
            }),
            film,
            work,
        }),
        // Perhaps finite, but not as a number of 32 bits.
        Some((pixel, value)) if value.contains(&f32::INFINITY) => {
            Err(RenderError::TooBright(pixel))
        }
        Some((pixel, value)) => Err(RenderError::NoRadiance(pixel, value)),
    }
}

/// Whether this many bytes can be allocated at once. They are freed untouched, which costs nothing,
/// so that a lack of memory shows before the work.
fn has_memory(bytes: u64) -> bool {
    let mut memory: Vec<u8> = Vec::new();
    usize::try_from(bytes).is_ok_and(|bytes| memory.try_reserve_exact(bytes).is_ok())
}

/// Progress steps of a panel.
fn steps(plan: &Plan<'_>, pixels: &Pixels<'_>) -> u64 {
    let count = match plan.kernel {
        Kernel::Background(_) => return 0,
        // Drawn whole.
        Kernel::Curve(_) => pixels.width * pixels.height,
        _ => pixels.count(),
    };
    steps_of(count as u64, pixels.samples)
}

/// The image of a panel.
struct PanelImage {
    film: Film,
    work: Counters,
    /// Bound on the error of a pixel, radiance, where the kernel states one.
    error: Option<f64>,
}

fn render_panel(
    plan: &Plan<'_>,
    sampling: Sampling,
    pixels: &Pixels<'_>,
) -> Result<PanelImage, RenderError> {
    let panel = plan.panel;
    let [width, height] = pixels.rendered_size();
    let with_opacity = |(values, work): (Vec<[f32; 4]>, Counters)| {
        let values = finished(values, pixels)?;
        Ok((Film::with_opacity(width, height, values), work))
    };
    let mut error = None;
    let (film, work) = match plan.kernel {
        Kernel::Curve(plot) => {
            let drawn = curve::draw(plot, [panel.width, panel.height], pixels.progress);
            with_opacity((pixels.those_rendered(&drawn), Counters::default()))?
        }
        Kernel::Background(scene) => {
            let [r, g, b] = scene.background.as_vec3().to_array();
            let values = vec![[r, g, b, 0.0]; pixels.count()];
            with_opacity((values, Counters::default()))?
        }
        Kernel::RayCaster { scene, features } => {
            with_opacity(ray_caster::cast(scene, features, pixels))?
        }
        Kernel::Conventional(scene) | Kernel::Field(scene) => {
            with_opacity(conventional::cast(scene, pixels))?
        }
        Kernel::Several(scene) => with_opacity(several::cast(scene, pixels))?,
        Kernel::Integral(scene) => {
            let (integrals, work) = integral::integrate(scene, pixels);
            let errors = integrals.iter().map(|pixel| pixel.1);
            error = Some(errors.fold(0.0, f64::max));
            let values = integrals.into_iter().map(|pixel| pixel.0);
            with_opacity((values.collect(), work))?
        }
        Kernel::LineOfSight {
            scene,
            features,
            scatters,
        } => {
            let (radiance, work) = kernels::integrate(scene, features, scatters, pixels);
            let radiance = without_faults(finished(radiance, pixels)?, scene, width)?;
            (Film::new(width, height, radiance), work)
        }
        Kernel::PathTracer {
            scene,
            features,
            max_order,
        } => {
            let seed = sampling.seed_of(scene);
            let (moments, work) = match panel.fault {
                None => kernels::trace(scene, features, max_order, seed, pixels),
                Some(fault) => faulty_paths::trace(scene, fault, seed, pixels),
            };
            let moments = without_faults(finished(moments, pixels)?, scene, width)?;
            let film = Film::of_moments([width, height], &moments, pixels.samples);
            (film, work)
        }
    };
    Ok(PanelImage { film, work, error })
}

/// All `values` of `pixels`, or the error of a rendering that was stopped before.
fn finished<P>(values: Vec<P>, pixels: &Pixels<'_>) -> Result<Vec<P>, RenderError> {
    if values.len() == pixels.count() {
        Ok(values)
    } else {
        Err(RenderError::Stopped)
    }
}

/// The pixels of an image of `scene` in rows of this `width`, or the error of the first without a radiance.
fn without_faults<P>(
    pixels: Vec<Result<P, PathFault>>,
    scene: &Radiative,
    width: usize,
) -> Result<Vec<P>, RenderError> {
    let has_points = scene.lights.iter().any(|light| light.position().is_some());
    let radiance = |(index, pixel): (usize, Result<P, PathFault>)| {
        let place = [index % width, index / width];
        pixel.map_err(|fault| match fault {
            PathFault::Endless => RenderError::Endless(place),
            PathFault::Infinite if has_points => RenderError::Divergent(place),
            PathFault::Infinite => RenderError::TooBright(place),
            PathFault::Majorant => RenderError::Majorant(place),
        })
    };
    pixels.into_iter().enumerate().map(radiance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Camera;
    use crate::optics::{Light, Point};
    use crate::render::plan::plans;
    use crate::render::progress::Watch;
    use crate::scene::{Scattering, Scene};
    use glam::DVec3;
    use std::sync::atomic::{AtomicU64, Ordering};

    fn scene(lights: Vec<Light>) -> Radiative {
        Radiative {
            scattering: Scattering::Single,
            objects: vec![],
            area_lights: vec![],
            media: vec![],
            lights,
            environment: DVec3::ZERO,
            camera: Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1.0).unwrap(),
            samples: 2,
            seed: 0,
        }
    }

    /// An observer that counts calls.
    #[derive(Default)]
    struct Observer {
        begun: AtomicU64,
        steps: AtomicU64,
    }

    impl Watch for Observer {
        fn begin(&self, steps: u64) {
            self.begun.fetch_add(steps, Ordering::Relaxed);
        }

        fn step(&self) {
            self.steps.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// As many steps are reported as were announced, within pixels of many samples too.
    #[test]
    fn steps_are_those_announced() {
        let fog = |samples: u32, scattering: &str| {
            format!(
                "[film]\nwidth = 6\nheight = 5\n[sampling]\nsamples = {samples}\n\
                 [camera]\neye = [0, 0, -3]\ntarget = [0, 0, 0]\n\
                 [radiative]\nenvironment = 1\nscattering = '{scattering}'\n\
                 [[radiative.medium]]\nsphere = {{ centre = [0, 0, 0], radius = 1 }}\n\
                 sigma_s = 1\nsigma_a = 0.5\n"
            )
        };
        for (text, steps) in [
            (fog(1023, "multiple"), 30),
            (fog(2048, "multiple"), 90),
            (fog(4, "none"), 30),
        ] {
            let scene = Scene::parse(&text, std::path::Path::new("scene.toml")).unwrap();
            let plans = plans(&scene);
            let observer = Observer::default();
            let watched = render(&plans, Sampling::default(), &observer).unwrap();
            assert_eq!(observer.begun.into_inner(), steps);
            assert_eq!(observer.steps.into_inner(), steps);
            let alone = render(&plans, Sampling::default(), &|| ()).unwrap();
            assert_eq!(watched.film.pixel_hash(), alone.film.pixel_hash());
            assert_eq!(watched.work, alone.work);
        }
    }

    #[test]
    fn the_first_fault_is_said() {
        let mut pixels = vec![Ok(()); 8];
        pixels[4] = Err(PathFault::Majorant);
        pixels[6] = Err(PathFault::Endless);
        let found = without_faults(pixels, &scene(vec![]), 3);
        assert_eq!(found, Err(RenderError::Majorant([1, 1])));
    }

    #[test]
    fn only_a_light_without_extent_is_blamed_for_light_without_bound() {
        let pixels = vec![Ok(()), Err(PathFault::Infinite)];
        assert_eq!(
            without_faults(pixels.clone(), &scene(vec![]), 2),
            Err(RenderError::TooBright([1, 0]))
        );
        let lamp = Light::Point(Point {
            position: DVec3::ZERO,
            intensity: DVec3::ONE,
        });
        assert_eq!(
            without_faults(pixels, &scene(vec![lamp]), 2),
            Err(RenderError::Divergent([1, 0]))
        );
    }
}

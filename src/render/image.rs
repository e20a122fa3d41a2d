//! From plans to an image: the kernel of each panel, and panels side by side.

use super::classified::{conventional, curve, integral, modes, ray_caster, several};
use super::counters::Counters;
use super::error::RenderError;
use super::footprint::{Footprint, footprint};
use super::pixels::{Detail, Pixels};
use super::plan::{Kernel, Plan};
use super::progress::{Progress, steps_of};
use super::radiative::faulty_paths;
use super::radiative::kernels;
use super::radiative::path_tracer::PathFault;
use crate::film::Film;
use crate::scene::{Classified, Radiative, Sampling};

/// A finished image.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The panels, side by side.
    pub film: Film,
    /// Work by panel.
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
    let Footprint { most: bytes, .. } = footprint(plans, sampling);
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
    progress.begin(
        of_panels
            .iter()
            .map(|(plan, pixels)| steps(plan, pixels))
            .sum(),
    );
    let mut films = Vec::new();
    let mut work = Vec::new();
    let mut error = None::<f64>;
    for (plan, pixels) in &of_panels {
        let panel = render_panel(plan, sampling, pixels)?;
        films.push(panel.film);
        work.push(panel.work);
        error = match (error, panel.error) {
            (Some(error), Some(panel)) => Some(error.max(panel)),
            (error, panel) => error.or(panel),
        };
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
    let part = PanelPart {
        width: pixels.detail.columns(panel.width).len(),
        height: pixels.detail.rows(panel.height).len(),
    };
    let mut error = None;
    let (film, work) = match plan.kernel {
        Kernel::Curve(plot) => {
            let drawn = curve::draw(plot, [panel.width, panel.height], pixels.progress);
            part.cast((pixels.those_rendered(&drawn), Counters::default()))?
        }
        Kernel::Background(scene) => part.cast((background(scene, pixels), Counters::default()))?,
        Kernel::RayCaster { scene, features } => {
            part.cast(ray_caster::cast(scene, features, pixels))?
        }
        Kernel::Conventional(scene) => part.cast(conventional::cast(scene, pixels))?,
        Kernel::Field(scene) => part.cast(modes::cast(scene, pixels))?,
        Kernel::Several(scene) => part.cast(several::cast(scene, pixels))?,
        Kernel::Integral(scene) => {
            let (integrals, work) = integral::integrate(scene, pixels);
            let errors = integrals.iter().map(|pixel| pixel.1);
            error = Some(errors.fold(0.0, f64::max));
            let values = integrals.into_iter().map(|pixel| pixel.0);
            (part.film(values.collect())?, work)
        }
        Kernel::LineOfSight {
            scene,
            features,
            scatters,
        } => {
            let (radiance, work) = kernels::integrate(scene, features, scatters, pixels);
            let radiance = part.without_faults(scene, part.finished(radiance)?)?;
            (Film::new(part.width, part.height, radiance), work)
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
            let moments = part.without_faults(scene, part.finished(moments)?)?;
            let size = [part.width, part.height];
            (Film::of_moments(size, &moments, pixels.samples), work)
        }
    };
    Ok(PanelImage { film, work, error })
}

/// The part of a panel that is rendered.
#[derive(Clone, Copy)]
struct PanelPart {
    /// Pixels in a row: those of the film, the panel may have more.
    width: usize,
    /// Rows.
    height: usize,
}

impl PanelPart {
    /// All of `pixels`, or the error of a rendering that was stopped before.
    fn finished<P>(self, pixels: Vec<P>) -> Result<Vec<P>, RenderError> {
        if pixels.len() == self.width * self.height {
            Ok(pixels)
        } else {
            Err(RenderError::Stopped)
        }
    }

    /// The film of radiance and opacity, and the work that it took.
    fn cast(
        self,
        (pixels, work): (Vec<[f32; 4]>, Counters),
    ) -> Result<(Film, Counters), RenderError> {
        Ok((self.film(pixels)?, work))
    }

    /// The film of radiance and opacity.
    fn film(self, pixels: Vec<[f32; 4]>) -> Result<Film, RenderError> {
        let pixels = self.finished(pixels)?;
        Ok(Film::with_opacity(self.width, self.height, pixels))
    }

    /// The pixels, or the error of the first without a radiance, if any.
    fn without_faults<P>(
        self,
        scene: &Radiative,
        pixels: Vec<Result<P, PathFault>>,
    ) -> Result<Vec<P>, RenderError> {
        let mut faults = pixels.iter().map(|pixel| pixel.as_ref().err()).enumerate();
        let Some((index, fault)) = faults.find_map(|(index, fault)| Some((index, *fault?))) else {
            return Ok(pixels.into_iter().flatten().collect());
        };
        let pixel = [index % self.width, index / self.width];
        let has_points = scene.lights.iter().any(|light| light.position().is_some());
        Err(match fault {
            PathFault::Endless => RenderError::Endless(pixel),
            PathFault::Infinite if has_points => RenderError::Divergent(pixel),
            PathFault::Infinite => RenderError::TooBright(pixel),
            PathFault::Majorant => RenderError::Majorant(pixel),
        })
    }
}

fn background(scene: &Classified, pixels: &Pixels<'_>) -> Vec<[f32; 4]> {
    let [r, g, b] = scene.background.as_vec3().to_array();
    vec![[r, g, b, 0.0]; pixels.count()]
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

    fn at(width: usize) -> PanelPart {
        PanelPart { height: 0, width }
    }

    #[test]
    fn the_first_fault_is_said() {
        let mut pixels = vec![Ok(()); 8];
        pixels[4] = Err(PathFault::Majorant);
        pixels[6] = Err(PathFault::Endless);
        let found = at(3).without_faults(&scene(vec![]), pixels);
        assert_eq!(found, Err(RenderError::Majorant([1, 1])));
    }

    #[test]
    fn only_a_light_without_extent_is_blamed_for_light_without_bound() {
        let pixels = vec![Ok(()), Err(PathFault::Infinite)];
        assert_eq!(
            at(2).without_faults(&scene(vec![]), pixels.clone()),
            Err(RenderError::TooBright([1, 0]))
        );
        let lamp = Light::Point(Point {
            position: DVec3::ZERO,
            intensity: DVec3::ONE,
        });
        assert_eq!(
            at(2).without_faults(&scene(vec![lamp]), pixels),
            Err(RenderError::Divergent([1, 0]))
        );
    }
}

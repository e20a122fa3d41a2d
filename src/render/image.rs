//! From plans to an image: the kernel of each panel, and panels side by side.

use super::classified::{
    conventional, curve, integral, modes, ray_caster, several, several_integral,
};
use super::counters::{Counters, Event, Uncounted, Work};
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
    /// Work by panel, if it was counted.
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
    render_part(plans, sampling, Detail::Whole, progress)
}

/// [`render`], counting work. Same bits.
pub fn render_counted(
    plans: &[Plan<'_>],
    sampling: Sampling,
    progress: Progress<'_>,
) -> Result<Rendering, RenderError> {
    let (film, work, error_bound) =
        render_with::<Counters>(plans, &Job::whole(sampling, progress))?;
    Ok(Rendering {
        film,
        work,
        error_bound,
    })
}

/// [`render`] of a part of the image: the same bits as there.
pub(crate) fn render_part(
    plans: &[Plan<'_>],
    sampling: Sampling,
    detail: Detail,
    progress: Progress<'_>,
) -> Result<Rendering, RenderError> {
    let job = Job {
        detail,
        ..Job::whole(sampling, progress)
    };
    let (film, _, error_bound) = render_with::<Uncounted>(plans, &job)?;
    Ok(Rendering {
        film,
        work: vec![],
        error_bound,
    })
}

/// A coarse image, of fewer or larger pixels.
///
/// # Errors
///
/// The errors of [`render`] for the pixels rendered, and [`RenderError::Stopped`] once `stopped` returns
/// true; it is called before every row, from any thread.
pub(crate) fn render_coarse(
    plans: &[Plan<'_>],
    sampling: Sampling,
    detail: Detail,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Result<Film, RenderError> {
    let job = Job {
        sampling,
        detail,
        stopped,
        progress: &|| (),
    };
    render_with::<Uncounted>(plans, &job).map(|(film, _, _)| film)
}

/// The work of a coarse image, by panel.
pub(crate) fn render_coarse_counted(
    plans: &[Plan<'_>],
    sampling: Sampling,
    detail: Detail,
) -> Result<Vec<Counters>, RenderError> {
    let job = Job {
        detail,
        ..Job::whole(sampling, &|| ())
    };
    render_with::<Counters>(plans, &job).map(|(_, work, _)| work)
}

/// The part of an image to be rendered, and its samples.
struct Job<'e> {
    sampling: Sampling,
    detail: Detail,
    /// Whether to stop early; called before every row.
    stopped: &'e (dyn Fn() -> bool + Sync),
    progress: Progress<'e>,
}

impl<'e> Job<'e> {
    fn whole(sampling: Sampling, progress: Progress<'e>) -> Job<'e> {
        Job {
            sampling,
            detail: Detail::Whole,
            stopped: &|| false,
            progress,
        }
    }
}

/// The image, the work by panel, and [`Rendering::error_bound`].
type Whole<W> = (Film, Vec<W>, Option<f64>);

fn render_with<W: Work>(plans: &[Plan<'_>], job: &Job<'_>) -> Result<Whole<W>, RenderError> {
    let Footprint { most: bytes, .. } = footprint(plans, job.sampling);
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
    let steps = plans.iter().map(|plan| steps(plan, job));
    job.progress.begin(steps.sum());
    let mut films = Vec::new();
    let mut works = Vec::new();
    let mut error = None::<f64>;
    for plan in plans {
        let panel = render_panel(plan, job)?;
        films.push(panel.film);
        works.push(panel.work);
        error = match (error, panel.error) {
            (Some(error), Some(panel)) => Some(error.max(panel)),
            (error, panel) => error.or(panel),
        };
    }
    let film = Film::side_by_side(&films);
    let found = film.first_without_radiance();
    match found {
        None => {
            let error_bound = error.map(|error| relative_to_brightest(error, &film));
            Ok((film, works, error_bound))
        }
        // Finite, or it had been refused before, but not as a number of 32 bits.
        Some(([column, row], value)) if value.contains(&f32::INFINITY) => {
            Err(RenderError::TooBright { column, row })
        }
        Some(([column, row], value)) => Err(RenderError::NoRadiance { column, row, value }),
    }
}

/// `error` relative to the brightest pixel of `film`.
fn relative_to_brightest(error: f64, film: &Film) -> f64 {
    if error > 0.0 {
        error / film.brightest()
    } else {
        0.0
    }
}

/// Whether this many bytes can be allocated at once. They are freed untouched, which costs nothing,
/// so that a lack of memory shows before the work.
fn has_memory(bytes: u64) -> bool {
    let mut memory: Vec<u8> = Vec::new();
    usize::try_from(bytes).is_ok_and(|bytes| memory.try_reserve_exact(bytes).is_ok())
}

/// Progress steps of a panel.
fn steps(plan: &Plan<'_>, job: &Job<'_>) -> u64 {
    let (width, height) = (plan.panel.width, plan.panel.height);
    let pixels = match plan.kernel {
        Kernel::Background(_) => return 0,
        // Drawn whole.
        Kernel::Curve(_) => width * height,
        _ => job.detail.columns(width).len() * job.detail.rows(height).len(),
    };
    steps_of(pixels as u64, plan.samples(job.sampling))
}

/// The image of a panel.
struct PanelImage<W> {
    film: Film,
    work: W,
    /// Bound on the error of a pixel, radiance, where the kernel states one.
    error: Option<f64>,
}

fn render_panel<W: Work>(plan: &Plan<'_>, job: &Job<'_>) -> Result<PanelImage<W>, RenderError> {
    let panel = plan.panel;
    let pixels = Pixels {
        width: panel.width,
        height: panel.height,
        samples: plan.samples(job.sampling),
        detail: job.detail,
        stopped: job.stopped,
        progress: job.progress,
    };
    let part = PanelPart {
        width: job.detail.columns(panel.width).len(),
        height: job.detail.rows(panel.height).len(),
    };
    let mut error = None;
    let (film, work) = match plan.kernel {
        Kernel::Curve(plot) => {
            let drawn = curve::draw(plot, [panel.width, panel.height], job.progress);
            let drawn = pixels.those_rendered(&drawn);
            (part.film(drawn)?, W::default())
        }
        Kernel::Background(scene) => (part.film(background(scene, &pixels))?, W::default()),
        Kernel::RayCaster { scene, features } => {
            let (cast, counters) = ray_caster::cast(scene, features, &pixels);
            let mut work = W::default();
            for event in Event::ALL {
                work.count_times(event, counters[event]);
            }
            (part.film(cast)?, work)
        }
        Kernel::Conventional(scene) => {
            let (cast, work) = conventional::cast(scene, &pixels);
            (part.film(cast)?, work)
        }
        Kernel::Field(scene) => {
            let (cast, work) = modes::cast(scene, &pixels);
            (part.film(cast)?, work)
        }
        Kernel::Several(scene) => {
            let (cast, work) = several::cast(scene, &pixels);
            (part.film(cast)?, work)
        }
        Kernel::Integral(scene) => {
            let (integrals, work) = if scene.has_objects() {
                several_integral::integrate(scene, &pixels)
            } else {
                integral::integrate(scene, &pixels)
            };
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
            let (radiance, work) = kernels::integrate(scene, features, scatters, &pixels);
            let radiance = part.without_faults(scene, part.finished(radiance)?)?;
            (Film::new(part.width, part.height, radiance), work)
        }
        Kernel::PathTracer {
            scene,
            features,
            max_order,
        } => {
            let seed = job.sampling.seed_of(scene);
            let (moments, work) = match panel.fault {
                None => kernels::trace(scene, features, max_order, seed, &pixels),
                Some(fault) => faulty_paths::trace(scene, fault, seed, &pixels),
            };
            let moments = part.without_faults(scene, part.finished(moments)?)?;
            let size = [part.width, part.height];
            (Film::of_moments(size, &moments, pixels.samples), work)
        }
    };
    Ok(PanelImage { film, work, error })
}

/// Whether the scene has a light of unbounded radiance.
fn has_points(scene: &Radiative) -> bool {
    scene.lights.iter().any(|light| light.position().is_some())
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
        let faults = || {
            let faults = pixels.iter().enumerate();
            faults.filter_map(|(index, pixel)| Some((index, *pixel.as_ref().err()?)))
        };
        let Some((index, fault)) = faults().next() else {
            return Ok(pixels.into_iter().flatten().collect());
        };
        let column = index % self.width;
        let row = index / self.width;
        Err(match fault {
            PathFault::Endless => RenderError::Endless { column, row },
            PathFault::Infinite if has_points(scene) => RenderError::Divergent { column, row },
            PathFault::Infinite => RenderError::TooBright { column, row },
            PathFault::Majorant(_) => RenderError::Majorant {
                violations: faults()
                    .map(|(_, fault)| fault)
                    // Of the pixels behind one without an end, chance decides which are traced.
                    .take_while(|fault| *fault != PathFault::Endless)
                    .map(|fault| match fault {
                        PathFault::Majorant(violations) => violations,
                        PathFault::Infinite | PathFault::Endless => 0,
                    })
                    .sum(),
                column,
                row,
            },
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
            let watched = render_counted(&plans, Sampling::default(), &observer).unwrap();
            assert_eq!(observer.begun.into_inner(), steps);
            assert_eq!(observer.steps.into_inner(), steps);
            let alone = render_counted(&plans, Sampling::default(), &|| ()).unwrap();
            assert_eq!(watched.film.pixel_hash(), alone.film.pixel_hash());
            assert_eq!(watched.work, alone.work);
        }
    }

    fn at(width: usize) -> PanelPart {
        PanelPart { height: 0, width }
    }

    #[test]
    fn violated_bounds_are_counted_over_all_pixels_and_refused() {
        let mut pixels = vec![Ok(()); 8];
        pixels[4] = Err(PathFault::Majorant(2));
        pixels[5] = Err(PathFault::Majorant(40));
        let expected = Err(RenderError::Majorant {
            violations: 42,
            column: 1,
            row: 1,
        });
        assert_eq!(
            at(3).without_faults(&scene(vec![]), pixels.clone()),
            expected
        );
        // Whether what comes after a path without an end is traced is left to chance.
        pixels[6] = Err(PathFault::Endless);
        pixels[7] = Err(PathFault::Majorant(1));
        assert_eq!(
            at(3).without_faults(&scene(vec![]), pixels.clone()),
            expected
        );
    }

    #[test]
    fn only_a_light_without_extent_is_blamed_for_light_without_bound() {
        let pixels = vec![Ok(()), Err(PathFault::Infinite)];
        let (column, row) = (1, 0);
        assert_eq!(
            at(2).without_faults(&scene(vec![]), pixels.clone()),
            Err(RenderError::TooBright { column, row })
        );
        let lamp = Light::Point(Point {
            position: DVec3::ZERO,
            intensity: DVec3::ONE,
        });
        assert_eq!(
            at(2).without_faults(&scene(vec![lamp]), pixels),
            Err(RenderError::Divergent { column, row })
        );
    }
}

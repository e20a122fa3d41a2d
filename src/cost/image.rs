//! Cost of a classified image: the ray caster's step, the schemes people write, the step of shadow
//! rays, and interpolation.

use super::classified::{Shade, ShadedVolume, has_jumps};
use super::marching::Scheme;
use super::norms::root_mean_square;
use super::order::ExpectedOrder;
use super::preintegration::Preintegrated;
use super::results::{ErrorPicture, Parameter, RayTrace, Study};
use super::study::{PlannedSweep, Setting, SettingOutcome, SettingRun, Truth, halved};
use super::thumbnail;
use super::timing::Clock;
use crate::geometry::Ray;
use crate::math::rng::{Purpose, Stream};
use crate::math::{exp, ln_1p};
use crate::optics::collocation::{CollocatedLight, Collocation};
use crate::render::Counters;
use crate::render::classified::steps::Steps;
use crate::scene::Classified;
use crate::volume::Interpolation;
use glam::DVec3;
use rayon::prelude::*;

/// Pixels of the larger side of the small image: every sweep needs the same rays, and some hundred
/// of them tell an order as well as all do.
const SIDE: usize = 32;
/// Pixels of the larger side where every sample casts a ray to the light.
const SIDE_WITH_SHADOW: usize = 10;

/// Steps, in voxels.
const STEPS: [f64; 9] = halved(4.0);
/// Steps where every sample casts a ray to the light: those that take seconds.
const STEPS_WITH_SHADOW: [f64; 6] = halved(4.0);

/// Steps of shadow rays, in voxels.
const SHADOW_STEPS: [f64; 7] = halved(4.0);

/// A voxel of this optical depth lets a hundredth of the light through.
const OPAQUE: f64 = 4.605_170_185_988_092;

/// Accuracy of each element of the reference, for a radiance of 1.
const TOLERANCE: f64 = 1e-12;
/// Accuracy where every evaluation walks to the light.
const TOLERANCE_WITH_SHADOW: f64 = 1e-10;

/// Rounding of sums of some hundred terms of size 1.
const ROUNDING: f64 = 1e-14;

/// Rays of a scene, with the true radiance of each.
pub(super) struct Rays<'s> {
    scene: &'s Classified,
    /// The scene with its exact shadow.
    subject: ShadedVolume<'s>,
    size: [usize; 2],
    rays: Vec<Ray>,
    right: Vec<DVec3>,
    /// By ray and channel, true if no voxel on the way is nearly opaque: in such a voxel light ends
    /// in less than a step, and no rule has its order before steps are finer than that.
    clear: Vec<bool>,
    /// Root mean square of the true radiance.
    scale: f64,
    bound: f64,
}

impl<'s> Rays<'s> {
    fn new(scene: &'s Classified, size: [usize; 2]) -> Rays<'s> {
        let (most, tolerance) = match scene.shadow {
            None => (SIDE, TOLERANCE),
            Some(_) => (SIDE_WITH_SHADOW, TOLERANCE_WITH_SHADOW),
        };
        let shade = if ShadedVolume::has_exact_shadow(scene) {
            Shade::Exact
        } else {
            Shade::AsGiven
        };
        let collocation = Collocation::new();
        let steepest = OPAQUE / scene.voxel();
        let size = thumbnail::thumbnail(size, most);
        let rays = Rays::against(scene, shade, size, |subject, ray| {
            let (light, met) = subject.exact(&collocation, ray, tolerance);
            (light, met < steepest)
        });
        Rays {
            bound: rays.bound.max(ROUNDING),
            ..rays
        }
    }

    /// The rays of an image of `size`; `right` gives the true radiance of each, and true where it
    /// is clear.
    pub(super) fn against(
        scene: &'s Classified,
        shade: Shade,
        size: [usize; 2],
        right: impl Fn(&ShadedVolume<'s>, &Ray) -> (CollocatedLight, bool) + Sync,
    ) -> Rays<'s> {
        let subject = ShadedVolume::new(scene, shade);
        let rays = thumbnail::rays(&scene.camera, size);
        let exact: Vec<(CollocatedLight, bool)> =
            rays.par_iter().map(|ray| right(&subject, ray)).collect();
        let right: Vec<DVec3> = exact.iter().map(|(light, _)| light.radiance).collect();
        let scale = root_mean_square(right.iter().flat_map(|radiance| radiance.to_array()));
        let errors = exact.iter().map(|(light, _)| light.radiance_error);
        Rays {
            scene,
            subject,
            size,
            rays,
            right,
            clear: exact.iter().flat_map(|(_, clear)| [*clear; 3]).collect(),
            bound: errors.fold(0.0, f64::max) / scale,
            scale,
        }
    }

    /// The truth about them, by `method`.
    pub(super) fn truth(&self, method: &str) -> Truth<'_> {
        Truth {
            method: method.to_owned(),
            scale: self.scale,
            bound: self.bound,
            judged: None,
        }
    }

    /// Asks `radiance` for every ray.
    pub(super) fn run<'a>(
        &'a self,
        radiance: impl Fn(&Ray, usize, &mut Counters) -> DVec3 + Send + Sync + 'a,
    ) -> SettingRun<'a> {
        Box::new(move || {
            SettingOutcome::of_rays(self.rays.len(), &|index, work| {
                let value = radiance(&self.rays[index], index, work);
                Some((value - self.right[index]).to_array())
            })
        })
    }

    /// A sweep of the step along the rays.
    fn by_step<'a>(
        &'a self,
        estimator: &str,
        expected: ExpectedOrder,
        run: impl Fn(f64) -> SettingRun<'a>,
    ) -> PlannedSweep<'a> {
        let steps: &[f64] = match self.scene.shadow {
            None => &STEPS,
            Some(_) => &STEPS_WITH_SHADOW,
        };
        let voxel = self.scene.voxel();
        let setting = |voxels: &f64| {
            let step = voxels * voxel;
            Setting::new(in_words(*voxels), step, run(step))
        };
        PlannedSweep {
            estimator: estimator.to_owned(),
            is_ours: false,
            parameter: Parameter::Step,
            expected,
            settings: steps.iter().map(setting).collect(),
        }
    }

    /// The order of the midpoint rule.
    fn order(&self) -> ExpectedOrder {
        ExpectedOrder::of_step(if has_jumps(self.scene) { 1.0 } else { 2.0 })
    }

    /// The fast ray caster by its step.
    fn ours(&self) -> PlannedSweep<'_> {
        let mut sweep = self.by_step("midpoint", self.order(), |step| {
            self.run(move |ray, _, work| self.subject.cast(step, ray, work))
        });
        sweep.is_ours = true;
        for setting in &mut sweep.settings {
            let step = setting.value;
            let single = self.run(move |ray, _, _| self.subject.cast_single(step, ray));
            setting.single = Some(single);
        }
        sweep
    }

    /// Another scheme, by its step.
    fn by_scheme(&self, scheme: Scheme) -> PlannedSweep<'_> {
        let expected = match scheme {
            // At both ends of a volume with an empty border there is nothing: errors at the ends,
            // which make a rule of the first order one, are not there.
            Scheme::Left | Scheme::Comb => ExpectedOrder::NOTHING,
            // Any jitter across a jump: 1.
            _ if has_jumps(self.scene) => ExpectedOrder::of_step(scheme.order().min(1.0)),
            _ => ExpectedOrder::of_step(scheme.order()),
        };
        self.by_step(scheme.name(), expected, |step| {
            self.run(move |ray, index, work| {
                let Some(span) = self.subject.span(ray) else {
                    return self.subject.before_background(DVec3::ZERO, 0.0);
                };
                let stream = Stream::new(0, index as u32, 0);
                let uniform = |step: usize| stream.uniform(0, Purpose::Tracking, step as u32);
                let mut here = |t: f64| self.subject.here(ray, t, work);
                let (radiance, depth) = scheme.march(&Steps::over(span, step), &mut here, uniform);
                self.subject.before_background(radiance, depth)
            })
        })
    }

    /// Pre-integrated classification, by its step.
    fn by_preintegration<'a>(&'a self, table: &'a Preintegrated<'a>) -> PlannedSweep<'a> {
        let expected = match self.scene.interpolation {
            // Steps of the table are no jumps to it.
            Interpolation::Trilinear => ExpectedOrder::of_step(2.0),
            // Between two nodes' values there is a jump, which it takes for a slope.
            Interpolation::Nearest => ExpectedOrder::of_step(1.0),
        };
        self.by_step("pre-integrated", expected, |step| {
            self.run(move |ray, _, work| {
                let (radiance, depth) = preintegrated(&self.subject, table, step, ray, work);
                self.subject.before_background(radiance, depth)
            })
        })
    }
}

/// Radiance along `ray` by pre-integrated segments of length `step`, and their depth.
///
/// The table holds what the transfer function makes of a segment. What shading and shadow add to
/// that, or take from it, is looked up in its middle.
fn preintegrated(
    subject: &ShadedVolume<'_>,
    table: &Preintegrated<'_>,
    step: f64,
    ray: &Ray,
    work: &mut Counters,
) -> (DVec3, f64) {
    let Some(span) = subject.span(ray) else {
        return (DVec3::ZERO, 0.0);
    };
    let steps = Steps::over(span, step);
    let (mut radiance, mut depth) = (DVec3::ZERO, 0.0);
    let mut front = None;
    for index in 0..steps.count() {
        let (middle, length) = steps.sample(index);
        let near = front.unwrap_or_else(|| subject.value(ray, middle - 0.5 * length, work));
        let far = subject.value(ray, middle + 0.5 * length, work);
        front = Some(far);
        let segment = table.segment(near, far, length);
        let transmittance = exp(-depth);
        radiance += segment.colour * transmittance;
        if subject.is_lit() && segment.opacity > 0.0 {
            let (value, source) = subject.sample(ray, middle, work);
            // Where the middle is transparent nothing is lit, and nothing was asked.
            if subject.is_seen(value) {
                let added = source - subject.unlit(value);
                radiance += added * (segment.opacity * transmittance);
            }
        }
        depth -= ln_1p(-segment.opacity);
    }
    (radiance, depth)
}

/// The image of `scene`, of `size` pixels in full, without shading or shadow; none if it is
/// neither. A highlight may be narrower than any step; emission and absorption are not, and show
/// what order a rule has.
pub(crate) fn unlit_steps(scene: &Classified, size: [usize; 2], clock: &Clock) -> Option<Study> {
    if scene.phong.is_none() && scene.shadow.is_none() {
        return None;
    }
    let unlit = Classified {
        phong: None,
        shadow: None,
        ..scene.clone()
    };
    // Its work is that of the image but for the light; times would only say so again.
    let study = by_steps(&Rays::new(&unlit, size), &clock.untimed());
    Some(Study {
        name: "unlit".to_owned(),
        quantity: format!("{}, without shading or shadow", study.quantity),
        ..study
    })
}

/// The image of `scene`, of `size` pixels in full: radiance by step and scheme.
pub fn steps(scene: &Classified, size: [usize; 2], clock: &Clock) -> Study {
    let rays = Rays::new(scene, size);
    Study {
        pictures: pictures(&rays),
        worst_ray: Some(worst_ray(&rays)),
        ..by_steps(&rays, clock)
    }
}

/// Radiance of `rays` by step and scheme.
fn by_steps(rays: &Rays<'_>, clock: &Clock) -> Study {
    let scene = rays.scene;
    let table = Preintegrated::new(&scene.transfer_function);
    let mut planned = vec![rays.ours()];
    let schemes = Scheme::all().into_iter();
    // The first is what the ray caster does.
    planned.extend(schemes.skip(1).map(|scheme| rays.by_scheme(scheme)));
    planned.push(rays.by_preintegration(&table));
    let clear = rays.clear.iter().filter(|clear| **clear).count();
    let judged = (clear < rays.clear.len()).then_some(&rays.clear[..]);
    let shadow = match scene.shadow {
        None => "",
        Some(_) if ShadedVolume::has_exact_shadow(scene) => ", the shadow integrated cell by cell",
        Some(_) => ", the shadow as the scene samples it",
    };
    let [width, height] = rays.size;
    let quantity = format!("radiance of {width} × {height} pixels{shadow}");
    let truth = Truth {
        judged,
        ..rays.truth(
            "collocation at Gauss points between the faces of cells, halved until its parts agree",
        )
    };
    Study {
        judged_on: judged_on(scene, rays, clear / 3),
        ..Study::of("image", quantity, truth, &planned, clock)
    }
}

/// What is to be known of the orders of an image, `clear` of whose rays are judged.
fn judged_on(scene: &Classified, rays: &Rays<'_>, clear: usize) -> Option<String> {
    let mut words = Vec::new();
    if clear < rays.rays.len() {
        words.push(format!(
            "judged on {clear} of {} rays: the others meet voxels that let less than a hundredth of the \
             light through, and light that ends within a step follows no order",
            rays.rays.len()
        ));
    }
    if scene.phong.is_some() {
        words.push(
            "a highlight may be narrower than any step; `unlit` shows what is left without"
                .to_owned(),
        );
    }
    (!words.is_empty()).then(|| words.join("; "))
}

/// The image of `scene` by the step of its shadow rays, where there are any and where they have
/// a limit that is known.
pub fn shadow_steps(scene: &Classified, size: [usize; 2], clock: &Clock) -> Option<Study> {
    scene.shadow?;
    if !ShadedVolume::has_exact_shadow(scene) {
        return None;
    }
    let voxel = scene.voxel();
    // One step for all: what is compared is the shadow.
    let step = voxel;
    let size = thumbnail::thumbnail(size, SIDE_WITH_SHADOW);
    let rays = Rays::against(scene, Shade::Exact, size, |subject, ray| {
        let light = CollocatedLight {
            radiance: subject.cast(step, ray, &mut Counters::default()),
            ..CollocatedLight::default()
        };
        (light, true)
    });
    let subjects = SHADOW_STEPS.map(|voxels| {
        let length = voxels * voxel;
        (
            voxels,
            length,
            ShadedVolume::new(scene, Shade::Every(length)),
        )
    });
    let settings = subjects.iter().map(|(voxels, length, subject)| {
        let run = rays.run(move |ray, _, work| subject.cast(step, ray, work));
        Setting::new(in_words(*voxels), *length, run)
    });
    let planned = [PlannedSweep {
        estimator: "midpoint".to_owned(),
        is_ours: true,
        parameter: Parameter::ShadowStep,
        expected: rays.order(),
        settings: settings.collect(),
    }];
    let [width, height] = size;
    let quantity = format!(
        "radiance of {width} × {height} pixels by the step of shadow rays, samples 1 voxel apart"
    );
    let truth = Truth {
        bound: ROUNDING,
        ..rays.truth("the shadow integrated cell by cell")
    };
    Some(Study::of("shadow", quantity, truth, &planned, clock))
}

/// Signed errors of three steps, the scene's own among them, on the same rays.
fn pictures(rays: &Rays<'_>) -> Vec<ErrorPicture> {
    let voxel = rays.scene.voxel();
    let own = rays.scene.step / voxel;
    let picture = |voxels: f64| {
        let step = voxels * voxel;
        let run = rays.run(move |ray, _, work| rays.subject.cast(step, ray, work));
        let errors = run().errors;
        let mean = |error: &[f64]| error.iter().sum::<f64>() / 3.0 / rays.scale;
        ErrorPicture {
            setting: format!("midpoint, {voxels} voxels"),
            size: rays.size,
            errors: errors.chunks(3).map(mean).collect(),
        }
    };
    [2.0, own, 0.125].map(picture).into()
}

/// Points of the finely drawn curve of a ray.
const TRACE: usize = 800;

/// The ray on which the scene's own step is farthest off.
fn worst_ray(rays: &Rays<'_>) -> RayTrace {
    let (scene, subject) = (rays.scene, &rays.subject);
    let mut work = Counters::default();
    let errors = rays.rays.iter().zip(&rays.right).map(|(ray, right)| {
        let value = subject.cast(scene.step, ray, &mut work);
        (value - *right).abs().max_element()
    });
    let errors: Vec<f64> = errors.collect();
    let worst = (0..errors.len())
        .max_by(|&a, &b| errors[a].total_cmp(&errors[b]))
        .unwrap_or(0);
    let ray = &rays.rays[worst];
    let mut at = |t: f64| [t, subject.here(ray, t, &mut work).extinction];
    let mut extinction = Vec::new();
    let mut samples = Vec::new();
    if let Some(span) = subject.span(ray) {
        let fine = |index: usize| span.near + span.length() * index as f64 / TRACE as f64;
        extinction = (0..=TRACE).map(|index| at(fine(index))).collect();
        let steps = Steps::over(span, scene.step);
        let middles = (0..steps.count()).map(|index| steps.sample(index).0);
        samples = middles.map(at).collect();
    }
    let value = subject.cast(scene.step, ray, &mut work);
    let [width, height] = rays.size;
    let (column, row) = (worst % width, worst / width);
    RayTrace {
        ray: format!("pixel ({column}, {row}) of {width} × {height}"),
        setting: format!("midpoint, {}", in_voxels(scene.step, scene.voxel())),
        extinction,
        samples,
        value: value.element_sum() / 3.0,
        reference: rays.right[worst].element_sum() / 3.0,
    }
}

/// A length in voxels, in words.
pub(crate) fn in_voxels(length: f64, voxel: f64) -> String {
    // Six digits: the length was a product, and would show the rounding of it.
    in_words((length / voxel * 1e6).round() / 1e6)
}

/// A number of voxels, in words.
pub fn in_words(voxels: f64) -> String {
    match voxels {
        1.0 => "1 voxel".to_owned(),
        _ => format!("{voxels} voxels"),
    }
}

//! A classified volume prepared for all compositing schemes.

use crate::geometry::{Line, Ray, Span};
use crate::math::exp;
use crate::optics::Appearance;
use crate::optics::collocation::{CollocatedLight, Collocation, LocalProperties};
use crate::render::Counters;
use crate::render::classified::compositing::{FrontToBack, Layers};
use crate::render::classified::empty_space::{EmptySpace, Skipping};
use crate::render::classified::field::{GridField, ScalarField};
use crate::render::classified::ray_caster::RayCaster;
use crate::render::classified::shading::{Shaded, Shading};
use crate::render::classified::steps::{SamplePoint, Steps};
use crate::render::classified::volume_shadow::{Visibility, VolumeShadow, shadow_ray};
use crate::render::counters::{Event, Work};
use crate::scene::{Classified, Shadow};
use crate::volume::{DensityField, GridDensity, Interpolation, PlacedBox};
use glam::DVec3;

/// Lighting of the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shade {
    /// Shaded and shadowed as in the scene.
    AsGiven,
    /// Shadow rays with samples at this distance.
    Every(f64),
    /// Shadow without a step, where it is an integral of the density.
    Exact,
    /// All of it.
    None,
}

/// A classified volume with all queries along a ray.
pub(crate) struct ShadedVolume<'s> {
    scene: &'s Classified,
    caster: Caster<'s>,
    density: GridDensity,
}

/// The fast ray caster, compiled once for all scenes: the kind of shading and of shadow is decided
/// for each sample. What is compared is counted, and times are compared among themselves.
type Caster<'s> = RayCaster<
    's,
    GridField<'s, Interpolation>,
    FrontToBack,
    Option<Shaded>,
    AnyVisibility<'s>,
    EmptySpace,
>;

impl<'s> ShadedVolume<'s> {
    /// `scene`, with its samples lit as `shade` says.
    pub fn new(scene: &'s Classified, shade: Shade) -> ShadedVolume<'s> {
        ShadedVolume {
            scene,
            caster: caster(scene, shade),
            density: GridDensity::new(scene.grid.clone(), scene.interpolation),
        }
    }

    /// True if [`Shade::Exact`] is available.
    pub(crate) fn has_exact_shadow(scene: &Classified) -> bool {
        matches!(
            scene.transfer_function.appearance,
            Appearance::Formula { range: None, .. }
        )
    }

    /// The span of `ray` in the volume.
    pub fn span(&self, ray: &Ray) -> Option<Span> {
        self.caster.extent.span(ray)
    }

    /// Radiance along `ray` by volref's ray caster, with this step.
    pub fn cast(&self, step: f64, ray: &Ray, work: &mut Counters) -> DVec3 {
        self.layers(step, ray, work).before(self.scene.background)
    }

    /// Layers along `ray` without the background.
    pub fn layers(&self, step: f64, ray: &Ray, work: &mut Counters) -> Layers {
        self.caster.layers_by(step, ray, work)
    }

    /// Radiance along `ray` if `radiance` lies before an optical `depth`.
    pub(crate) fn before_background(&self, radiance: DVec3, depth: f64) -> DVec3 {
        radiance + self.scene.background * exp(-depth)
    }

    /// The value of the field and the radiance of an opaque sample, at distance `t`.
    pub fn sample(&self, ray: &Ray, t: f64, work: &mut Counters) -> (f64, DVec3) {
        self.caster.at(ray, ray.at(t), work)
    }

    /// Extinction and emission at distance `t`.
    pub fn here(&self, ray: &Ray, t: f64, work: &mut Counters) -> LocalProperties {
        let (value, source) = self.sample(ray, t, work);
        LocalProperties::with_source(self.scene.transfer_function.extinction(value), source)
    }

    /// True if `value` is not transparent.
    pub fn is_seen(&self, value: f64) -> bool {
        self.scene.transfer_function.reference_opacity(value) > 0.0
    }

    /// True if samples are shaded or shadowed.
    pub fn is_lit(&self) -> bool {
        self.scene.phong.is_some() || self.scene.shadow.is_some()
    }

    /// Radiance of an opaque sample of `value` without shading and shadow.
    pub fn unlit(&self, value: f64) -> DVec3 {
        let transfer_function = &self.scene.transfer_function;
        transfer_function.colour(value) * transfer_function.emission(value)
    }

    /// The value of the field alone, at distance `t`.
    pub fn value(&self, ray: &Ray, t: f64, work: &mut Counters) -> f64 {
        work.count(Event::DensityLookup);
        self.density
            .density(self.caster.extent.to_volume(ray.at(t)))
    }

    /// Radiance along `ray` in the limit of small steps, with each element of the integral accurate
    /// to `tolerance`; and the largest extinction met.
    pub fn exact(
        &self,
        collocation: &Collocation,
        ray: &Ray,
        tolerance: f64,
    ) -> (CollocatedLight, f64) {
        let behind = CollocatedLight {
            radiance: self.scene.background,
            ..CollocatedLight::default()
        };
        let Some(span) = self.span(ray) else {
            return (behind, 0.0);
        };
        // Between the faces of cells and the knots of the transfer function all is smooth; a peak of
        // a table may be narrower than what lies between an element's points.
        let knots = self.scene.transfer_function.knots();
        let (mut cuts, mut places) = (Vec::new(), Vec::new());
        for segment in self
            .density
            .cubic_segments(self.caster.extent.line(ray), span)
        {
            places.clear();
            segment.cut_at(&knots, &mut places);
            cuts.extend(places.iter().map(|&u| segment.distance(u)));
        }
        let mut work = Counters::default();
        let mut steepest = 0.0_f64;
        let light = collocation.light(&cuts, tolerance, |t| {
            let here = self.here(ray, t, &mut work);
            steepest = steepest.max(here.extinction);
            here
        });
        (light.before(&behind), steepest)
    }

    /// Radiance along `ray` by the midpoint rule with the variables of a ray caster in single
    /// precision: positions, values, colours, opacities and their sums. Everything evaluated in
    /// between, as interpolation and exponentials, is rounded to single precision each time.
    pub(crate) fn cast_single(&self, step: f64, ray: &Ray) -> DVec3 {
        let background = self.scene.background.as_vec3();
        let Some(span) = self.span(ray) else {
            return background.as_dvec3();
        };
        let steps = Steps::over(span, step);
        let (near, step) = (span.near as f32, step as f32);
        let (origin, direction) = (ray.origin.as_vec3(), ray.direction.as_vec3());
        let (mut colour, mut transmittance) = (glam::Vec3::ZERO, 1.0_f32);
        let mut work = Counters::default();
        for index in 0..steps.count() {
            let (t, length) = match index + 1 < steps.count() {
                true => (near + (index as f32 + 0.5) * step, step),
                false => {
                    let (t, length) = steps.sample(index);
                    (t as f32, length as f32)
                }
            };
            let world = origin + direction * t;
            let (value, source) = self.caster.at(ray, world.as_dvec3(), &mut work);
            let value = f64::from(value as f32);
            let own = self.scene.transfer_function.opacity(value, length.into()) as f32;
            colour += source.as_vec3() * own * transmittance;
            transmittance *= 1.0 - own;
        }
        (colour + background * transmittance).as_dvec3()
    }
}

/// True if the composited function has jumps: with the nearest node, or with a step in the table.
pub(crate) fn has_jumps(scene: &Classified) -> bool {
    scene.interpolation == Interpolation::Nearest
        || match &scene.transfer_function.appearance {
            Appearance::Formula { .. } => false,
            Appearance::Points(points) => {
                let mut pairs = points.points().windows(2);
                pairs.any(|pair| pair[0].value == pair[1].value)
            }
        }
}

fn caster(scene: &Classified, shade: Shade) -> Caster<'_> {
    let extent = scene.extent();
    let sampled = |shadow: Shadow| VolumeShadow {
        shadow,
        light: scene.light,
        extent,
        transfer_function: &scene.transfer_function,
    };
    let visibility = match (scene.shadow, shade) {
        (None, _) | (_, Shade::None) => AnyVisibility::All,
        (Some(shadow), Shade::AsGiven) => AnyVisibility::Sampled(sampled(shadow)),
        (Some(shadow), Shade::Every(step)) => {
            AnyVisibility::Sampled(sampled(Shadow { step, ..shadow }))
        }
        (Some(shadow), Shade::Exact) => AnyVisibility::Exact(ExactShadow {
            light: scene.light,
            reference_step: shadow.reference_step,
            extent,
            density: GridDensity::new(scene.grid.clone(), scene.interpolation),
        }),
    };
    let shading = scene.phong.map(|phong| Shaded {
        phong,
        gradients: scene.gradients(),
        light: scene.light,
    });
    RayCaster {
        field: GridField::new(&scene.grid, scene.interpolation),
        order: FrontToBack::default(),
        shading,
        visibility,
        skipping: EmptySpace::of(&*scene.grid, &scene.transfer_function),
        transfer_function: &scene.transfer_function,
        step: scene.step,
        extent,
    }
}

/// Shading, if there is any.
impl Shading for Option<Shaded> {
    fn shade<F: ScalarField, const N: usize, W: Work>(
        &self,
        colour: DVec3,
        field: &F,
        location: (&F::Locations<N>, usize),
        point: DVec3,
        ray: &Ray,
        work: &mut W,
    ) -> DVec3 {
        match self {
            Some(shaded) => shaded.shade(colour, field, location, point, ray, work),
            None => colour,
        }
    }
}

/// Shadow of any kind.
enum AnyVisibility<'c> {
    All,
    Sampled(VolumeShadow<'c>),
    Exact(ExactShadow),
}

impl Visibility for AnyVisibility<'_> {
    fn at<F: ScalarField, S: Skipping, W: Work>(
        &self,
        sample: SamplePoint,
        field: &F,
        skipping: &S,
        work: &mut W,
    ) -> f64 {
        match self {
            AnyVisibility::All => 1.0,
            AnyVisibility::Sampled(shadow) => shadow.at(sample, field, skipping, work),
            AnyVisibility::Exact(shadow) => shadow.at(sample, field, skipping, work),
        }
    }
}

/// The volume shadow of the ray-casting assignment, `min(1, exp(−S/100))`, with `S` integrated
/// cell by cell: what sampled shadow rays converge to.
struct ExactShadow {
    light: DVec3,
    reference_step: f64,
    extent: PlacedBox,
    density: GridDensity,
}

impl Visibility for ExactShadow {
    fn at<F: ScalarField, S: Skipping, W: Work>(
        &self,
        sample: SamplePoint,
        _: &F,
        _: &S,
        work: &mut W,
    ) -> f64 {
        let Some((ray, span)) = shadow_ray(sample.world, self.light, &self.extent) else {
            return 1.0;
        };
        work.count(Event::ShadowRay);
        let mut lookups = 0;
        let Line { origin, direction } = self.extent.line(&ray);
        let sum = self.density.integral(origin, direction, span, &mut lookups);
        work.count_times(Event::DensityLookup, lookups);
        exp(-(sum / self.reference_step) / 100.0).min(1.0)
    }
}

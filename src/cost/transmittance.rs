//! Cost of transmittance estimates in heterogeneous media, along camera rays.

use super::estimators::TransmittanceEstimator;
use super::marching::Scheme;
use super::norms::root_mean_square;
use super::order::ExpectedOrder;
use super::profile::{BoundedSegment, Extinction, Profile};
use super::results::{Parameter, Study};
use super::rules::StepRule;
use super::study::{PlannedSweep, Setting, SettingOutcome, SettingRun, Truth, halved};
use super::thumbnail;
use super::timing::Clock;
use crate::geometry::{Ray, Span};
use crate::math::rng::{Purpose, Stream};
use crate::math::{exp, powu};
use crate::optics::collocation::{Collocation, LocalProperties};
use crate::optics::{Density, DensityLine, Field};
use crate::render::Counters;
use crate::render::classified::steps::Steps;
use crate::render::counters::{Event, Uncounted, Work};
use crate::render::radiative::effects::Everything;
use crate::render::radiative::media::{Media, Set, members};
use crate::render::radiative::ray_majorants::RayMajorants;
use crate::render::radiative::scene_context::SceneContext;
use crate::render::radiative::segments::MediumSegments;
use crate::volume::{FractalParameters, Interpolation};
use glam::DVec3;
use rayon::prelude::*;

/// Pixels of the larger side of the image whose rays are followed.
const SIDE: usize = 32;
/// Pixels of the larger side where densities have no integral, and the reference is slow.
const SIDE_WITHOUT_INTEGRAL: usize = 16;

/// Steps, in units of the field: voxels, or blocks of what is no grid.
const STEPS: [f64; 10] = halved(4.0);

/// Estimates for each ray.
const ESTIMATES: [u32; 9] = [1, 2, 4, 8, 16, 32, 64, 128, 256];

/// Deepest bound along a ray through which flights are followed one by one.
pub(crate) const MOST_DEPTHS: f64 = 1e4;

/// Accuracy of each element of the reference, where a density has no integral: fractal noise, for
/// each digit of which a ray takes a multiple of elements.
const TOLERANCE: f64 = 1e-9;

/// Pieces of a ray whose smooth parts are unknown.
const PIECES: usize = 64;

/// A ray through heterogeneous media.
pub struct RayThroughMedia<'s> {
    /// Pixel of the smaller image.
    pub pixel: [usize; 2],
    /// Extinction along it, of what varies.
    pub profile: Profile<'s>,
    /// Its optical depth.
    pub depth: f64,
    /// Error bound of the depth.
    pub depth_error: f64,
    /// The media that vary on it.
    pub parts: Vec<MediumOnRay<'s>>,
}

/// A heterogeneous medium on a ray.
pub struct MediumOnRay<'s> {
    /// Its number in the scene.
    pub medium: usize,
    /// Extinction where its density is 1, per length, in the channel that is followed.
    pub sigma: f64,
    /// Its density.
    pub density: &'s Density,
    /// The ray in the coordinates of the density.
    pub line: DensityLine,
    /// Span of the ray in the box of the density.
    pub span: Span,
}

impl RayThroughMedia<'_> {
    /// True if all that varies is a grid.
    pub(crate) fn is_through_grids(&self) -> bool {
        let mut parts = self.parts.iter();
        parts.all(|part| matches!(part.density.field(), Field::Grid(_)))
    }

    /// Optical depth by the integrals of the densities: in closed form, or cell by cell. Adds what
    /// is looked up to `lookups`.
    ///
    /// # Panics
    ///
    /// If a density has no integral.
    pub(crate) fn depth_by_integrals(&self, lookups: &mut u64) -> f64 {
        let parts = self.parts.iter();
        parts
            .map(|part| part.sigma * part.density.integral(&part.line, part.span, lookups))
            .sum()
    }
}

/// All rays of a smaller image that cross heterogeneous media.
pub struct Crossings<'s> {
    /// Columns and rows of the smaller image.
    pub size: [usize; 2],
    /// The rays.
    pub rays: Vec<RayThroughMedia<'s>>,
    /// Length of a voxel, or of a block of a field that is not a grid, world units.
    pub unit: f64,
    /// Name of the unit.
    pub unit_name: &'static str,
    /// True if the densities have jumps.
    pub jumps: bool,
    /// True if they have kinks, as interpolated ones do.
    pub kinks: bool,
    /// True if they have detail finer than any step here, as noise of many octaves does: then no
    /// step is small.
    pub rough: bool,
    /// Extinction at the ends of rays.
    pub ends: Ends,
}

/// Comparison of the extinctions at both ends of rays: a rule that looks at one end of a step only
/// is off by half a step's worth of their difference, to first order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// The same: such a rule is as good as one that looks at both.
    Same,
    /// Nearly the same: such a rule comes to its order only where steps are very fine.
    Alike,
    /// Different.
    Different,
}

/// Differences of the ends below this share of the mean extinction are small.
const ALIKE: f64 = 0.2;

impl Ends {
    fn of(rays: &[RayThroughMedia<'_>]) -> Ends {
        let (mut difference, mut mean) = (0.0, 0.0);
        for ray in rays {
            let Span { near, far } = ray.profile.span();
            difference += (ray.profile.at(near) - ray.profile.at(far)).abs();
            mean += ray.depth / (far - near);
        }
        match difference {
            0.0 => Ends::Same,
            _ if difference < ALIKE * mean => Ends::Alike,
            _ => Ends::Different,
        }
    }
}

/// Crossings of the media of `around`, for an image of `size` pixels in full; `None` if nothing
/// varies.
pub fn crossings<'s>(
    around: &'s SceneContext<'s, Everything>,
    size: [usize; 2],
) -> Option<Crossings<'s>> {
    let (scene, media) = (around.radiative, &around.media);
    let first = media.all().iter().find_map(|medium| medium.density)?;
    let densities = || media.all().iter().filter_map(|medium| medium.density);
    let side = if densities().all(|density| density.is_integrable()) {
        SIDE
    } else {
        SIDE_WITHOUT_INTEGRAL
    };
    let size = thumbnail::thumbnail(size, side);
    let blocks = first.blocks();
    let (unit, unit_name) = match first.field() {
        Field::Grid(grid) => (grid.grid().lattice().voxel(), "voxels"),
        _ => (blocks.bounds().size().max_element() / 32.0, "blocks"),
    };
    let jumps = densities().any(|density| match density.field() {
        Field::Grid(grid) => grid.interpolation() == Interpolation::Nearest,
        _ => false,
    });
    let kinks = densities().any(|density| {
        matches!(
            density.field(),
            Field::Grid(_) | Field::Linear(_) | Field::Noise(_)
        )
    });
    let finest = STEPS[STEPS.len() - 1] * unit;
    let rough = densities().any(|density| match density.field() {
        Field::Noise(noise) => detail(noise.parameters()) < FINE * finest,
        _ => false,
    });
    let collocation = Collocation::new();
    let rays: Vec<RayThroughMedia<'s>> = thumbnail::rays(&scene.camera, size)
        .into_par_iter()
        .enumerate()
        .filter_map(|(index, ray)| {
            let pixel = [index % size[0], index / size[0]];
            crossing(around, &collocation, pixel, ray)
        })
        .collect();
    // A length of the field in world units, as it lies in the scene.
    let unit = match rays.first().and_then(|ray| ray.parts.first()) {
        Some(part) => unit / part.line.direction.length(),
        None => unit,
    };
    (!rays.is_empty()).then_some(Crossings {
        ends: Ends::of(&rays),
        size,
        rays,
        unit,
        unit_name,
        jumps,
        kinks,
        rough,
    })
}

/// Ratio of a length to a step that is small against it.
const FINE: f64 = 16.0;

/// The edge of the smallest cells of noise, in its own coordinates.
fn detail(noise: &FractalParameters) -> f64 {
    let octaves = powu(noise.lacunarity.max(1.0), noise.octaves - 1);
    1.0 / (noise.scale.abs().max_element() * octaves)
}

/// Media that `ray` crosses before it meets a surface.
fn crossing<'s>(
    around: &'s SceneContext<'s, Everything>,
    collocation: &Collocation,
    pixel: [usize; 2],
    ray: Ray,
) -> Option<RayThroughMedia<'s>> {
    let media = &around.media;
    let pieces = heterogeneous_pieces(around, &ray);
    let first = pieces.first()?.1;
    let set = pieces.iter().fold(0, |all, (_, set)| all | set);
    // The channel in which most is taken away.
    let sigma: DVec3 = members(set)
        .map(|index| media.medium(index).sigma_t())
        .sum();
    let channel = (0..3)
        .max_by(|&a, &b| sigma[a].total_cmp(&sigma[b]))
        .unwrap_or(0);
    if sigma[channel] == 0.0 {
        return None;
    }
    let (parts, kinks) = media_on_ray(media, &pieces, &ray, channel);
    let profile = Profile {
        segments: bounded_segments(media, &pieces, &ray, channel),
        kinks,
        // As many lookups at every place, or a number that is not known.
        densities: match pieces.iter().all(|(_, set)| *set == first) {
            true => members(first).count(),
            false => 0,
        },
        extinction: extinction(media, pieces, ray, channel),
    };
    let mut crossing = RayThroughMedia {
        pixel,
        profile,
        depth: 0.0,
        depth_error: 0.0,
        parts,
    };
    if crossing
        .parts
        .iter()
        .all(|part| part.density.is_integrable())
    {
        crossing.depth = crossing.depth_by_integrals(&mut 0);
        // A sum of some hundred terms, compensated.
        crossing.depth_error = crossing.depth * 1e-15;
    } else {
        let profile = &crossing.profile;
        let light = collocation.light(&profile.cuts(), TOLERANCE, |t| LocalProperties {
            extinction: profile.at(t),
            emission: DVec3::ZERO,
        });
        (crossing.depth, crossing.depth_error) = (light.depth, light.depth_error);
    }
    Some(crossing)
}

/// Segments of `ray` that follow one another, from the first with a heterogeneous medium on, and
/// the heterogeneous media there.
fn heterogeneous_pieces(around: &SceneContext<'_, Everything>, ray: &Ray) -> Vec<(Span, Set)> {
    let media = &around.media;
    let nearest = around.intersect(ray, &mut Uncounted);
    let end = nearest.map_or(f64::INFINITY, |nearest| nearest.hit.t);
    let mut segments = MediumSegments::default();
    segments.build::<Everything>(media, ray, end);
    let sets = segments.all().iter();
    let sets = sets.map(|segment| (segment.span, media.heterogeneous(segment.set)));
    let mut pieces: Vec<(Span, Set)> = sets
        .skip_while(|(_, set)| *set == 0)
        .take_while(|(_, set)| *set != 0)
        .collect();
    let gap = |pair: &[(Span, Set)]| pair[0].0.far != pair[1].0.near;
    if let Some(before) = pieces.windows(2).position(gap) {
        pieces.truncate(before + 1);
    }
    pieces
}

/// Segments of `ray` over `pieces`, with bounds on the extinction in `channel`.
fn bounded_segments(
    media: &Media<'_>,
    pieces: &[(Span, Set)],
    ray: &Ray,
    channel: usize,
) -> Vec<BoundedSegment> {
    let mut segments = Vec::new();
    let mut heterogeneous = Vec::new();
    for (span, set) in pieces {
        let majorants = RayMajorants::new(media, *set, ray, *span, &mut heterogeneous);
        segments.extend(majorants.map(|segment| BoundedSegment {
            span: segment.span,
            low: segment.minorant[channel],
            high: segment.majorant[channel],
        }));
    }
    segments
}

/// The media of `pieces` on `ray`, and the points between which their densities are smooth.
fn media_on_ray<'s>(
    media: &'s Media<'s>,
    pieces: &[(Span, Set)],
    ray: &Ray,
    channel: usize,
) -> (Vec<MediumOnRay<'s>>, Vec<f64>) {
    let (mut parts, mut kinks) = (Vec::new(), Vec::new());
    let each = pieces.iter();
    for (piece, index) in each.flat_map(|(span, set)| members(*set).map(move |m| (*span, m))) {
        let medium = media.medium(index);
        let density = medium.density.expect("it varies");
        let Some((line, span)) = density.along(ray, piece) else {
            continue;
        };
        density.append_kinks(&line, span, &mut kinks);
        kinks.extend([span.near, span.far]);
        if !density.is_integrable() {
            let cut = |index: usize| span.near + span.length() * index as f64 / PIECES as f64;
            kinks.extend((1..PIECES).map(cut));
        }
        parts.push(MediumOnRay {
            medium: index,
            sigma: medium.sigma_t()[channel],
            density,
            line,
            span,
        });
    }
    (parts, kinks)
}

/// Extinction of the media of `pieces` along `ray`, in `channel`.
fn extinction<'s>(
    media: &'s Media<'s>,
    pieces: Vec<(Span, Set)>,
    ray: Ray,
    channel: usize,
) -> Extinction<'s> {
    Box::new(move |t, lookups| {
        let inside = pieces
            .iter()
            .find(|(span, _)| span.near <= t && t <= span.far);
        let set = inside.map_or(0, |(_, set)| *set);
        members(set).fold(0.0, |sum, index| {
            let medium = media.medium(index);
            let density = medium.density.expect("it varies");
            sum + medium.sigma_t()[channel] * density.at(ray.at(t), lookups)
        })
    })
}

/// Transmittance of the rays of `crossings`, by rule, jitter and chance; random numbers from
/// `seed`.
pub fn study(crossings: &Crossings<'_>, seed: u64, clock: &Clock) -> Study {
    let right: Vec<f64> = crossings.rays.iter().map(|ray| exp(-ray.depth)).collect();
    let scale = root_mean_square(right.iter().copied());
    let error = |ray: &RayThroughMedia<'_>| exp(-ray.depth) * ray.depth_error;
    let bound = crossings.rays.iter().map(error).fold(0.0, f64::max) / scale;
    let bound = bound.max(1e-15);
    let asked = Asked {
        crossings,
        right,
        seed,
    };
    let mut planned: Vec<PlannedSweep<'_>> = StepRule::all().map(|rule| asked.by_rule(rule)).into();
    planned.extend([Scheme::Comb, Scheme::Stratified].map(|scheme| asked.by_jitter(scheme)));
    let deepest = crossings
        .rays
        .iter()
        .map(|ray| ray.profile.majorant_depth());
    let is_dense = deepest.fold(0.0, f64::max) > MOST_DEPTHS;
    if !is_dense {
        planned.extend(TransmittanceEstimator::ALL.map(|estimator| asked.by_chance(estimator)));
    }
    let exact = crossings.rays.iter().all(RayThroughMedia::is_through_grids);
    if exact {
        planned.push(asked.cell_by_cell());
    }
    let method = match exact {
        true => "Gaussian quadrature per cell, exact up to rounding",
        false => "closed forms, or collocation at Gauss points, halved until its parts agree",
    };
    let truth = Truth {
        method: method.to_owned(),
        scale,
        bound,
        judged: None,
    };
    let [width, height] = crossings.size;
    let quantity = format!(
        "transmittance of the heterogeneous media along the {} rays of {width} × {height} pixels that \
         cross them",
        crossings.rays.len()
    );
    let judged_on = match (crossings.rough, is_dense) {
        (true, _) => {
            Some("no order is expected: the noise has detail finer than any step tested".to_owned())
        }
        (_, true) => Some(format!(
            "tracking was left out: bounds of more than {MOST_DEPTHS} optical depths take as many \
             lookups"
        )),
        _ => None,
    };
    Study {
        judged_on,
        ..Study::of("transmittance", quantity, truth, &planned, clock)
    }
}

/// The rays, their true transmittance, and a seed.
struct Asked<'c, 's> {
    crossings: &'c Crossings<'s>,
    right: Vec<f64>,
    seed: u64,
}

impl Asked<'_, '_> {
    /// Estimates the transmittance of every ray.
    fn run<'a>(
        &'a self,
        estimate: impl Fn(&RayThroughMedia<'_>, usize, &mut Counters) -> f64 + Send + Sync + 'a,
    ) -> SettingRun<'a> {
        Box::new(move || {
            SettingOutcome::of_rays(self.right.len(), &|index, work| {
                let value = estimate(&self.crossings.rays[index], index, work);
                Some([value - self.right[index]])
            })
        })
    }

    /// A sweep of the step along the rays, whose order is `expected` if anything is.
    fn by_step<'a>(
        &'a self,
        estimator: &str,
        expected: Option<f64>,
        run: impl Fn(f64) -> SettingRun<'a>,
    ) -> PlannedSweep<'a> {
        let Crossings {
            unit, unit_name, ..
        } = self.crossings;
        let setting = |units: f64| {
            let step = units * unit;
            Setting::new(format!("{units} {unit_name}"), step, run(step))
        };
        PlannedSweep {
            estimator: estimator.to_owned(),
            is_ours: false,
            parameter: Parameter::Step,
            expected: expected.map_or(ExpectedOrder::NOTHING, ExpectedOrder::of_step),
            settings: STEPS.map(setting).into(),
        }
    }

    fn by_rule(&self, rule: StepRule) -> PlannedSweep<'_> {
        let crossings = self.crossings;
        let like = match rule {
            StepRule::Left if crossings.ends == Ends::Same => StepRule::Trapezoid,
            _ => rule,
        };
        let expected = match crossings.kinks {
            true => like.order_with_kinks(crossings.jumps),
            false => like.order(),
        };
        let rough = crossings.rough || rule == StepRule::Left && crossings.ends == Ends::Alike;
        self.by_step(rule.name(), (!rough).then_some(expected), |step| {
            self.run(move |ray, _, work| {
                let (depth, lookups) = rule.depth(&ray.profile, step);
                work.count_times(Event::DensityLookup, lookups);
                exp(-depth)
            })
        })
    }

    fn by_jitter(&self, scheme: Scheme) -> PlannedSweep<'_> {
        let crossings = self.crossings;
        let stratified = scheme == Scheme::Stratified;
        let expected = match stratified {
            _ if crossings.jumps => 1.0,
            false if crossings.ends == Ends::Same => 2.0,
            _ => scheme.order(),
        };
        let rough = crossings.rough || !stratified && crossings.ends == Ends::Alike;
        self.by_step(scheme.name(), (!rough).then_some(expected), |step| {
            self.run(move |ray, index, work| {
                let stream = Stream::new(self.seed, index as u32, 0);
                let steps = Steps::over(ray.profile.span(), step);
                let (mut depth, mut lookups) = (0.0, 0);
                for number in 0..steps.count() {
                    let (middle, length) = steps.sample(number);
                    let number = if stratified { number as u32 } else { 0 };
                    let offset = stream.uniform(0, Purpose::Tracking, number) - 0.5;
                    let t = middle + offset * length;
                    depth += length * (ray.profile.extinction)(t, &mut lookups);
                }
                let draws = if stratified { steps.count() as u64 } else { 1 };
                work.count_times(Event::DensityLookup, lookups);
                work.count_times(Event::RandomDraw, draws);
                exp(-depth)
            })
        })
    }

    fn by_chance(&self, estimator: TransmittanceEstimator) -> PlannedSweep<'_> {
        let setting = |count: u32| {
            let run = self.run(move |ray, index, work| {
                let mut sum = 0.0;
                // Powers of two: no setting shares an estimate with another.
                for number in count..2 * count {
                    let stream = Stream::new(self.seed, index as u32, number);
                    let sample = estimator.sample(&ray.profile, &stream);
                    sum += sample.value;
                    work.count_times(Event::DensityLookup, sample.lookups);
                    work.count_times(Event::RandomDraw, sample.draws);
                }
                sum / f64::from(count)
            });
            let noun = if count == 1 { "estimate" } else { "estimates" };
            Setting::new(format!("{count} {noun}"), f64::from(count), run)
        };
        PlannedSweep {
            estimator: estimator.name().to_owned(),
            is_ours: estimator == TransmittanceEstimator::ResidualRatio,
            parameter: Parameter::Samples,
            expected: ExpectedOrder::OF_SAMPLES,
            settings: ESTIMATES.map(setting).into(),
        }
    }

    fn cell_by_cell(&self) -> PlannedSweep<'_> {
        let run = self.run(|ray, _, work| {
            let mut lookups = 0;
            let depth = ray.depth_by_integrals(&mut lookups);
            work.count_times(Event::DensityLookup, lookups);
            exp(-depth)
        });
        PlannedSweep {
            estimator: "Gauss, 2 points a cell".to_owned(),
            is_ours: true,
            parameter: Parameter::None,
            expected: ExpectedOrder::NOTHING,
            settings: vec![Setting::new("cell by cell".to_owned(), 0.0, run)],
        }
    }
}

//! Work predicted before it is done: from the geometry of rays, steps and cells, without any
//! density lookup.

use super::classified::several::gradients_computed;
use super::classified::steps::Steps;
use super::classified::volume_shadow::shadow_ray;
use super::counters::{Event, Uncounted};
use super::plan::{FieldKind, Kernel, Plan, RadiativeFeatures, RayCasterFeatures};
use super::radiative::media::tracked;
use super::radiative::scene_context::SceneContext;
use super::radiative::{effects::Everything, segments::MediumSegments};
use crate::conventions::kept;
use crate::geometry::{Camera, Ray, Solid, Span, length_of};
use crate::math::Moments;
use crate::optics::{Density, Field};
use crate::scene::{
    Classified, Compositing, Conventions, Mode, Panel, Projected, Projection, Radiative, Sampling,
};
use crate::volume::{GridDensity, Interpolation};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt;

/// Predicted work and memory of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedWork {
    /// Rays from the eye.
    pub rays: u64,
    /// Units of work of the whole image; counts of events not in the list cannot be predicted.
    pub work: Vec<(Event, Amount)>,
    /// Memory beside the scene and the image.
    pub memory: Vec<Memory>,
}

impl PredictedWork {
    /// The predicted count of `event`; `None` if it cannot be predicted.
    pub fn of(&self, event: Event) -> Option<Amount> {
        let mut known = self.work.iter().filter(|(known, _)| *known == event);
        known.next().map(|(_, amount)| *amount)
    }
}

/// A number of units of work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amount {
    /// Relation to the measured count.
    pub bound: Bound,
    /// The number.
    pub count: u64,
}

/// Relation of a predicted count to the measured one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Equal.
    Exactly,
    /// Equal or larger.
    AtMost,
    /// Equal or smaller.
    AtLeast,
    /// Near: extrapolated from some of the rays of a large image.
    About,
    /// Equal, larger or near: extrapolated from some of the rays of a large image.
    AboutAtMost,
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Bound::Exactly => "exactly",
            Bound::AtMost => "at most",
            Bound::AtLeast => "at least",
            Bound::About => "about",
            Bound::AboutAtMost => "about at most",
        })
    }
}

/// Memory of data computed for an image and kept while it is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Memory {
    /// Its contents.
    pub what: &'static str,
    /// Its size.
    pub bytes: usize,
}

/// The one that holds pixels.
const MOMENTS: &str = "moments of the samples";

/// Rays that a prediction looks at: those of an image of 256 × 256 pixels.
const MOST_RAYS: usize = 1 << 16;

/// Samples whose shadow rays a prediction looks at; beyond, each is taken to be the longest.
const MOST_SAMPLES: u64 = 1 << 26;

impl Plan<'_> {
    /// The work and memory of the image with `sampling`, as far as closed forms exist.
    pub fn predicted_work(&self, sampling: Sampling) -> PredictedWork {
        let pixels = (self.panel.width * self.panel.height) as u64;
        let rays = pixels.saturating_mul(self.samples(sampling).into());
        let nothing = |event: &Event| !self.may_do(*event);
        let nothing = Event::ALL.into_iter().filter(nothing);
        let mut work: Vec<_> = nothing.map(|event| (event, exactly(0))).collect();
        let known = match self.kernel {
            Kernel::Curve(_) | Kernel::Background(_) => vec![],
            Kernel::Field(scene) if scene.conventions == Conventions::default() => {
                of_field(self.panel, scene)
            }
            // Each convention has samples of its own.
            Kernel::Conventional(scene) | Kernel::Field(scene) => vec![
                (Event::NullCollision, exactly(0)),
                (Event::CellWalked, exactly(0)),
                (
                    Event::RandomDraw,
                    exactly(if scene.conventions.is_random() {
                        rays
                    } else {
                        0
                    }),
                ),
            ],
            // Steps that are transparent, and those behind surfaces, are known from lookups alone.
            Kernel::Several(scene) => vec![
                (Event::NullCollision, exactly(0)),
                (Event::CellWalked, exactly(0)),
                (Event::RandomDraw, exactly(0)),
                (Event::GradientComputed, exactly(gradients_computed(scene))),
            ],
            Kernel::Integral(scene) => of_integrals(self.panel, scene),
            Kernel::RayCaster { scene, features } => of_casting(self.panel, scene, features),
            Kernel::LineOfSight {
                scene,
                features,
                scatters,
            } => of_lines(self.panel, scene, features, scatters),
            Kernel::PathTracer { scene, .. } => of_paths(scene, rays),
        };
        work.extend(known.into_iter().filter(|(event, _)| self.may_do(*event)));
        work.sort_by_key(|(event, _)| *event as usize);
        PredictedWork {
            rays,
            work,
            memory: self.memory(),
        }
    }

    /// Whether any work of this kind is done: some effect that does it is simulated, or is omitted
    /// in part only. Up to a limit, light is scattered more than once; and a scattering medium
    /// attenuates light from behind even where in-scattering is omitted.
    pub fn may_do(&self, event: Event) -> bool {
        let in_part = match (event, self.kernel) {
            (Event::FurtherScattering, Kernel::PathTracer { max_order, .. }) => {
                max_order >= Some(2)
            }
            (
                Event::Attenuation,
                Kernel::LineOfSight { features, .. } | Kernel::PathTracer { features, .. },
            ) => features.media,
            // Where heterogeneity was forced: the code for heterogeneous media, along the line of
            // sight, evaluates every phase function.
            (
                Event::PhaseEvaluation,
                Kernel::LineOfSight {
                    features, scatters, ..
                },
            ) => scatters && features.heterogeneous,
            // Where nothing scatters light, and multiple scattering was forced.
            (Event::FirstScattering, Kernel::LineOfSight { scatters, .. }) => scatters,
            // Where the volume is transparent, and an effect was forced.
            (Event::DensityLookup, Kernel::RayCaster { features, .. }) => {
                features.field != FieldKind::Constant
            }
            (Event::Attenuation | Event::EmissionTerm, Kernel::RayCaster { .. }) => true,
            (Event::DensityLookup | Event::CellWalked, Kernel::Integral(scene)) => {
                scene.each_alone().any(|alone| {
                    let (least, most) = alone.grid.range();
                    least != most
                })
            }
            (Event::Attenuation | Event::EmissionTerm, Kernel::Integral(_)) => true,
            _ => false,
        };
        in_part || event.effects().iter().any(|&effect| self.is_on(effect))
    }

    /// Memory kept beside the pixels of the image: nothing that only an omitted effect needs.
    pub(super) fn made_beside(&self) -> Vec<Memory> {
        let mut memory = self.memory();
        memory.retain(|memory| memory.what != MOMENTS);
        memory
    }

    /// Memory allocated for the image: nothing that only an omitted effect needs.
    fn memory(&self) -> Vec<Memory> {
        let mut memory = Vec::new();
        let mut add = |what, bytes| memory.push(Memory { what, bytes });
        match self.kernel {
            Kernel::RayCaster { scene, features } => {
                let lattice = scene.grid.lattice();
                if features.shading {
                    add(
                        "gradients of the nodes",
                        lattice.node_count() * size_of::<[f32; 3]>(),
                    );
                }
                if features.skip_empty {
                    add(
                        "distances to non-empty blocks",
                        super::classified::empty_space::bytes(lattice),
                    );
                }
            }
            Kernel::Several(scene) => {
                let nodes = gradients_computed(scene) as usize;
                if nodes > 0 {
                    add("gradients of the nodes", nodes * size_of::<[f32; 3]>());
                }
            }
            Kernel::Conventional(scene) => {
                let nodes = scene.grid.lattice().node_count();
                if scene.phong.is_some() && scene.conventions.gradient.is_stored() {
                    add("gradients of the nodes", nodes * size_of::<[f32; 3]>());
                }
                if scene.conventions.preclassified {
                    add(
                        "opacities and colours of the nodes",
                        nodes * size_of::<[f32; 4]>(),
                    );
                }
            }
            Kernel::Field(scene) => {
                if scene.phong.is_some() {
                    let nodes = scene.grid.lattice().node_count();
                    add("gradients of the nodes", nodes * size_of::<[f32; 3]>());
                }
            }
            Kernel::PathTracer { scene, .. } => {
                let bytes = tracked(&scene.media).map(Density::bytes_for_blocks).sum();
                if bytes > 0 {
                    add("majorants of densities", bytes);
                }
                let pixels = self.panel.width * self.panel.height;
                add(MOMENTS, pixels * size_of::<[Moments; 3]>());
            }
            Kernel::Curve(_)
            | Kernel::Background(_)
            | Kernel::Integral(_)
            | Kernel::LineOfSight { .. } => {}
        }
        memory
    }
}

fn of_casting(
    panel: &Panel,
    scene: &Classified,
    features: RayCasterFeatures,
) -> Vec<(Event, Amount)> {
    let RayCasterFeatures {
        field,
        compositing,
        shadow,
        skip_empty,
        ..
    } = features;
    let early = matches!(compositing, Compositing::EarlyTermination(_));
    let of_ray = |ray: &Ray| {
        let samples = samples(scene, ray);
        let shadow_samples = if shadow { shadow_steps(scene, ray) } else { 0 };
        [samples, shadow_samples]
    };
    let (part, [samples, shadow_samples]) = over_rays(panel, scene.camera, of_ray);
    let relation = match (skip_empty || early, part) {
        (false, false) => Bound::Exactly,
        (false, true) => Bound::About,
        (true, false) => Bound::AtMost,
        (true, true) => Bound::AboutAtMost,
    };
    // A sample without opacity casts no shadow ray, nor does one at the light's position.
    let at_most = if part {
        Bound::AboutAtMost
    } else {
        Bound::AtMost
    };
    let lookups = match field {
        FieldKind::Constant => exactly(0),
        _ if shadow_samples == 0 => amount(relation, samples),
        _ => amount(at_most, samples.saturating_add(shadow_samples)),
    };
    let cells = if skip_empty {
        amount(at_most, samples.saturating_add(shadow_samples))
    } else {
        exactly(0)
    };
    vec![
        (Event::DensityLookup, lookups),
        (Event::NullCollision, exactly(0)),
        (Event::CellWalked, cells),
        (Event::RandomDraw, exactly(0)),
        (Event::Attenuation, amount(relation, samples)),
        (Event::EmissionTerm, amount(at_most, samples)),
        (Event::GradientLookup, amount(at_most, samples)),
        (
            Event::GradientComputed,
            exactly(scene.grid.lattice().node_count() as u64),
        ),
        (Event::ShadowRay, amount(at_most, samples)),
    ]
}

fn of_integrals(panel: &Panel, scene: &Classified) -> Vec<(Event, Amount)> {
    let field = |alone: Classified| {
        let field = GridDensity::new(alone.grid.clone(), alone.interpolation);
        (alone.extent(), field)
    };
    let fields: Vec<_> = scene.each_alone().map(field).collect();
    let cells = |ray: &Ray| {
        let cells = fields.iter().map(|(extent, field)| {
            let span = extent.span(ray);
            span.map_or(0, |span| {
                field.cubic_segments(extent.line(ray), span).count()
            })
        });
        [cells.sum::<usize>() as u64, 0]
    };
    let (part, [cells, _]) = over_rays(panel, scene.camera, cells);
    // Behind what is opaque no cell is looked at.
    let cells = amount(
        if part {
            Bound::AboutAtMost
        } else {
            Bound::AtMost
        },
        cells,
    );
    vec![
        (Event::DensityLookup, cells),
        (Event::NullCollision, exactly(0)),
        (Event::CellWalked, cells),
        (Event::RandomDraw, exactly(0)),
    ]
}

/// Samples or cells, each looked up once: none is left out.
fn of_field(panel: &Panel, scene: &Classified) -> Vec<(Event, Amount)> {
    let field = GridDensity::new(scene.grid.clone(), scene.interpolation);
    let extent = scene.extent();
    let span_of = |ray: &Ray| kept(extent.span(ray)?, f64::INFINITY, ray, scene.clips_of(0));
    let cells = |ray: &Ray| {
        let span = span_of(ray).filter(|span| span.length() > 0.0);
        let cells = span.map(|span| field.cubic_segments(extent.line(ray), span).count());
        cells.unwrap_or(0) as u64
    };
    let is_exact = scene.is_exact();
    let of_ray = |ray: &Ray| match is_exact {
        true => [cells(ray), 0],
        false => {
            let span = span_of(ray);
            let count = span.map_or(0, |span| Steps::over(span, scene.step).count());
            [count as u64, 0]
        }
    };
    let (part, [lookups, _]) = over_rays(panel, scene.camera, of_ray);
    let bound = if part { Bound::About } else { Bound::Exactly };
    let lookups = amount(bound, lookups);
    let nodes = scene.grid.lattice().node_count() as u64;
    // The others have no exponential, or one for each surface.
    let attenuations = match &scene.mode {
        Mode::Projection(Projection { of, .. }) => match of {
            Projected::AttenuatedMaximum(_) if !is_exact => Some(lookups),
            Projected::AttenuatedMaximum(_) => None,
            _ => Some(exactly(0)),
        },
        _ => None,
    };
    let mut work = vec![
        (Event::DensityLookup, lookups),
        (Event::NullCollision, exactly(0)),
        (
            Event::CellWalked,
            if is_exact { lookups } else { exactly(0) },
        ),
        (Event::RandomDraw, exactly(0)),
        (Event::GradientComputed, exactly(nodes)),
    ];
    work.extend(attenuations.map(|amount| (Event::Attenuation, amount)));
    work
}

fn of_lines(
    panel: &Panel,
    scene: &Radiative,
    features: RadiativeFeatures,
    scatters: bool,
) -> Vec<(Event, Amount)> {
    let rays = (panel.width * panel.height) as u64;
    let context = SceneContext::<Everything>::for_integrals(scene, false);
    let surfaces = surfaces(scene) * rays;
    let tests = if scatters {
        Bound::AtLeast
    } else {
        Bound::Exactly
    };
    let mut work = vec![
        (Event::CellWalked, exactly(0)),
        (Event::NullCollision, exactly(0)),
        (Event::RandomDraw, exactly(0)),
        (Event::SurfaceTest, amount(tests, surfaces)),
    ];
    if !scatters && features.media && !features.emission {
        work.push((Event::Attenuation, exactly(rays)));
        work.push((Event::ChannelAttenuation, exactly(2 * rays)));
    }
    if !scatters && features.heterogeneous {
        let of_ray = |ray: &Ray| line_lookups(&context, ray, features.emission);
        let (part, [lookups, unknown]) = over_rays(panel, scene.camera, of_ray);
        if unknown > 0 {
            return work;
        }
        let bound = if part { Bound::About } else { Bound::Exactly };
        work.push((Event::DensityLookup, amount(bound, lookups)));
    }
    work
}

/// Samples of the eye's ray.
fn samples(scene: &Classified, ray: &Ray) -> u64 {
    let span = scene.extent().span(ray);
    span.map_or(0, |span| Steps::over(span, scene.step).count() as u64)
}

/// Samples of the shadow rays of all samples of the eye's ray.
fn shadow_steps(scene: &Classified, ray: &Ray) -> u64 {
    let Some(shadow) = scene.shadow else {
        return 0;
    };
    let extent = scene.extent();
    let Some(span) = extent.span(ray) else {
        return 0;
    };
    let steps = Steps::over(span, scene.step);
    if steps.count() as u64 > MOST_SAMPLES / MOST_RAYS as u64 {
        let longest = Steps::over(
            Span::new(0.0, length_of(extent.world_bounds().size())),
            shadow.step,
        );
        return (steps.count() as u64).saturating_mul(longest.count() as u64);
    }
    let of_sample = |index| {
        let sample = ray.at(steps.sample(index).0);
        shadow_ray(sample, scene.light, &extent)
            .map_or(0, |(_, span)| Steps::over(span, shadow.step).count() as u64)
    };
    (0..steps.count()).map(of_sample).sum()
}

/// Lookups for the optical depth along `ray` up to the nearest surface and, with `emission`, for
/// the emission of its media; and the number of segments whose lookups are not known.
fn line_lookups(context: &SceneContext<'_, Everything>, ray: &Ray, emission: bool) -> [u64; 2] {
    let nearest = context.intersect(ray, &mut Uncounted);
    let end = nearest.map_or(f64::INFINITY, |nearest| nearest.hit.t);
    let mut lookups = 0;
    let mut spans = Vec::new();
    for medium in context
        .media
        .all()
        .iter()
        .filter(|medium| !medium.is_vacuum())
    {
        let (Some(density), Some(boundary)) = (medium.density, medium.boundary) else {
            continue;
        };
        spans.clear();
        boundary.append_spans(ray, &mut spans);
        for &Span { near, far } in spans.iter().filter(|span| span.near < end) {
            let span = Span {
                near,
                far: far.min(end),
            };
            lookups += cell_lookups(density, ray, span);
        }
    }
    let mut unknown = 0;
    if emission {
        let mut segments = MediumSegments::default();
        segments.build::<Everything>(&context.media, ray, end);
        for segment in segments.all() {
            if context.media.heterogeneous(segment.set) == 0 {
                continue;
            }
            let medium = context.media.medium(segment.set.trailing_zeros() as usize);
            match (segment.set.count_ones(), medium.density) {
                (1, Some(density)) => lookups += cell_lookups(density, ray, segment.span),
                _ => unknown += 1,
            }
        }
    }
    [lookups, unknown]
}

/// Lookups for the integral of `density` along `ray` over `span`: two in each cell crossed of a
/// trilinear grid, one of a grid of nearest nodes, none of what has a closed form.
fn cell_lookups(density: &Density, ray: &Ray, span: Span) -> u64 {
    let Field::Grid(grid) = density.field() else {
        return 0;
    };
    let Some((line, span)) = density.along(ray, span) else {
        return 0;
    };
    let cells = grid
        .smooth_segments(line.origin, line.direction, span)
        .count() as u64;
    match grid.interpolation() {
        Interpolation::Trilinear => 2 * cells,
        Interpolation::Nearest => cells,
    }
}

fn of_paths(scene: &Radiative, rays: u64) -> Vec<(Event, Amount)> {
    vec![
        // The position in the pixel.
        (
            Event::RandomDraw,
            amount(Bound::AtLeast, rays.saturating_mul(2)),
        ),
        (
            Event::SurfaceTest,
            amount(Bound::AtLeast, rays.saturating_mul(surfaces(scene))),
        ),
    ]
}

fn surfaces(scene: &Radiative) -> u64 {
    (scene.objects.len() + scene.area_lights.len()) as u64
}

/// The sums of `of_ray` over the rays through the pixels, for a large image extrapolated from some
/// of them; and whether they are extrapolated.
fn over_rays(
    panel: &Panel,
    camera: Camera,
    of_ray: impl Fn(&Ray) -> [u64; 2] + Sync,
) -> (bool, [u64; 2]) {
    let size = [panel.width, panel.height];
    let mut stride = 1;
    while size
        .map(|side| side.div_ceil(stride))
        .iter()
        .product::<usize>()
        > MOST_RAYS
    {
        stride += 1;
    }
    let rows: Vec<usize> = (0..panel.height).skip(stride / 2).step_by(stride).collect();
    let columns = || (0..panel.width).skip(stride / 2).step_by(stride);
    let looked_at = rows.len() * columns().count();
    let add = |[a, b]: [u64; 2], [c, d]: [u64; 2]| [a.saturating_add(c), b.saturating_add(d)];
    let row = |&row: &usize| {
        let pixels = columns().map(|column| of_ray(&camera.ray([column, row], size)));
        pixels.fold([0, 0], add)
    };
    let sums = rows.par_iter().map(row).reduce(|| [0, 0], add);
    if stride == 1 {
        return (false, sums);
    }
    let share = (panel.width * panel.height) as f64 / looked_at.max(1) as f64;
    (true, sums.map(|sum| (sum as f64 * share) as u64))
}

fn exactly(count: u64) -> Amount {
    amount(Bound::Exactly, count)
}

fn amount(bound: Bound, count: u64) -> Amount {
    Amount { bound, count }
}

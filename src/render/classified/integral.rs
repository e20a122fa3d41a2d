//! The radiance of classified volumes without steps: the volume-rendering integral itself.
//!
//! A ray caster approximates, along a ray through the volumes `i`, as far as clips keep them, and in front of the
//! background or the surface `B` (Max 1995, §4),
//!
//! ```text
//! L = ∫ Σᵢ cᵢ(vᵢ) σᵢ(vᵢ) e^(−τ) dt + B e^(−τ(end)),     τ(t) = ∫₀ᵗ Σᵢ σᵢ(vᵢ) ds
//! ```
//!
//! with `v` the value of a field. The transfer function states the colour `c` of each value,
//! emission included, and the opacity `a` over a length `h₀`; the extinction is `σ = −ln(1 − a)/h₀`.
//! This is what all steps, first samples and last steps lead to as steps become short.
//!
//! Between two faces of cells `v` is a cubic ([`CubicSegment`]), and between two knots of the
//! transfer function `a` and `c` are straight lines or smooth curves of `v`. On a piece between such
//! places, of all volumes together, nothing has a kink, and [`Collocation`] integrates it to a tolerance, with a bound
//! on its own error. Opaque values of several volumes at one place share equally.
//!
//! Source: Max 1995, "Optical models for direct volume rendering".

use super::several::Part;
use crate::geometry::Ray;
use crate::math::{exp_m1, ln};
use crate::optics::collocation::{CollocatedLight, Collocation, LocalProperties};
use crate::render::counters::{Counters, Event};
use crate::render::pixels::{Pixels, each};
use crate::scene::Classified;
use crate::volume::{CubicSegment, GridDensity};
use glam::DVec3;

/// Error of a pixel that is aimed at, relative to the brightest radiance of the scene: a tenth of
/// what an image in 32 bits rounds a pixel by.
///
/// A ray divides it among its pieces. A piece may be halved, and each of its parts then has as much;
/// therefore the bound that a pixel states, not this number, says how far it may be off.
const TOLERANCE: f64 = 1e-8;

/// The integral along a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayIntegral {
    /// Radiance, background included, with the bound on its error; and the optical depth.
    pub light: CollocatedLight,
    /// Number of cells that the ray passes.
    pub cells: u64,
    /// Points at which the transfer function was evaluated.
    pub points: u64,
}

/// Integrates along rays through a scene of one volume or more.
pub struct RayIntegrator<'s> {
    scene: &'s Classified,
    volumes: Vec<Field>,
    /// No radiance of the scene is above this.
    brightest: f64,
    collocation: Collocation,
}

/// A volume and its field.
struct Field {
    part: Part,
    knots: Vec<f64>,
    density: GridDensity,
    /// Least and largest value. A cubic loses the small ones beside large ones, and may leave it.
    range: (f64, f64),
}

/// A segment of the field of one volume.
struct Segment<'f> {
    of: &'f Field,
    cubic: CubicSegment,
}

/// The way of a ray up to a surface, between the cuts.
struct Way<'f> {
    segments: Vec<Vec<Segment<'f>>>,
    cuts: Vec<f64>,
    cells: u64,
}

impl Field {
    fn of(part: Part) -> Field {
        let scene = &part.scene;
        Field {
            knots: scene.transfer_function.knots(),
            density: GridDensity::new(scene.grid.clone(), scene.interpolation),
            range: scene.grid.range(),
            part,
        }
    }

    /// The segments along `ray`, up to `end`.
    fn segments(&self, ray: &Ray, end: f64) -> Vec<Segment<'_>> {
        let Some(span) = self.part.span(ray, end, true) else {
            return vec![];
        };
        let (least, most) = self.range;
        let segment = |cubic| Segment { of: self, cubic };
        if least == most {
            let coefficients = [least, 0.0, 0.0, 0.0];
            return vec![segment(CubicSegment { span, coefficients })];
        }
        let line = self.part.extent.line(ray);
        self.density
            .cubic_segments(line, span)
            .map(segment)
            .collect()
    }
}

impl Segment<'_> {
    /// The value at a distance within it.
    fn value(&self, t: f64) -> f64 {
        let span = self.cubic.span;
        let u = ((t - span.near) - (span.far - t)) / span.length();
        let (least, most) = self.of.range;
        self.cubic.at(u.clamp(-1.0, 1.0)).clamp(least, most)
    }

    fn is_clear(&self, t: f64) -> bool {
        let look = &self.of.part.scene.transfer_function;
        look.reference_opacity(self.value(t)) == 0.0
    }

    /// Extinction, and the radiance of an opaque sample.
    fn look(&self, t: f64) -> (f64, DVec3) {
        let (look, value) = (&self.of.part.scene.transfer_function, self.value(t));
        (
            look.extinction(value),
            look.colour(value) * look.emission(value),
        )
    }
}

impl Way<'_> {
    /// Pieces of the way with the segments over them, those that are transparent left out.
    fn pieces(&self) -> impl Iterator<Item = ([f64; 2], Vec<&Segment<'_>>)> {
        self.cuts.windows(2).filter_map(|piece| {
            let [near, far] = [piece[0], piece[1]];
            let middle = 0.5 * (near + far);
            let over_it = self.segments.iter().filter_map(|segments| {
                let next = segments.partition_point(|it| it.cubic.span.far <= middle);
                let segment = segments.get(next)?;
                (segment.cubic.span.near < middle).then_some(segment)
            });
            // Between knots opacity is a line that is not negative, or rises with the value.
            let is_seen = |it: &&Segment<'_>| ![near, middle, far].iter().all(|&t| it.is_clear(t));
            let seen: Vec<_> = over_it.filter(is_seen).collect();
            (!seen.is_empty()).then_some(([near, far], seen))
        })
    }
}

/// Extinction and emission at a distance, of several volumes.
fn together(
    segments: &[&Segment<'_>],
    source: impl Fn(&Segment<'_>) -> (f64, DVec3),
) -> LocalProperties {
    let mut sum = LocalProperties::with_source(0.0, DVec3::ZERO);
    let (mut opaque, mut shared) = (0, DVec3::ZERO);
    for segment in segments {
        let (extinction, source) = source(segment);
        let one = LocalProperties::with_source(extinction, source);
        if one.extinction == f64::INFINITY {
            opaque += 1;
            shared += one.emission;
        } else {
            sum.extinction += one.extinction;
            sum.emission += one.emission;
        }
    }
    match opaque {
        0 => sum,
        _ => LocalProperties {
            extinction: f64::INFINITY,
            emission: shared / f64::from(opaque),
        },
    }
}

impl<'s> RayIntegrator<'s> {
    /// An integrator of `scene`, without shading, shadow and modulation.
    pub fn new(scene: &'s Classified) -> RayIntegrator<'s> {
        let parts = (0..scene.volume_count()).map(|index| Part::new(scene, index));
        RayIntegrator {
            scene,
            volumes: parts.map(Field::of).collect(),
            brightest: scene.brightest(),
            collocation: Collocation::default(),
        }
    }

    fn way(&self, ray: &Ray, end: f64) -> Way<'_> {
        let of_all = self.volumes.iter().map(|field| field.segments(ray, end));
        let segments: Vec<Vec<Segment<'_>>> = of_all.collect();
        let mut cuts = Vec::new();
        let mut places = Vec::new();
        for segment in segments.iter().flatten() {
            places.clear();
            segment.cubic.cut_at(&segment.of.knots, &mut places);
            cuts.extend(places.iter().map(|&u| segment.cubic.distance(u)));
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let walked = segments
            .iter()
            .filter(|it| it.first().is_some_and(|it| it.of.range.0 != it.of.range.1));
        let cells = walked.map(|segments| segments.len() as u64).sum();
        Way {
            segments,
            cuts,
            cells,
        }
    }

    /// The integral along `ray`.
    pub fn along(&self, ray: &Ray) -> RayIntegral {
        let hit = self.scene.objects.nearest_surface(ray);
        let way = self.way(ray, hit.as_ref().map_or(f64::INFINITY, |(hit, _)| hit.t));
        let behind = match hit {
            None => CollocatedLight {
                radiance: self.scene.background,
                ..CollocatedLight::default()
            },
            Some((hit, surface)) => CollocatedLight {
                radiance: surface.shaded(ray, &hit, self.scene.light),
                depth: f64::INFINITY,
                ..CollocatedLight::default()
            },
        };
        let tolerance = TOLERANCE * self.brightest / way.cuts.len().max(1) as f64;
        let mut light = self.collocation.ray(tolerance, self.brightest);
        let mut points = 0;
        for (piece, segments) in way.pieces() {
            let passes = light.add(piece, |t| {
                points += segments.len() as u64;
                together(&segments, |segment| segment.look(t))
            });
            if !passes {
                break;
            }
        }
        RayIntegral {
            light: light.light().before(&behind),
            cells: way.cells,
            points,
        }
    }

    /// Depth along `ray`: the mean `∫ t dα / α` over the opacity `α`, or where `α` reaches one `half`. Infinite where
    /// there is none.
    pub fn depth(&self, ray: &Ray, half: bool) -> f64 {
        let hit = self.scene.objects.nearest_surface(ray);
        let surface = hit.map(|(hit, _)| hit.t);
        let way = self.way(ray, surface.unwrap_or(f64::INFINITY));
        // The light of matter as bright as it is far away.
        let distances = |piece: &[f64; 2], segments: &[&Segment<'_>], tolerance: f64| {
            let at = |t| together(segments, |segment| (segment.look(t).0, DVec3::splat(t)));
            self.collocation.light(piece, tolerance, at)
        };
        let (half_of_it, mut before) = (ln(2.0), 0.0);
        let pieces: Vec<_> = way.pieces().collect();
        for (piece, segments) in &pieces {
            let depth_to = |t: f64| distances(&[piece[0], t], segments, TOLERANCE).depth;
            let depth = depth_to(piece[1]);
            if half && before + depth >= half_of_it {
                return bisection(*piece, |t| before + depth_to(t) >= half_of_it);
            }
            before += depth;
        }
        let opacity = if surface.is_some() {
            1.0
        } else {
            -exp_m1(-before)
        };
        if half || opacity == 0.0 {
            return surface.unwrap_or(f64::INFINITY);
        }
        let tolerance = TOLERANCE * opacity / way.cuts.len() as f64;
        let mut sum = CollocatedLight {
            radiance: DVec3::splat(surface.unwrap_or(0.0)),
            ..CollocatedLight::default()
        };
        for (piece, segments) in pieces.iter().rev() {
            sum = distances(piece, segments, tolerance * piece[1]).before(&sum);
        }
        sum.radiance.x / opacity
    }
}

/// The pixels of `scene`: radiance, the opacity of the volume in front of the background, and the bound on the error of
/// the radiance.
pub(in crate::render) fn integrate(
    scene: &Classified,
    pixels: &Pixels<'_>,
) -> (Vec<([f32; 4], f64)>, Counters) {
    let integrator = RayIntegrator::new(scene);
    let size = [pixels.width, pixels.height];
    each(pixels, |position, work| {
        let integral = integrator.along(&scene.camera.ray(position, size));
        work.count_times(Event::SurfaceTest, scene.objects.surfaces.len() as u64);
        work.count_times(Event::CellWalked, integral.cells);
        work.count_times(Event::DensityLookup, integral.cells);
        work.count_times(Event::Attenuation, integral.points);
        work.count_times(Event::EmissionTerm, integral.points);
        let light = integral.light;
        let DVec3 { x, y, z } = light.radiance;
        let pixel = [x, y, z, -exp_m1(-light.depth)].map(|value| value as f32);
        (pixel, light.radiance_error)
    })
}

/// The place from which on `is_behind` holds, between the ends of a `piece`.
fn bisection([mut near, mut far]: [f64; 2], is_behind: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (near + far);
        if middle <= near || middle >= far {
            return far;
        }
        if is_behind(middle) {
            far = middle;
        } else {
            near = middle;
        }
    }
}

//! Projections and isosurfaces of a field, without samples or by them.
//!
//! The equations stand in `src/reference/projection.rs` and `src/reference/isosurface.rs`, which sample the field.
//! Without samples nothing is approximated but by rounding: along a ray a trilinear field is a cubic in each cell
//! ([`CubicSegment`]), whose extrema are roots of a quadratic, and whose integral is that of Simpson's rule.
//!
//! - The *attenuated maximum* is `v(t) e^(−μD(t))`, with `v` a cubic between the ends of the window and `D` its
//!   integral: the largest of its values at the ends of such pieces, and where `v' = μ v²`, a polynomial of the sixth
//!   degree ([`sign_changes`]).
//! - An *isosurface* is passed where the field changes its side. Between the turns of a cubic that happens once at
//!   most (Marmitt et al. 2004, there at its extrema, too), and the side is carried from cell to cell: at a face no
//!   passage is lost or counted twice, whatever rounding makes of it.
//!
//! Source: Marmitt et al. 2004, "Fast and accurate ray-voxel intersection techniques for iso-surface ray tracing".

use crate::conventions::{RayCaster, RayWork, kept};
use crate::geometry::{Ray, Span};
use crate::math::{Sum, exp, polynomial, sign_changes};
use crate::render::counters::{Counters, Event};
use crate::scene::{Classified, Isosurface, Isosurfaces, Mode, Projected, Projection, Window};
use crate::volume::{CubicSegment, GridDensity, PlacedBox};

/// The field of a scene along rays.
pub struct ExactField<'s> {
    scene: &'s Classified,
    field: GridDensity,
    extent: PlacedBox,
    /// Least and largest value of the field, which rounding may carry a cubic out of.
    range: (f64, f64),
}

impl<'s> ExactField<'s> {
    /// The field of `scene`.
    pub fn new(scene: &'s Classified) -> ExactField<'s> {
        ExactField {
            scene,
            field: GridDensity::new(scene.grid.clone(), scene.interpolation),
            extent: scene.extent(),
            range: scene.grid.range(),
        }
    }

    /// The pixel that `ray` is seen in, radiance and opacity, coloured by `caster`; and the work of the ray.
    pub(super) fn pixel(
        &self,
        caster: &RayCaster<'_>,
        ray: &Ray,
        work: &mut Counters,
    ) -> ([f32; 4], RayWork) {
        let mut of_ray = RayWork::default();
        let (segments, span) = self.segments(ray);
        work.count_times(Event::CellWalked, segments.len() as u64);
        work.count_times(Event::DensityLookup, segments.len() as u64);
        let pixel = match &self.scene.mode {
            Mode::Composited => unreachable!("composited samples have kernels of their own"),
            Mode::Projection(projection) => {
                let number = self.number(projection, &segments, span);
                caster.of_number(projection, number, &mut of_ray)
            }
            Mode::Isosurfaces(surfaces) => {
                let passed = self.passed(surfaces, &segments);
                caster.of_surfaces(ray, &passed, &[], &mut of_ray)
            }
        };
        (pixel, of_ray)
    }

    /// The number of `ray`; none where it misses the volume.
    pub fn number_along(&self, projection: &Projection, ray: &Ray) -> Option<f64> {
        let (segments, span) = self.segments(ray);
        self.number(projection, &segments, span)
    }

    /// The surfaces that `ray` passes, with their distances, in order.
    pub fn passed_along(&self, surfaces: &Isosurfaces, ray: &Ray) -> Vec<(f64, Isosurface)> {
        self.passed(surfaces, &self.segments(ray).0)
    }

    /// The field along `ray`, and its span in what clips keep of the volume: no segments where it has no length.
    fn segments(&self, ray: &Ray) -> (Vec<CubicSegment>, Span) {
        let clips = self.scene.clips_of(0);
        let span = self.extent.span(ray);
        let span = span.and_then(|whole| kept(whole, f64::INFINITY, ray, clips));
        let span = span.unwrap_or(Span::new(0.0, 0.0));
        if span.length() == 0.0 {
            return (vec![], span);
        }
        let line = self.extent.line(ray);
        (self.field.cubic_segments(line, span).collect(), span)
    }

    fn number(
        &self,
        projection: &Projection,
        segments: &[CubicSegment],
        span: Span,
    ) -> Option<f64> {
        if segments.is_empty() {
            return None;
        }
        let (least, most) = self.range;
        let integral = || {
            let parts = segments.iter().map(CubicSegment::integral);
            parts.collect::<Sum>().value()
        };
        let extremes = segments.iter().map(CubicSegment::extremes);
        Some(match projection.of {
            Projected::Maximum => {
                let largest = extremes.fold(f64::NEG_INFINITY, |most, of| most.max(of[1]));
                largest.clamp(least, most)
            }
            Projected::Minimum => {
                let smallest = extremes.fold(f64::INFINITY, |least, of| least.min(of[0]));
                smallest.clamp(least, most)
            }
            Projected::Mean => (integral() / span.length()).clamp(least, most),
            Projected::Sum => integral(),
            Projected::AttenuatedMaximum(attenuation) => {
                attenuated_maximum(segments, projection.unit(), attenuation)
            }
        })
    }

    fn passed(
        &self,
        isosurfaces: &Isosurfaces,
        segments: &[CubicSegment],
    ) -> Vec<(f64, Isosurface)> {
        let (least, most) = self.range;
        let mut passed = Vec::new();
        for surface in &isosurfaces.surfaces {
            let is_inside =
                |segment: &CubicSegment, u| segment.at(u).clamp(least, most) >= surface.value;
            let Some(first) = segments.first() else {
                continue;
            };
            let mut inside = is_inside(first, -1.0);
            for segment in segments {
                for ends in segment.turns().windows(2) {
                    if is_inside(segment, ends[1]) != inside {
                        inside = !inside;
                        let u = segment.crossing(surface.value, inside, [ends[0], ends[1]]);
                        passed.push((segment.distance(u), *surface));
                    }
                }
            }
        }
        passed.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        passed
    }
}

/// The largest `v e^(−μD)` on the segments.
fn attenuated_maximum(segments: &[CubicSegment], window: Window, attenuation: f64) -> f64 {
    let Window { low, high } = window;
    let (mut largest, mut depth) = (0.0_f64, 0.0);
    let mut cuts = Vec::new();
    for segment in segments {
        cuts.clear();
        segment.cut_at(&[low, high], &mut cuts);
        let half = 0.5 * segment.span.length();
        for piece in cuts.windows(2) {
            let passes = exp(-attenuation * depth);
            if passes <= largest {
                return largest; // what follows is darker
            }
            let [near, far] = [piece[0], piece[1]];
            let middle = segment.at(0.5 * (near + far));
            if middle >= high {
                largest = largest.max(passes);
                depth += (far - near) * half;
            } else if middle > low {
                let [a, b, c, d] = segment.coefficients.map(|x| x / (high - low));
                let v = [a - low / (high - low), b, c, d];
                // By u, as `v` is; and 0 at the near end.
                let integral = [0.0, v[0], v[1] / 2.0, v[2] / 3.0, v[3] / 4.0];
                let before = polynomial(&integral, near);
                let depth_at = |u: f64| depth + half * (polynomial(&integral, u) - before);
                let mut slope = square(v).map(|x| -attenuation * half * x);
                for power in 1..4 {
                    slope[power - 1] += power as f64 * v[power];
                }
                let places = sign_changes(&slope, near, far);
                for u in places.into_iter().chain([near, far]) {
                    let value = polynomial(&v, u).clamp(0.0, 1.0);
                    largest = largest.max(value * exp(-attenuation * depth_at(u)));
                }
                depth = depth_at(far).max(depth);
            }
        }
    }
    largest
}

/// The square of a cubic.
fn square(cubic: [f64; 4]) -> [f64; 7] {
    let mut square = [0.0; 7];
    for (i, a) in cubic.iter().enumerate() {
        for (j, b) in cubic.iter().enumerate() {
            square[i + j] += a * b;
        }
    }
    square
}

//! The radiance of a classified volume without steps: the volume-rendering integral itself.
//!
//! A ray caster approximates, over its span inside the volume and in front of the background `B`
//! (Max 1995, §4),
//!
//! ```text
//! L = ∫ c(v(t)) σ(v(t)) e^(−τ(t)) dt + B e^(−τ(end)),     τ(t) = ∫₀ᵗ σ(v(s)) ds
//! ```
//!
//! with `v` the value of the field. The transfer function states the colour `c` of each value,
//! emission included, and the opacity `a` over a length `h₀`; the extinction is `σ = −ln(1 − a)/h₀`.
//! This is what all steps, first samples and last steps lead to as steps become short.
//!
//! Between two faces of cells `v` is a cubic ([`CubicSegment`]), and between two knots of the
//! transfer function `a` and `c` are straight lines or smooth curves of `v`. On a piece between such
//! places nothing has a kink, and [`Collocation`] integrates it to a tolerance, with a bound on its
//! own error.
//!
//! Source: Max 1995, "Optical models for direct volume rendering".

use crate::geometry::Ray;
use crate::math::exp_m1;
use crate::optics::TransferFunction;
use crate::optics::collocation::{CollocatedLight, Collocation, LocalProperties};
use crate::render::counters::{Counters, Event};
use crate::render::pixels::{Pixels, rows};
use crate::scene::Classified;
use crate::volume::{CubicSegment, GridDensity, PlacedBox};
use glam::DVec3;

/// Error of a pixel that is aimed at, relative to the brightest radiance of the scene: a tenth of
/// what an image in 32 bits rounds a pixel by.
///
/// A ray divides it among its pieces. A piece may be halved, and each of its parts then has as much;
/// therefore the bound that a pixel states, not this number, says how far it may be off.
pub(super) const TOLERANCE: f64 = 1e-8;

/// The integral along a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayIntegral {
    /// Radiance, background included, with the bound on its error; and the optical depth.
    pub light: CollocatedLight,
    /// Cells on the way.
    pub cells: u64,
    /// Points at which the transfer function was evaluated.
    pub points: u64,
}

/// Integrates along rays through a scene.
pub struct RayIntegrator<'s> {
    transfer_function: &'s TransferFunction,
    knots: Vec<f64>,
    field: GridDensity,
    /// Least and largest value of the field. A cubic loses the small ones beside large ones, and may leave it.
    range: (f64, f64),
    extent: PlacedBox,
    background: DVec3,
    /// No radiance of the scene is above this.
    brightest: f64,
    collocation: Collocation,
}

impl<'s> RayIntegrator<'s> {
    /// An integrator of `scene`: its field, transfer function and background.
    pub fn new(scene: &'s Classified) -> RayIntegrator<'s> {
        RayIntegrator {
            range: scene.grid.range(),
            transfer_function: &scene.transfer_function,
            knots: scene.transfer_function.knots(),
            field: GridDensity::new(scene.grid.clone(), scene.interpolation),
            extent: scene.extent(),
            background: scene.background,
            brightest: scene.brightest(),
            collocation: Collocation::new(),
        }
    }

    /// The integral along `ray`.
    pub fn along(&self, ray: &Ray) -> RayIntegral {
        let mut result = RayIntegral {
            light: CollocatedLight {
                radiance: self.background,
                ..CollocatedLight::default()
            },
            ..RayIntegral::default()
        };
        let Some(span) = self.extent.span(ray) else {
            return result;
        };
        let (least, most) = self.range;
        let segments = if least == most {
            vec![CubicSegment {
                span,
                coefficients: [least, 0.0, 0.0, 0.0],
            }]
        } else {
            let segments: Vec<_> = self
                .field
                .cubic_segments(self.extent.line(ray), span)
                .collect();
            result.cells = segments.len() as u64;
            segments
        };
        let tolerance = TOLERANCE * self.brightest / segments.len().max(1) as f64;
        let mut light = self.collocation.ray(tolerance, self.brightest);
        let mut cuts = Vec::new();
        'segments: for segment in &segments {
            cuts.clear();
            segment.cut_at(&self.knots, &mut cuts);
            // Positions on a segment go from −1 to 1: lengths are in halves of it.
            let half = 0.5 * segment.span.length();
            let field = |u: f64| segment.at(u).clamp(least, most);
            for piece in cuts.windows(2) {
                let [near, far] = [piece[0], piece[1]];
                let is_clear = |u: f64| self.transfer_function.reference_opacity(field(u)) == 0.0;
                // Between knots opacity is a line that is not negative, or rises with the value.
                if is_clear(near) && is_clear(0.5 * (near + far)) && is_clear(far) {
                    continue;
                }
                let passes = light.add([near, far], |u| {
                    result.points += 1;
                    let value = field(u);
                    let extinction = self.transfer_function.extinction(value) * half;
                    let colour = self.transfer_function.colour(value);
                    let emission = self.transfer_function.emission(value);
                    LocalProperties::with_source(extinction, colour * emission)
                });
                if !passes {
                    break 'segments;
                }
            }
        }
        result.light = light.light().before(&result.light);
        result
    }
}

/// A pixel: radiance and opacity, and the bound on the error of its radiance.
pub(in crate::render) type BoundedPixel = ([f32; 4], f64);

/// The pixels of `scene`.
pub(in crate::render) fn integrate(
    scene: &Classified,
    pixels: &Pixels<'_>,
) -> (Vec<BoundedPixel>, Counters) {
    let integrator = RayIntegrator::new(scene);
    integrated(scene, pixels, |ray| integrator.along(ray))
}

/// The pixels of `scene`, by the integral `along` each ray.
pub(super) fn integrated(
    scene: &Classified,
    pixels: &Pixels<'_>,
    along: impl Fn(&Ray) -> RayIntegral + Sync,
) -> (Vec<BoundedPixel>, Counters) {
    let size = [pixels.width, pixels.height];
    rows(
        pixels,
        || (),
        |position, _, (), work| {
            let integral = along(&scene.camera.ray(position, size));
            work.count_times(Event::SurfaceTest, scene.objects.surfaces.len() as u64);
            work.count_times(Event::CellWalked, integral.cells);
            work.count_times(Event::DensityLookup, integral.cells);
            work.count_times(Event::Attenuation, integral.points);
            work.count_times(Event::EmissionTerm, integral.points);
            (pixel(&integral.light), integral.light.radiance_error)
        },
    )
}

/// Radiance of a pixel, and the opacity of the volume in front of the background.
fn pixel(light: &CollocatedLight) -> [f32; 4] {
    let opacity = -exp_m1(-light.depth);
    let DVec3 { x, y, z } = light.radiance;
    [x, y, z, opacity].map(|value| value as f32)
}

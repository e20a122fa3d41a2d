//! Collocation at Gauss points: integrals along a ray, with a bound on their error.
//!
//! Light along a ray is `∫ ε e^(−τ) dt`, with emission `ε`, and with the depth `τ(t) = ∫₀ᵗ σ` of
//! the extinction. On an element, a short piece of the ray, `σ` and `ε` are taken at Gauss's seven
//! points; the polynomial through the seven values of `σ` gives the depth at each of them. Where
//! both are smooth the error falls with the thirteenth power of the element's length or so. An
//! element is halved until its halves agree with it; what they still disagree by is added up to
//! the bound.
//!
//! Source: Hairer, Nørsett & Wanner 1993, *Solving Ordinary Differential Equations I*, II.7
//! (collocation at Gauss points).

use crate::math::quadrature::{GAUSS_POINTS as POINTS, GAUSS_WEIGHTS as WEIGHTS};
use crate::math::{Sum, exp, exp_m1};
use glam::DVec3;

/// Extinction and emission at a point of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalProperties {
    /// Extinction, per length; infinite in opaque matter.
    pub extinction: f64,
    /// Radiance emitted per length; where the extinction is infinite, the radiance itself.
    pub emission: DVec3,
}

impl LocalProperties {
    /// Properties where an opaque sample would have the radiance `source`.
    pub(crate) fn with_source(extinction: f64, source: DVec3) -> LocalProperties {
        if extinction <= DENSEST {
            LocalProperties {
                extinction,
                emission: source * extinction,
            }
        } else {
            LocalProperties {
                extinction: f64::INFINITY,
                emission: source,
            }
        }
    }
}

/// An extinction beyond this counts as infinite: products of it with a radiance or a length, below
/// 1e40 both, are to be numbers.
const DENSEST: f64 = 1e260;

/// Light along a piece of a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CollocatedLight {
    /// Its radiance.
    pub radiance: DVec3,
    /// Its optical depth.
    pub depth: f64,
    /// Error bound of each channel of the radiance, estimated by halving elements.
    pub radiance_error: f64,
    /// Error bound of the depth.
    pub depth_error: f64,
}

/// Points of an element.
const N: usize = 7;

/// An element that shows more or less than this of a uniform source of 1 before it than there is has
/// points that lie too far apart for its depth, and is halved whatever its halves agree on: where all
/// points but one see nothing, they agree on darkness.
const UNRESOLVED: f64 = 1e-3;

/// An element is halved no more often than this.
const MOST_HALVINGS: u32 = 40;

/// Elements of a ray, at most: where an integrand has no end of kinks, the bound says so.
const MOST_ELEMENTS: usize = 40_000;

/// Evaluates integrals along rays.
#[derive(Clone, Debug)]
pub struct Collocation {
    /// `∫ ℓ_j` from −1 to point i, ℓ_j the polynomial that is 1 at point j and 0 at the others.
    up_to: [[f64; N]; N],
}

impl Default for Collocation {
    /// With its table of integrals.
    fn default() -> Collocation {
        let mut up_to = [[0.0; N]; N];
        for j in 0..N {
            let polynomial = lagrange(j);
            for (row, point) in up_to.iter_mut().zip(POINTS) {
                row[j] = integral(&polynomial, point) - integral(&polynomial, -1.0);
            }
        }
        Collocation { up_to }
    }
}

impl Collocation {
    /// Light between the first and the last of `cuts`, which rise; between two of them `at` is
    /// smooth, if possible. An element is halved until its share of the error, in radiance and in
    /// depth, is at most `tolerance`.
    pub fn light(
        &self,
        cuts: &[f64],
        tolerance: f64,
        mut at: impl FnMut(f64) -> LocalProperties,
    ) -> CollocatedLight {
        let mut ray = self.ray(tolerance, 1.0);
        for piece in cuts.windows(2) {
            if !ray.add([piece[0], piece[1]], &mut at) {
                break;
            }
        }
        ray.light()
    }

    /// An integral to be made piece by piece from the eye on. An element is halved until its share
    /// of the error in radiance is at most `tolerance`; an error in its depth counts times
    /// `brightness`, a radiance that nothing behind it exceeds.
    pub fn ray(&self, tolerance: f64, brightness: f64) -> CollocatedRay<'_> {
        CollocatedRay {
            collocation: self,
            tolerance,
            brightness,
            elements: Vec::new(),
            waiting: Vec::new(),
            depth: Sum::default(),
        }
    }

    /// Light of one element.
    fn element(
        &self,
        near: f64,
        far: f64,
        at: &mut impl FnMut(f64) -> LocalProperties,
    ) -> CollocationElement {
        let half = 0.5 * (far - near);
        let here = POINTS.map(|point| at(near + half * (1.0 + point)));
        let is_opaque = |here: &&LocalProperties| here.extinction == f64::INFINITY;
        if let Some(opaque) = here.iter().find(is_opaque) {
            return CollocationElement {
                light: CollocatedLight {
                    radiance: opaque.emission,
                    depth: f64::INFINITY,
                    ..CollocatedLight::default()
                },
                is_mixed: !here.iter().all(|here| is_opaque(&here)),
                unresolved: 0.0,
            };
        }
        let mut light = CollocatedLight::default();
        let mut uniform = 0.0;
        for i in 0..N {
            let before: f64 = (0..N).map(|j| self.up_to[i][j] * here[j].extinction).sum();
            // A polynomial through values far apart may fall below 0; a depth does not.
            let weight = WEIGHTS[i] * half * exp(-half * before.max(0.0));
            light.radiance += here[i].emission * weight;
            uniform += here[i].extinction * weight;
            light.depth += WEIGHTS[i] * half * here[i].extinction;
        }
        let visible = -exp_m1(-light.depth);
        let unresolved = (uniform - visible).abs();
        if unresolved > UNRESOLVED {
            // A mean of what the points emit, as bright as light is held back.
            light.radiance = if uniform > 0.0 {
                light.radiance * (visible / uniform)
            } else {
                let first = here.iter().find(|here| here.extinction > 0.0);
                first.map_or(DVec3::ZERO, |here| here.emission / here.extinction) * visible
            };
        }
        CollocationElement {
            light,
            is_mixed: false,
            unresolved: unresolved.min(1.0),
        }
    }
}

/// Light along a ray, piece by piece.
#[derive(Clone, Debug)]
pub struct CollocatedRay<'c> {
    collocation: &'c Collocation,
    tolerance: f64,
    brightness: f64,
    /// The elements found so far, from the eye on.
    elements: Vec<CollocatedLight>,
    /// Elements to be halved, the nearest last: near and far end, number of halvings, light.
    waiting: Vec<(f64, f64, u32, CollocationElement)>,
    /// Depth of the elements found so far.
    depth: Sum,
}

impl CollocatedRay<'_> {
    /// Adds the piece between two positions, the first of which is the nearer one; within it `at` is
    /// smooth, if possible. Whether light still passes. Only lengths count: each piece may have an
    /// origin of its own.
    pub fn add(
        &mut self,
        [near, far]: [f64; 2],
        mut at: impl FnMut(f64) -> LocalProperties,
    ) -> bool {
        if near >= far {
            return true;
        }
        let whole = self.collocation.element(near, far, &mut at);
        self.waiting.push((near, far, 0, whole));
        while let Some((near, far, halvings, whole)) = self.waiting.pop() {
            let middle = near + 0.5 * (far - near);
            let first = self.collocation.element(near, middle, &mut at);
            let second = self.collocation.element(middle, far, &mut at);
            let mut halves = first.light.before(&second.light);
            let transmittance = exp(-self.depth.value());
            // Two that are opaque agree in depth.
            halves.depth_error = if halves.depth == whole.light.depth {
                0.0
            } else {
                (halves.depth - whole.light.depth).abs()
            };
            halves.radiance_error = (halves.radiance - whole.light.radiance).abs().max_element();
            let unresolved = first.unresolved + exp(-first.light.depth) * second.unresolved;
            if unresolved > UNRESOLVED {
                halves.radiance_error += self.brightness * unresolved;
            }
            let left =
                transmittance * (halves.radiance_error + self.brightness * halves.depth_error);
            let settled = left <= self.tolerance && !first.is_mixed && !second.is_mixed
                || halvings >= MOST_HALVINGS
                || self.elements.len() >= MOST_ELEMENTS
                || !(near < middle && middle < far);
            if settled {
                self.depth.add(halves.depth);
                self.elements.push(halves);
                if halves.depth == f64::INFINITY {
                    self.waiting.clear();
                    return false;
                }
            } else {
                self.waiting.push((middle, far, halvings + 1, second));
                self.waiting.push((near, middle, halvings + 1, first));
            }
        }
        true
    }

    /// The pieces, put together from behind.
    pub fn light(&self) -> CollocatedLight {
        let elements = self.elements.iter().rev();
        elements.fold(CollocatedLight::default(), |behind, element| {
            element.before(&behind)
        })
    }
}

/// Light of an element, at seven points.
#[derive(Clone, Copy, Debug)]
struct CollocationElement {
    light: CollocatedLight,
    /// Some of the points are opaque, others are not: where light ends is not known yet.
    is_mixed: bool,
    /// The light of a uniform source of 1, `1 − e^(−τ)`, as the points integrate it; 1 at most.
    unresolved: f64,
}

impl CollocatedLight {
    /// This piece before another one.
    pub fn before(&self, behind: &CollocatedLight) -> CollocatedLight {
        let transmittance = exp(-self.depth);
        let attenuated = behind.radiance * transmittance;
        CollocatedLight {
            radiance: self.radiance + attenuated,
            depth: self.depth + behind.depth,
            // e^(−τ) is off by no more than itself times the error of τ, to first order.
            radiance_error: self.radiance_error
                + transmittance * behind.radiance_error
                + attenuated.abs().max_element() * self.depth_error.min(1.0),
            depth_error: self.depth_error + behind.depth_error,
        }
    }
}

/// Coefficients, from the constant one on, of the polynomial that is 1 at point `j` and 0 at the
/// others.
fn lagrange(j: usize) -> [f64; N] {
    let mut polynomial = [0.0; N];
    polynomial[0] = 1.0;
    for (k, &root) in POINTS.iter().enumerate().filter(|&(k, _)| k != j) {
        let scale = 1.0 / (POINTS[j] - root);
        let degree = if k < j { k } else { k - 1 };
        for power in (0..=degree).rev() {
            polynomial[power + 1] += polynomial[power] * scale;
            polynomial[power] *= -root * scale;
        }
    }
    polynomial
}

/// An antiderivative of a polynomial, at `x`.
fn integral(polynomial: &[f64; N], x: f64) -> f64 {
    let terms = polynomial.iter().enumerate().rev();
    x * terms.fold(0.0, |sum, (power, coefficient)| {
        sum * x + coefficient / (power + 1) as f64
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{cos, sin};

    /// The smooth test ray: extinction and emission per length, known to sixty digits.
    fn smooth(t: f64) -> LocalProperties {
        let extinction = 1.5 + sin(3.7 * t) + 0.6 * t * t;
        LocalProperties {
            extinction,
            emission: DVec3::splat(0.7 + 0.5 * cos(5.1 * t + 0.3)),
        }
    }

    #[test]
    fn the_smooth_test_ray() {
        let light = Collocation::default().light(&[0.0, 2.0], 1e-15, smooth);
        assert!((light.depth - 4.751_743_965_520_435).abs() < 1e-14);
        assert!((light.radiance.x - 0.338_236_980_254_304_8).abs() < 1e-15);
        assert!(light.radiance_error < 1e-13, "{light:?}");
    }

    /// The bound holds, and is not idle: with wide elements both it and the error are large.
    #[test]
    fn the_bound_bounds() {
        for tolerance in [1e-3, 1e-6, 1e-9, 1e-12] {
            let light = Collocation::default().light(&[0.0, 2.0], tolerance, smooth);
            let error = (light.radiance.x - 0.338_236_980_254_304_8).abs();
            // Sums of some hundred terms of size 1 round by as many units of 1e-16.
            assert!(
                error <= light.radiance_error + 1e-14,
                "{tolerance}: {light:?}"
            );
        }
    }

    #[test]
    fn a_uniform_source() {
        let uniform = |_| LocalProperties::with_source(3.0, DVec3::new(1.0, 2.0, 0.0));
        let light = Collocation::default().light(&[0.0, 1.0, 2.0], 1e-13, uniform);
        let seen = -crate::math::exp_m1(-6.0);
        assert!((light.radiance - DVec3::new(seen, 2.0 * seen, 0.0)).length() < 1e-13);
        assert!((light.depth - 6.0).abs() < 1e-14);
    }

    #[test]
    fn kinks_jumps_and_what_is_opaque() {
        let jump = |t: f64| {
            LocalProperties::with_source(if t < 1.0 / 3.0 { 2.0 } else { 0.2 }, DVec3::ONE)
        };
        let light = Collocation::default().light(&[0.0, 1.0], 1e-12, jump);
        let depth = 2.0 / 3.0 + 0.2 * 2.0 / 3.0;
        assert!((light.depth - depth).abs() < 1e-11, "{light:?}");
        let wall = |t: f64| {
            if t < 0.7 {
                LocalProperties::with_source(0.5, DVec3::ONE)
            } else {
                LocalProperties::with_source(f64::INFINITY, DVec3::splat(5.0))
            }
        };
        let light = Collocation::default().light(&[0.0, 1.0], 1e-12, wall);
        let transmittance = exp(-0.35);
        let right = 1.0 - transmittance + 5.0 * transmittance;
        assert!((light.radiance.x - right).abs() < 1e-11, "{light:?}");
        assert_eq!(light.depth, f64::INFINITY);
    }
}

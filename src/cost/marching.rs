//! Schemes that sum emission and absorption over equal steps along a ray.
//!
//! One of them is the reference renderer's; the others are what people write.

use crate::math::{exp, ln};
use crate::optics::collocation::LocalProperties;
use crate::optics::optical_depth;
use crate::render::classified::steps::Steps;
use glam::DVec3;

/// The rule for a step of length `h`, with `σ` and `ε` the extinction and emission at its sample,
/// and `S = ε/σ` the source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Sample in the middle, `S (1 − e^(−σh))`: that of the reference.
    Midpoint,
    /// Sample at the beginning, `S (1 − e^(−σh))`.
    Left,
    /// Sample in the middle, with the opacity `min(σh, 1)` in place of `1 − e^(−σh)`.
    ThinOpacity,
    /// Sample in the middle, `ε h`: the step does not attenuate its own light.
    NoSelfAttenuation,
    /// Sample in the middle, `ε h e^(−σh/2)`: light is attenuated as from the middle.
    MiddleAttenuation,
    /// Means of `σ` and `ε` at both ends, attenuated as if they were constant over the step.
    Trapezoid,
    /// Midpoint rule, but at a random place in the step, independent for each.
    Stratified,
    /// Midpoint rule, but at a random place in the step, the same for all steps of a ray.
    Comb,
}

/// The schemes with their names and the orders of their errors in the length of a step, where
/// extinction and source are continuous; of jitter, the order of the standard deviation.
const SCHEMES: [(Scheme, &str, f64); 8] = [
    (Scheme::Midpoint, "midpoint", 2.0),
    (Scheme::Left, "left", 1.0),
    (Scheme::ThinOpacity, "midpoint, opacity σh", 1.0),
    (
        Scheme::NoSelfAttenuation,
        "midpoint, no attenuation inside a step",
        1.0,
    ),
    (
        Scheme::MiddleAttenuation,
        "midpoint, attenuation from the middle",
        2.0,
    ),
    (Scheme::Trapezoid, "trapezoid", 2.0),
    (Scheme::Stratified, "jittered, stratified", 1.5),
    (Scheme::Comb, "jittered, one offset per ray", 1.0),
];

impl Scheme {
    /// All schemes.
    pub fn all() -> [Scheme; 8] {
        SCHEMES.map(|(scheme, ..)| scheme)
    }

    /// Name.
    pub fn name(self) -> &'static str {
        SCHEMES[self as usize].1
    }

    /// Order of its error.
    pub fn order(self) -> f64 {
        SCHEMES[self as usize].2
    }

    /// Light sent back over `steps`, and their depth. `at` gives extinction and emission at a
    /// distance, `random` the random numbers of the step with an index, uniform in [0, 1).
    pub fn march(
        self,
        steps: &Steps,
        mut at: impl FnMut(f64) -> LocalProperties,
        mut random: impl FnMut(usize) -> f64,
    ) -> (DVec3, f64) {
        let mut radiance = DVec3::ZERO;
        // The depth is what is carried; transmittance would end at 0 and stay there.
        let mut depth = 0.0;
        // Transparency by multiplication, of the scheme that has no depth.
        let mut transmittance = 1.0;
        let mut before = None;
        for index in 0..steps.count() {
            let (middle, length) = steps.sample(index);
            let (near, far) = (middle - 0.5 * length, middle + 0.5 * length);
            let point = match self {
                Scheme::Left => near,
                Scheme::Stratified => near + random(index) * length,
                Scheme::Comb => near + random(0) * length,
                _ => middle,
            };
            if self == Scheme::Trapezoid {
                let first = before.unwrap_or_else(|| at(near));
                let last = at(far);
                before = Some(last);
                let opaque = [first, last]
                    .into_iter()
                    .find(|end| end.extinction.is_infinite());
                // An opaque end makes the step opaque: there is no mean with infinity.
                let mean = opaque.unwrap_or(LocalProperties {
                    extinction: 0.5 * (first.extinction + last.extinction),
                    emission: 0.5 * (first.emission + last.emission),
                });
                radiance += mean.seen_over(length) * exp(-depth);
                depth += optical_depth(mean.extinction, length);
                continue;
            }
            let here = at(point);
            let own = optical_depth(here.extinction, length);
            match self {
                // What is opaque shows its own light, by any scheme.
                _ if own.is_infinite() => {
                    let before = match self {
                        Scheme::ThinOpacity => transmittance,
                        _ => exp(-depth),
                    };
                    radiance += here.emission * before;
                    transmittance = 0.0;
                }
                Scheme::ThinOpacity => {
                    // Of what is denser than that, the step is opaque at its beginning.
                    let whole = (1.0 / here.extinction).min(length);
                    radiance += here.emission * (whole * transmittance);
                    transmittance *= 1.0 - own.min(1.0);
                }
                Scheme::NoSelfAttenuation => radiance += here.emission * (length * exp(-depth)),
                Scheme::MiddleAttenuation => {
                    radiance += here.emission * (length * exp(-(depth + 0.5 * own)));
                }
                _ => radiance += here.seen_over(length) * exp(-depth),
            }
            depth += own;
        }
        if self == Scheme::ThinOpacity {
            depth = -ln(transmittance);
        }
        (radiance, depth)
    }
}

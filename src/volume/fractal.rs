//! Fractal noise as a density.

use super::noise_range::noise_range;
use super::{DensityField, DensityRange, perlin_noise};
use crate::geometry::{Aabb, InvalidParameter, require};
use glam::DVec3;

/// Parameters of a [`FractalDensity`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FractalParameters {
    /// Number of layers of noise; 1 to [`MOST_OCTAVES`].
    pub octaves: u32,
    /// Factor on the frequency from one octave to the next, > 0.
    pub lacunarity: f64,
    /// Factor on the amplitude from one octave to the next, > 0.
    pub gain: f64,
    /// Lattice cells of the first octave per unit of length, along each axis.
    pub scale: DVec3,
    /// Position of the origin in the lattice of the first octave, in cells.
    pub offset: DVec3,
    /// The largest density, ≥ 0, reached where the noise is 1 or more.
    pub max_density: f64,
    /// Densities up to and including this one count as 0.
    pub threshold: f64,
}

/// Largest number of octaves. At a lacunarity of 2 the cells of a finer one are smaller than the
/// rounding of coordinates of some millions.
pub const MOST_OCTAVES: u32 = 32;

impl Default for FractalParameters {
    /// Four octaves, each of twice the frequency and half the amplitude of the one before, one
    /// cell per unit of length, densities up to 1, all of them kept.
    fn default() -> FractalParameters {
        FractalParameters {
            octaves: 4,
            lacunarity: 2.0,
            gain: 0.5,
            scale: DVec3::ONE,
            offset: DVec3::ZERO,
            max_density: 1.0,
            threshold: 0.0,
        }
    }
}

/// Fractal noise as a density field.
///
/// With `n` [Perlin's noise](perlin_noise) and `q = p·scale + offset`, the octaves
/// `Σᵢ gainⁱ n(q·lacunarityⁱ)` over `Σᵢ gainⁱ` are a value `v` about 0, and the density is
/// `(v + 1)/2·max_density`, clamped to [0, `max_density`], where that is above `threshold`, else
/// 0. Nothing is subtracted: the field jumps from 0 to the threshold.
///
/// So `max_density` is a majorant everywhere, by the clamp, and [`DensityField::range_over`] has
/// closer ones.
///
/// Source: Perlin 1985, "An image synthesizer", Computer Graphics 19(3), for sums of octaves; the
/// procedural medium of a student's renderer for the rest.
#[derive(Clone, Debug, PartialEq)]
pub struct FractalDensity {
    parameters: FractalParameters,
    octaves: Box<[Octave]>,
}

/// A layer of noise.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Octave {
    /// Its cells per cell of the first octave.
    frequency: f64,
    /// Its share in the sum; all shares add up to 1.
    amplitude: f64,
}

impl FractalDensity {
    /// Prepares the octaves of parameters within their domains.
    ///
    /// # Errors
    ///
    /// [`InvalidParameter`], where the octaves leave the range of numbers.
    pub fn new(parameters: FractalParameters) -> Result<FractalDensity, InvalidParameter> {
        let FractalParameters {
            octaves,
            lacunarity,
            gain,
            ..
        } = parameters;
        let powers = |factor: f64| {
            std::iter::successors(Some(1.0), move |power| Some(power * factor))
                .take(octaves as usize)
        };
        let sum: f64 = powers(gain).sum();
        let message =
            format_args!("gain {gain:?} makes the amplitudes of {octaves} octaves overflow");
        require(sum.is_finite(), "gain", message)?;
        let message = format_args!(
            "lacunarity {lacunarity:?} makes the frequency of octave {octaves} overflow"
        );
        require(
            powers(lacunarity).all(f64::is_finite),
            "lacunarity",
            message,
        )?;
        let octaves = powers(lacunarity).zip(powers(gain));
        let octaves = octaves.map(|(frequency, power)| Octave {
            frequency,
            amplitude: power / sum,
        });
        Ok(FractalDensity {
            parameters,
            octaves: octaves.collect(),
        })
    }

    /// The parameters.
    pub fn parameters(&self) -> &FractalParameters {
        &self.parameters
    }

    /// Position of `point` in the lattice of the first octave.
    fn lattice_point(&self, point: DVec3) -> DVec3 {
        point * self.parameters.scale + self.parameters.offset
    }

    /// The density of a sum of octaves: rising, as every step of it does, rounding included.
    fn density_of(&self, sum: f64) -> f64 {
        let FractalParameters {
            max_density,
            threshold,
            ..
        } = self.parameters;
        let density = ((sum * 0.5 + 0.5) * max_density).clamp(0.0, max_density);
        if density > threshold { density } else { 0.0 }
    }
}

impl DensityField for FractalDensity {
    fn density(&self, point: DVec3) -> f64 {
        let lattice_point = self.lattice_point(point);
        let mut sum = 0.0;
        for octave in &self.octaves {
            sum += octave.amplitude * perlin_noise(lattice_point * octave.frequency);
        }
        self.density_of(sum)
    }

    /// Proof. IEEE sums and products keep the order of numbers, for rounding does. So the place
    /// of a point of the box in the lattice of an octave, as it is computed, lies between those
    /// of two opposite corners, and its noise within `noise_range` of these. Amplitudes are not
    /// negative: with the ends of these ranges in place of the noise, the same operations in the
    /// same order give bounds on the sum as it is computed. `density_of`
    /// rises with the sum.
    ///
    /// So `high` is 0 exactly where no sum can exceed the threshold, and `low` is 0 wherever one
    /// may stay below it.
    fn range_over(&self, bounds: &Aabb) -> DensityRange {
        let [min, max] = [bounds.min, bounds.max].map(|corner| self.lattice_point(corner));
        let (mut least, mut most) = (0.0, 0.0);
        for octave in &self.octaves {
            let noise = noise_range(min * octave.frequency, max * octave.frequency);
            least += octave.amplitude * noise.low;
            most += octave.amplitude * noise.high;
        }
        DensityRange::new(self.density_of(least), self.density_of(most))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::tests::failures_in;
    use proptest::prelude::*;

    /// The parameters of the source's XML block.
    const SOURCE: FractalParameters = FractalParameters {
        octaves: 10,
        lacunarity: 4.0,
        gain: 0.5,
        scale: DVec3::new(0.5, 1.0, 1.0),
        offset: DVec3::ZERO,
        max_density: 4.0,
        threshold: 1.25,
    };

    #[test]
    fn one_octave_is_the_noise() {
        let parameters = FractalParameters {
            octaves: 1,
            max_density: 2.0,
            ..FractalParameters::default()
        };
        let field = FractalDensity::new(parameters).unwrap();
        let point = DVec3::new(3.3, 42.0, 7.0);
        assert_eq!(field.density(point), perlin_noise(point) + 1.0);
        // The noise is 0 at lattice points.
        assert_eq!(field.density(DVec3::new(3.0, -4.0, 5.0)), 1.0);
    }

    #[test]
    fn octaves_are_weighed_by_their_gain() {
        let parameters = FractalParameters {
            octaves: 2,
            lacunarity: 3.0,
            gain: 0.25,
            scale: DVec3::new(2.0, 1.0, -1.0),
            offset: DVec3::new(0.5, 0.0, 0.25),
            ..FractalParameters::default()
        };
        let field = FractalDensity::new(parameters).unwrap();
        let lattice_point = DVec3::new(0.625, 1.5, -0.375);
        let point = (lattice_point - parameters.offset) / parameters.scale;
        let sum = (perlin_noise(lattice_point) + 0.25 * perlin_noise(lattice_point * 3.0)) / 1.25;
        let density = (sum + 1.0) / 2.0;
        assert!((field.density(point) - density).abs() <= 4.0 * f64::EPSILON);
    }

    #[test]
    fn the_threshold_keeps_what_is_above_it() {
        let field = |threshold: f64| {
            FractalDensity::new(FractalParameters {
                threshold,
                ..SOURCE
            })
            .unwrap()
        };
        let all = field(0.0);
        let point = DVec3::new(0.3, 0.4, 0.55);
        let density = all.density(point);
        assert!(density > 0.0);
        assert_eq!(field(density.next_down()).density(point), density);
        assert_eq!(field(density).density(point), 0.0);
        // Where nothing can be above it, the bound is 0 and no more.
        let here = Aabb::new(point, point).unwrap();
        assert_eq!(field(density + 1.0).range_over(&here).high, 0.0);
        let everywhere = Aabb::new(DVec3::splat(-1e9), DVec3::splat(1e9)).unwrap();
        let range = field(4.0).range_over(&everywhere);
        assert_eq!(range, DensityRange::of(0.0));
        assert_eq!(field(1.25).range_over(&everywhere).high, 4.0);
    }

    #[test]
    fn octaves_beyond_all_numbers_are_refused() {
        let message = |change: &dyn Fn(&mut FractalParameters)| {
            let mut parameters = SOURCE;
            change(&mut parameters);
            FractalDensity::new(parameters).unwrap_err().message
        };
        let amplitude = "gain 1e300 makes the amplitudes of 10 octaves overflow";
        assert_eq!(message(&|p| p.gain = 1e300), amplitude);
        let frequency = "lacunarity 1e200 makes the frequency of octave 10 overflow";
        assert_eq!(message(&|p| p.lacunarity = 1e200), frequency);
    }

    /// How near the bound is to what it bounds, for the source's parameters: measured ratios of
    /// mean bound to mean true maximum are 1.21, 1.27 and 1.39.
    #[test]
    fn bounds_of_the_source_are_close() {
        let field = FractalDensity::new(SOURCE).unwrap();
        for (edge, ratio) in [(0.05, 1.25), (0.1, 1.31), (0.25, 1.43)] {
            let (mut bound, mut seen) = (0.0, 0.0);
            // Places without a common step with any lattice.
            for number in 0..40 {
                let turns = DVec3::new(0.618_033_99, 0.754_877_67, 0.569_840_29);
                let min = (f64::from(number) * turns).fract() * 4.0 - 2.0;
                bound += field.range_over(&Aabb::new(min, min + edge).unwrap()).high;
                seen += (0..4000)
                    .map(|k| min + (f64::from(k) * turns).fract() * edge)
                    .map(|point| field.density(point))
                    .fold(0.0, f64::max);
            }
            assert!(bound <= ratio * seen, "{edge}: {}", bound / seen);
        }
    }

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![
            4 => -8.0..8.0_f64,
            1 => -1e7..1e7_f64,
            1 => -1e20..1e20_f64,
            1 => prop::num::f64::NORMAL | prop::num::f64::ZERO | prop::num::f64::SUBNORMAL,
        ]
    }

    fn parameters() -> impl Strategy<Value = FractalParameters> {
        (
            1..=MOST_OCTAVES,
            prop_oneof![4 => 0.5..4.5_f64, 1 => 1e-300..1e9_f64],
            prop_oneof![4 => 0.05..1.5_f64, 1 => 1e-300..1e9_f64],
            prop::array::uniform3(coordinate()),
            prop::array::uniform3(coordinate()),
            prop_oneof![4 => 0.0..8.0_f64, 1 => 0.0..f64::MAX],
            prop_oneof![4 => 0.3..0.7_f64, 1 => -1.0..1.5_f64],
        )
            .prop_map(
                |(octaves, lacunarity, gain, scale, offset, max_density, share)| {
                    FractalParameters {
                        octaves,
                        lacunarity,
                        gain,
                        scale: scale.into(),
                        offset: offset.into(),
                        max_density,
                        threshold: (share * max_density).clamp(f64::MIN, f64::MAX),
                    }
                },
            )
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, ..failures_in("fixtures/proptest-regressions/fractal.txt") })]

        /// Densities are finite, at most the largest, above the threshold or 0, and within the
        /// range over any box around them.
        #[test]
        fn densities_lie_within_their_range(
            parameters in parameters(),
            corner in prop::array::uniform3(coordinate()),
            size in prop::array::uniform3(prop_oneof![Just(0.0), 0.0..0.1_f64, 0.0..3.0_f64]),
            points in prop::collection::vec(prop::array::uniform3(
                prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0_f64]), 16),
        ) {
            let Ok(field) = FractalDensity::new(parameters) else {
                return Ok(());
            };
            let (min, size) = (DVec3::from_array(corner), DVec3::from_array(size));
            let Ok(bounds) = Aabb::new(min, min + size) else {
                return Ok(());
            };
            let range = field.range_over(&bounds);
            prop_assert!(0.0 <= range.low && range.low <= range.high);
            prop_assert!(range.high <= parameters.max_density);
            prop_assert!(range.high == 0.0 || range.high > parameters.threshold);
            for share in points {
                let point = min + bounds.size() * DVec3::from_array(share);
                let density = field.density(point.clamp(bounds.min, bounds.max));
                prop_assert!(range.low <= density && density <= range.high);
                prop_assert!(density == 0.0 || density > parameters.threshold);
            }
        }
    }
}

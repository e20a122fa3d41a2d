//! The noise of a sampled image.

/// The noise of an image whose pixels are means of random samples: the variance of those means, and
/// the number of samples in each. Fewer than two samples have no variance.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    pub(super) variance: Vec<[f32; 3]>,
    pub(super) samples: u32,
    pub(super) origin: NoiseOrigin,
}

/// Origin of variances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoiseOrigin {
    /// The spread of samples.
    Samples,
    /// The spread of whole renderings.
    Renderings,
    /// Nothing: the means are those of the distribution.
    Known,
}

impl Noise {
    /// Variances of the means of `samples` samples each.
    pub(super) fn of_samples(variance: Vec<[f32; 3]>, samples: u32) -> Noise {
        Noise {
            variance,
            samples,
            origin: NoiseOrigin::Samples,
        }
    }

    /// Noise of `pixels` that are known: no variance, and the largest number of samples.
    pub(super) fn none(pixels: usize) -> Noise {
        Noise {
            variance: vec![[0.0; 3]; pixels],
            samples: u32::MAX,
            origin: NoiseOrigin::Known,
        }
    }

    /// Estimated variance of the mean, the square of its standard error, in the square of the
    /// unit of radiance: red, green and blue of every pixel, row by row from the top. Not the
    /// variance of one sample, which is `samples` times as large.
    pub fn variance(&self) -> &[[f32; 3]] {
        &self.variance
    }

    /// Number, at least 2, of independent values of which each pixel is the mean and from whose
    /// spread the variance was estimated: samples, or replicates without a sample count.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Whether these values are whole renderings without a sample count.
    pub fn is_of_renderings(&self) -> bool {
        self.origin == NoiseOrigin::Renderings
    }

    /// Whether the pixels are known without samples ([`Film::known`](super::Film::known)).
    pub fn is_known(&self) -> bool {
        self.origin == NoiseOrigin::Known
    }

    /// The first pixel whose variance is negative or not finite.
    pub(crate) fn first_without_variance(&self) -> Option<usize> {
        let broken = |pixel: &[f32; 3]| !pixel.iter().all(is_sound);
        self.variance.iter().position(broken)
    }
}

/// Neither negative nor infinite, nor no number.
// Without a branch, so that a loop over many is compiled to few instructions.
pub(super) fn is_sound(value: &f32) -> bool {
    (*value >= 0.0) & (*value <= f32::MAX)
}

/// Significant bits of a variance: relative rounding error at most 2⁻⁸.
///
/// An estimate from n samples has a relative error of about √(2/n), which is above 2⁻⁸ up to n =
/// 2¹⁷; the standard error changes by 2⁻⁹. Sixteen zero bits per value cost almost nothing in a
/// compressed file, sixteen random bits cost two bytes.
const BITS: u32 = 8;

/// `variance` as files keep it.
pub(super) fn rounded(variance: f32) -> f32 {
    rounded_to(BITS, variance)
}

/// `value` rounded to so many significant bits, ties to even.
pub(super) fn rounded_to(significant: u32, value: f32) -> f32 {
    if !value.is_finite() {
        return value;
    }
    let dropped = f32::MANTISSA_DIGITS - significant;
    let bits = value.to_bits();
    // Half of the last kept bit, and one less where that is even: carries run into the exponent
    // as they should.
    let kept_is_odd = (bits >> dropped) & 1;
    let below_half = (1 << (dropped - 1)) - 1;
    f32::from_bits((bits + below_half + kept_is_odd) & !((1 << dropped) - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_significant_bits() {
        for (given, expected) in [
            (0.0, 0.0),
            (1.0, 1.0),
            (1.0 + 1.0 / 128.0, 1.0 + 1.0 / 128.0),
            (1.0 + 1.0 / 256.0, 1.0),
            (1.0 + 3.0 / 256.0, 1.0 + 2.0 / 128.0),
            (1.0 + 1.0 / 256.0 + f32::EPSILON, 1.0 + 1.0 / 128.0),
            (2.0 - f32::EPSILON, 2.0),
        ] {
            assert_eq!(rounded(given), expected, "{given}");
            assert_eq!(rounded(expected), expected);
        }
        for value in [0.3e-20_f32, 0.1, 7.7, 1e30] {
            assert!((rounded(value) - value).abs() <= value / 256.0);
        }
        assert!(rounded(f32::NAN).is_nan());
    }
}

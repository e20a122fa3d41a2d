//! Single pixels: too many far off, different without noise, or copied.

use super::super::significance::{at_least, deviation, holm};
use super::Metrics;
use super::blocks::Difference;
use super::comparison::Comparison;
use crate::math;

/// A pixel beyond this many standard errors is counted.
const FAR: f64 = 5.0;

/// What single pixels come to.
#[derive(Default)]
pub(super) struct PixelDifferences {
    /// Of each channel.
    values: u64,
    /// Beyond [`FAR`], by channel.
    far: [u64; 3],
    /// Different although neither image has noise there, in all channels.
    contrary: u64,
    /// With noise beyond that of rounding.
    noisy: u64,
    /// Of those, the same bits in both images.
    copied: u64,
}

impl PixelDifferences {
    pub fn new(comparison: &Comparison<'_>) -> PixelDifferences {
        let [reference, test] = comparison.films;
        let mut pixels = PixelDifferences::default();
        for index in 0..reference.radiance().len() {
            let (a, b) = (reference.radiance()[index], test.radiance()[index]);
            let mut is_noisy = false;
            for c in 0..3 {
                let difference = Difference::of(f64::from(a[c]), f64::from(b[c]));
                let stated = comparison.films.map(|film| {
                    let noise = film.noise();
                    noise.map_or(0.0, |noise| f64::from(noise.variance()[index][c]))
                });
                let [guard_a, guard_b] = comparison.shape.guard(stated);
                let variance = (stated[0] + stated[1]).max(guard_a + guard_b);
                let z = deviation(difference.beyond_rounding(), variance).abs();
                pixels.far[c] += u64::from(z > FAR);
                pixels.contrary += u64::from(z == f64::INFINITY);
                is_noisy |= stated[0].max(stated[1]) > difference.rounding * difference.rounding;
            }
            pixels.values += 1;
            pixels.noisy += u64::from(is_noisy);
            pixels.copied += u64::from(is_noisy && a == b);
        }
        pixels
    }

    /// Asked only where both images state their noise: else that of a pixel is not known.
    pub fn judge_far(&self, level: f64, metrics: &mut Metrics) -> Option<String> {
        // Chebyshev, for any distribution of that variance.
        let each = 1.0 / (FAR * FAR);
        let probabilities = self.far.map(|far| at_least(far, self.values, each));
        let most = self.far[0].max(self.far[1]).max(self.far[2]);
        metrics.push(("far_pixels", most as f64));
        (holm(&probabilities, level) > 0).then(|| {
            format!(
                "{most} of {} pixels are off by more than {FAR} standard errors; noise of any \
                 distribution would put at most 1 pixel in {} that far off",
                self.values,
                FAR * FAR
            )
        })
    }

    /// `samples` are those of a pixel of both images.
    pub fn judge_contrary(
        &self,
        samples: [u32; 2],
        level: f64,
        metrics: &mut Metrics,
    ) -> Option<String> {
        let [a, b] = samples.map(f64::from);
        metrics.push(("contrary_pixels", self.contrary as f64));
        let each = math::exp(a * math::ln(a / (a + b)) + b * math::ln(b / (a + b)));
        (self.contrary > 0 && each * (3 * self.values) as f64 <= level).then(|| {
            format!(
                "{} pixels and channels differ where neither image has any noise",
                self.contrary
            )
        })
    }

    pub fn judge_copied(&self, level: f64, metrics: &mut Metrics) -> Option<String> {
        metrics.push(("copied_pixels", self.copied as f64));
        // No number of normal noise above its rounding is likelier than 0.4, no number of events
        // other than none likelier than 1/e, no side of a coin thrown twice than 1/2.
        (at_least(self.copied, self.noisy, 0.5) <= level).then(|| {
            let what = if self.copied == self.noisy {
                "it is the same image, not an independent estimate"
            } else {
                "part of it is copied"
            };
            format!(
                "{} of {} noisy pixels are bit-identical to the reference: {what}",
                self.copied, self.noisy
            )
        })
    }
}

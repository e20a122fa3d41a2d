//! Opacity of images without noise: a fourth channel, compared where both images have it.
//!
//! Many programs write 1 everywhere, because a display shows nothing through their picture, or leave 0 everywhere.
//! Such a channel says nothing of the volume: it is compared only where [a case asks for
//! opacity](super::Conditions::opacity).

use super::outliers::Outliers;
use crate::film::Film;
use crate::math::Sum;

/// Comparison of the opacity of two images.
pub(super) struct OpacityDifference {
    /// In tolerances.
    pub pixels: Outliers,
    /// Mean of test minus reference.
    pub mean: f64,
    /// Mean of the reference.
    pub golden: f64,
}

impl OpacityDifference {
    /// Sentence on an opacity that is off: more than the share `outliers` of the pixels, or one pixel by more than `cap`
    /// tolerances, or the mean by more than `of_mean` allows for the mean of the reference.
    pub fn in_words(
        &self,
        width: usize,
        outliers: f64,
        cap: f64,
        of_mean: fn(f64) -> f64,
    ) -> Option<String> {
        let (share, (at, worst)) = (self.pixels.share(), self.pixels.worst);
        let is_off = share > outliers || worst > cap || self.mean.abs() > of_mean(self.golden);
        is_off.then(|| {
            format!(
                "the colours agree; the opacity of {} of {} pixels ({:.3} %) differs by more than 0.001 + 1 %. \
                 The worst is ({}, {}); the mean is too {} by {:.3e}",
                self.pixels.outside,
                self.pixels.count,
                100.0 * share,
                at % width,
                at / width,
                if self.mean > 0.0 { "high" } else { "low" },
                self.mean.abs()
            )
        })
    }
}

/// The opacity of `film`, unless it is the same 0 or 1 everywhere, which says nothing of the volume.
pub(crate) fn stated(film: &Film) -> Option<&[f32]> {
    let opacity = film.opacity()?;
    let is_all = |value: f32| opacity.iter().all(|&opacity| opacity == value);
    (!is_all(0.0) && !is_all(1.0)).then_some(opacity)
}

/// Largest rounding of the opacity of `film`: codes of 8 bits are linear in opacity, whatever the curve of the colours.
pub(crate) fn rounding(film: &Film) -> f64 {
    film.quantisation().map_or(0.0, |_| 0.5 / 255.0)
}

/// The comparison, by the `tolerance` of each value; `None` where an image has no opacity, or where that of `test` is
/// all 0 or all 1 and not `asked` for.
pub(super) fn difference(
    reference: &Film,
    test: &Film,
    asked: bool,
    tolerance: fn(f64) -> f64,
) -> Option<OpacityDifference> {
    let golden = reference.opacity()?;
    let opacity = if asked {
        test.opacity()?
    } else {
        stated(test)?
    };
    let rounding = rounding(test);
    let off = |(&golden, &test): (&f32, &f32)| {
        let off = f64::from(test) - f64::from(golden);
        off.signum() * (off.abs() - rounding).max(0.0)
    };
    let excess = |pair: (&f32, &f32)| match off(pair).abs() / tolerance(f64::from(*pair.0)) {
        excess if excess.is_nan() => f64::INFINITY,
        excess => excess,
    };
    let pairs = || golden.iter().zip(opacity);
    let mean = |sum: Sum| sum.value() / golden.len() as f64;
    Some(OpacityDifference {
        pixels: Outliers::of(pairs().map(excess)),
        mean: mean(pairs().map(off).collect()),
        golden: mean(golden.iter().copied().map(f64::from).collect()),
    })
}

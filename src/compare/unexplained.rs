//! The share of a difference that a hypothesis leaves unexplained.
//!
//! A test image differs from the golden by a squared distance D(golden, test), noise taken out. A
//! prediction of the test image, by a mistake that may have been made or by parameters that were fitted,
//! leaves D(prediction, test) of it. The ratio is what is not explained: about 0 if the hypothesis
//! is the right one, 1 if it says nothing of the image, more if it moves away from it. Both
//! distances are estimates where pixels have noise, so the share has a bound on either side.

use super::opacity;
use crate::film::Film;

/// The largest share of the squared difference that a hypothesis may leave unexplained, where there
/// is no noise.
///
/// Whoever makes a mistake makes it in a way of their own, which need not be the catalogue's to the
/// digit: a seventh of the difference, root mean square, is left to that. A size that is off by
/// other than the catalogue's factor 1 + e leaves the square of what it lacks of e. Among the faults outside the
/// catalogue that the tests keep (`outside_faults`), the one nearest to a mistake leaves a little more: a quarter
/// of a voxel in the volume beside half a pixel in the image.
pub(crate) const UNEXPLAINED: f64 = 0.02;

/// [`UNEXPLAINED`] for images with noise, where the share has to be shown to be that small, beyond
/// [`BOUND`] standard errors: of the right mistake nothing is left but that bound. Less than a
/// quarter of the difference, root mean square.
pub(crate) const UNEXPLAINED_IN_NOISE: f64 = 0.05;

/// Largest share of the squared difference that a mistake may leave, beyond doubt, if the scene with it agrees with the
/// image. A prediction as far from the image as from the golden explains nothing. A wrong mistake in the right
/// direction, of a random size, leaves a half.
pub(crate) const MOST_IN_NOISE: f64 = 0.4;

/// Standard errors of a bound: beyond it is one chance in forty.
pub(crate) const BOUND: f64 = 2.0;

/// A squared distance of two images, noise taken out: an estimate without bias, which may fall below
/// 0 where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SquaredDistance {
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

impl SquaredDistance {
    /// Upper bound, wrong by chance once in forty.
    pub fn at_most(&self) -> f64 {
        self.value.max(0.0) + BOUND * self.error
    }

    /// Lower bound, wrong by chance once in forty.
    pub fn at_least(&self) -> f64 {
        (self.value - BOUND * self.error).max(0.0)
    }

    /// True if a hypothesis that leaves this of `whole` explains the rest beyond doubt: at most
    /// `share` is left. Where there was no difference, the hypothesis may not make one.
    pub fn is_explained(&self, whole: &SquaredDistance, share: f64) -> bool {
        if whole.at_least() > 0.0 {
            self.at_most() <= share * whole.at_least()
        } else {
            self.at_least() <= share * whole.at_most()
        }
    }
}

/// True if `prediction` makes what `test` shows beside `nothing`, the image in which nothing is drawn: at most
/// [`UNEXPLAINED`] of its squares is left. Two images that are within the tolerance of black agree with each other, and
/// neither explains the other. An opacity that `test` states counts as its colours do.
pub(crate) fn makes_what_shows(prediction: &Film, test: &Film, nothing: &Film) -> bool {
    let [left, shown] = [prediction, nothing].map(|film| squared_difference(film, test));
    let of_opacity = |film: &Film| Some(squared_difference_of_opacity(film.opacity()?, test));
    let opacity = of_opacity(prediction).zip(of_opacity(nothing));
    let is_opacity_made = opacity.is_none_or(|(left, shown)| left <= UNEXPLAINED * shown);
    shown > 0.0 && left <= UNEXPLAINED * shown && is_opacity_made
}

/// Sum of the squared differences of the colours of `test` from `film`, of the same size, beyond rounding and noise.
pub(crate) fn squared_difference(film: &Film, test: &Film) -> f64 {
    let nearest = test.nearest_to(film);
    let pixels = film.radiance().iter().zip(nearest.radiance());
    let squares = pixels.enumerate().flat_map(|(index, (a, b))| {
        [0, 1, 2].map(|c| {
            let difference = f64::from(b[c]) - f64::from(a[c]);
            difference * difference - test.variance_at(index, c)
        })
    });
    squares.sum()
}

/// The same of an opacity, where `test` states one.
fn squared_difference_of_opacity(opacity: &[f32], test: &Film) -> f64 {
    let values = opacity
        .iter()
        .zip(opacity::stated(test).unwrap_or_default());
    let beyond =
        |(a, b): (&f32, &f32)| (f64::from((a - b).abs()) - opacity::rounding(test)).max(0.0);
    values.map(beyond).map(|it| it * it).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(value: f64, error: f64) -> SquaredDistance {
        SquaredDistance { value, error }
    }

    #[test]
    fn a_share_counts_only_as_far_as_it_is_known() {
        let whole = distance(1.0, 0.01);
        assert!(distance(0.01, 0.001).is_explained(&whole, 0.02));
        // Perhaps; but nobody knows.
        let doubtful = distance(0.01, 0.02);
        assert!(!doubtful.is_explained(&whole, 0.02));
        // An estimate below 0 is no better than one of 0.
        assert!(!distance(-0.04, 0.02).is_explained(&whole, 0.02));
    }

    /// Faint images are within the tolerance of each other, and none makes what the other shows.
    #[test]
    fn an_explanation_makes_what_the_image_shows() {
        let image = |light: f32, opacity: f32| {
            let pixel = |index: usize| {
                let share = index as f32 / 64.0;
                [light * share, light * share, light * share, opacity * share]
            };
            Film::with_opacity(8, 8, (0..64).map(pixel).collect())
        };
        let (test, nothing) = (image(4e-4, 0.1), image(0.0, 0.0));
        assert!(makes_what_shows(&test, &test, &nothing));
        assert!(makes_what_shows(&image(4.1e-4, 0.1), &test, &nothing));
        assert!(!makes_what_shows(&image(5e-4, 0.1), &test, &nothing));
        assert!(!makes_what_shows(&nothing, &test, &nothing));
        // The colours are right, and the opacity says another thing.
        assert!(!makes_what_shows(&image(4e-4, 0.01), &test, &nothing));
        let without = image(4e-4, 0.0).without_opacity();
        assert!(makes_what_shows(&image(4e-4, 0.01), &without, &nothing));
        assert!(!makes_what_shows(&nothing, &nothing, &nothing));
    }

    #[test]
    fn no_difference_is_to_stay_none() {
        let none = distance(0.0, 0.0);
        assert!(distance(0.0, 0.0).is_explained(&none, 0.02));
        assert!(!distance(1e-3, 0.0).is_explained(&none, 0.02));
    }
}

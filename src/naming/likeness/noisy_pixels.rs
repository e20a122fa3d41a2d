//! Mistakes of the image in the pixels of an image with noise: what moves light within a block shows in no block.

use super::kept_values::KeptValues;
use crate::compare::cells::{Cells, Misfit};
use crate::compare::unexplained::MOST_IN_NOISE;
use crate::film::Film;

/// Golden and image with noise, pixel by pixel.
pub(super) struct NoisyPixels {
    golden: Cells,
    test: Cells,
    from_golden: Misfit,
    kept: KeptValues,
}

impl NoisyPixels {
    /// Pixels of a `golden` and of a `test` image with noise, of which the file holds the `kept` values.
    pub fn of(golden: &Film, test: &Film, kept: KeptValues) -> NoisyPixels {
        let golden = Cells::of_pixels(&kept.film(golden));
        let test = Cells::of_pixels(test);
        NoisyPixels {
            from_golden: golden.misfit(&test, &golden),
            kept,
            golden,
            test,
        }
    }

    /// Misfit of a `film` made of the golden to the image, if it leaves no more than `share` of the pixels with noise,
    /// beyond doubt, and is not contradicted elsewhere. By the brighter of golden and test, pixels that noise made dark
    /// weigh most: these weights may leave as much as noise makes of them.
    pub fn explained_by(&self, film: &Film, share: f64) -> Option<Misfit> {
        let predicted = Cells::of_pixels(&self.kept.film(film));
        let fits = predicted.has_size_of(&self.golden);
        let misfit = fits.then(|| predicted.misfit(&self.test, &self.golden))?;
        let whole = &self.from_golden;
        let mut others = misfit.by_other_weights.iter().zip(&whole.by_other_weights);
        let explains = whole.parts[0].at_least() > 0.0
            && misfit.parts[0].is_explained(&whole.parts[0], share)
            && misfit.may_explain(whole, share)
            && others.all(|(left, whole)| left.may_be_explained(whole, MOST_IN_NOISE));
        explains.then_some(misfit)
    }
}

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
    /// The same in blocks: they have less noise, which tells what is left in dark parts and of dark images.
    golden_blocks: Cells,
    test_blocks: Cells,
    blocks_from_golden: Misfit,
    kept: KeptValues,
}

impl NoisyPixels {
    /// Pixels of a `golden` and of a `test` image with noise, of which the file holds the `kept` values.
    pub fn of(golden: &Film, test: &Film, kept: KeptValues) -> NoisyPixels {
        let films = [&kept.film(golden), test];
        let [golden, test] = films.map(Cells::of_pixels);
        let [golden_blocks, test_blocks] = films.map(Cells::of_blocks);
        // Neighbours that a filter mixed share their noise: a block of them has more than their variances add up to.
        let test_blocks = test_blocks.guarded_by(&golden_blocks);
        NoisyPixels {
            from_golden: golden.misfit(&test, &golden),
            blocks_from_golden: golden_blocks.misfit(&test_blocks, &golden_blocks),
            golden,
            test,
            golden_blocks,
            test_blocks,
            kept,
        }
    }

    /// Misfit of a `film` made of the golden to the image, if it leaves no more than `share` of the pixels with noise,
    /// beyond doubt, and is not contradicted elsewhere or in blocks. By the brighter of golden and test, pixels that
    /// noise made dark weigh most: these weights may leave as much as noise makes of them.
    pub fn explained_by(&self, film: &Film, share: f64) -> Option<Misfit> {
        let film = self.kept.film(film);
        let predicted = Cells::of_pixels(&film);
        let fits = predicted.has_size_of(&self.golden);
        let misfit = fits.then(|| predicted.misfit(&self.test, &self.golden))?;
        let whole = &self.from_golden;
        let mut others = misfit.by_other_weights.iter().zip(&whole.by_other_weights);
        let explains = whole.parts[0].at_least() > 0.0
            && misfit.parts[0].is_explained(&whole.parts[0], share)
            && misfit.may_explain(whole, share)
            && others.all(|(left, whole)| left.may_be_explained(whole, MOST_IN_NOISE))
            && misfit.is_nearer_than_black(share)
            && (Cells::of_blocks(&film).misfit(&self.test_blocks, &self.golden_blocks))
                .is_possible(&self.blocks_from_golden, share);
        explains.then_some(misfit)
    }
}

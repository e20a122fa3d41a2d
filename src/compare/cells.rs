//! Images averaged over coarse cells, and the distance of two of them beyond their noise.
//!
//! Where pixels are means of random samples, a cell is a block of 8 × 8 of them: its noise is an
//! eighth of theirs, and what a mistake would look like is known at little cost, since an image of
//! an eighth of the size shows the means of blocks as they are. Without random numbers a cell is a
//! pixel.

use crate::compare::stochastic::{BLOCK, DARK};
use crate::compare::unexplained::SquaredDistance;
use crate::film::Film;
use crate::math::Sum;

/// A grid of cells: their means, and the variances of those.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    pub columns: usize,
    pub rows: usize,
    means: Vec<[f64; 3]>,
    variances: Vec<[f64; 3]>,
    /// By cell, true if most of its pixels have no noise, in an image that states its noise.
    silent: Vec<bool>,
    /// Random samples in a cell; `None` if unknown.
    samples: Option<f64>,
    /// True if those are renderings, of samples that are not counted.
    is_of_renderings: bool,
}

/// Distance of an image from the prediction of a mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Misfit {
    /// Mean of the squared differences over their variance, each cut at [`FAR`]: about 1 if the
    /// mistake is the one.
    pub in_noise: f64,
    /// Mean squared relative difference of the cells with noise, and of those without: a lamp that
    /// is seen, or the sky. Noise-free pixels are judged apart: any difference there is many standard errors.
    pub parts: [SquaredDistance; 2],
    /// Mean squared differences of all cells by other weights: absolute ones, and relative to the brighter
    /// of golden and test. Where the golden is dark and the test bright, relative to the golden the rest stops
    /// to count.
    pub by_other_weights: [SquaredDistance; 2],
    /// Squared distance of the test image from black, relative to the brighter of golden and test.
    pub test_from_black: SquaredDistance,
    /// Standard error of the distance, were the images the same but for their noise.
    pub least_error: f64,
    /// True if one of the images has noise.
    pub has_noise: bool,
    /// Gain of the [`Amount`] by which the prediction changes the golden; 0 where it was not asked for.
    pub gain: f64,
}

/// Part of a change that an image has: the coefficient of its difference from the golden on that change, by least
/// squares over all tiles with noise together. A change that is small in every block shows in their sum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Amount {
    /// 0 for none of it, and 1 for all.
    pub value: f64,
    /// Standard error of that.
    pub error: f64,
    /// Decrease of the squared difference by the change, in variances.
    pub gain: f64,
}

/// Edges in cells of the tiles in which a change is looked for: what is all over the image shows best in large ones,
/// of which a few tens are left for its shape.
const TILES: [usize; 3] = [1, 2, 4];

/// Largest squared difference that counts for one cell, in variances, so that a few cells of rare
/// bright paths do not decide.
const FAR: f64 = 25.0;

/// Largest mean of squares at which the difference counts as noise: variances are estimates, and
/// the stochastic gate lets as much pass.
const NOISE: f64 = 2.0;

/// Standard errors beyond which a cell differs: by chance one value in 370 does.
const SHOWS: f64 = 3.0;

/// Relative rounding error of half precision, in which most renderers write: a difference of cells
/// without noise that is no larger is none.
const HALF_ROUNDING: f64 = 1.0 / 2048.0;

impl Misfit {
    /// True if the difference is no more than noise.
    pub fn is_noise(&self) -> bool {
        self.in_noise <= NOISE
    }

    /// Mean squared relative difference, noise taken out: about 0 if the mistake is the one.
    pub fn distance(&self) -> SquaredDistance {
        self.parts[0].plus(&self.parts[1])
    }

    /// Key by which hypotheses that explain an image are ordered, the nearest first: the distance, and in noise, which
    /// hides it, the squares in variances.
    pub fn remoteness(&self) -> f64 {
        if self.has_noise {
            self.in_noise
        } else {
            self.distance().at_most()
        }
    }

    /// True if a hypothesis with this misfit explains, beyond doubt, all but a `share` of `whole`, the
    /// misfit of the golden: in the cells with noise and in all together, and not contradicted in those without
    /// noise or by other weights. Where the golden has no noise the image may have some, and a prediction of it.
    pub fn explains(&self, whole: &Misfit, share: f64) -> bool {
        self.parts[0].is_explained(&whole.parts[0], share)
            && self.is_possible(whole, share)
            && self.explains_together(whole, share)
    }

    /// True if, by no weights and in no part, more than a `share` of `whole` is left beyond doubt.
    pub fn is_possible(&self, whole: &Misfit, share: f64) -> bool {
        let mut others = self.by_other_weights.iter().zip(&whole.by_other_weights);
        self.may_explain(whole, share)
            && others.all(|(left, whole)| left.may_be_explained(whole, share))
            && self.is_nearer_than_black(share)
    }

    /// True if no more than a `share` of what the test image is more than black is left, beyond doubt: a dark image is
    /// not explained by any other dark one.
    pub fn is_nearer_than_black(&self, share: f64) -> bool {
        self.by_other_weights[1].may_be_explained(&self.test_from_black, share)
    }

    /// [`explains`](Misfit::explains) by all cells together, where neither part contradicts: cells
    /// without noise may be a single lamp, of which too little is known to prove anything.
    pub fn explains_together(&self, whole: &Misfit, share: f64) -> bool {
        whole.distance().at_least() > 0.0
            && self.may_explain(whole, share)
            && self.distance().is_explained(&whole.distance(), share)
    }

    /// The share of `whole`, the misfit of the golden, that is left; `None` if that is NaN.
    pub fn share_of(&self, whole: &Misfit) -> Option<f64> {
        Some(self.distance().value / whole.distance().value).filter(|share| share.is_finite())
    }

    /// True if a closer look may show that the hypothesis explains the image.
    pub fn may_explain(&self, whole: &Misfit, share: f64) -> bool {
        let mut parts = self.parts.iter().zip(&whole.parts);
        parts.all(|(left, whole)| left.may_be_explained(whole, share))
    }
}

impl Cells {
    /// Cells of one pixel each.
    pub fn of_pixels(film: &Film) -> Cells {
        Cells::with_edge(film, 1)
    }

    /// Cells of 8 × 8 pixels; incomplete blocks at the edges are left out. An image too small for a
    /// block has cells of one pixel.
    pub fn of_blocks(film: &Film) -> Cells {
        match film.width().min(film.height()) {
            0..BLOCK => Cells::with_edge(film, 1),
            _ => Cells::with_edge(film, BLOCK),
        }
    }

    fn with_edge(film: &Film, edge: usize) -> Cells {
        let (columns, rows) = (film.width() / edge, film.height() / edge);
        let count = (edge * edge) as f64;
        let is_known = film.noise().is_some_and(|noise| noise.is_known());
        let mut means = Vec::with_capacity(columns * rows);
        let mut variances = Vec::with_capacity(columns * rows);
        let mut silent = Vec::with_capacity(columns * rows);
        for cell in 0..columns * rows {
            let corner = [cell % columns * edge, cell / columns * edge];
            let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
            let mut without_noise = 0;
            for y in corner[1]..corner[1] + edge {
                for index in (corner[0]..corner[0] + edge).map(|x| x + film.width() * y) {
                    let noise = film.noise().map(|noise| noise.variance()[index]);
                    without_noise += usize::from(!is_known && noise == Some([0.0; 3]));
                    for c in 0..3 {
                        mean[c] += f64::from(film.radiance()[index][c]) / count;
                        if let Some(noise) = film.noise() {
                            variance[c] += f64::from(noise.variance()[index][c]) / (count * count);
                        }
                    }
                }
            }
            if film.noise().is_none() && edge > 1 {
                variance = guessed_variance(film, corner, edge).map(|variance| variance / count);
            }
            means.push(mean);
            variances.push(variance);
            silent.push(2 * without_noise > edge * edge);
        }
        let samples = film.noise().map(|noise| f64::from(noise.samples()) * count);
        let is_of_renderings = film.noise().is_some_and(|noise| noise.is_of_renderings());
        Cells {
            is_of_renderings,
            columns,
            rows,
            means,
            variances,
            silent,
            samples,
        }
    }

    /// Raises guessed variances: each block has at least its part of the noise, if that is spread
    /// over the image as in `reference`, since a block without rare samples seems to have none.
    pub fn spread_noise_like(&mut self, reference: &Cells) {
        for c in 0..3 {
            let sum = |cells: &Cells| -> f64 { cells.variances.iter().map(|v| v[c]).sum() };
            let ratio = sum(self) / sum(reference);
            if !ratio.is_finite() {
                continue;
            }
            for (own, due) in self.variances.iter_mut().zip(&reference.variances) {
                own[c] = own[c].max(ratio * due[c]);
            }
        }
    }

    /// The same image without noise of its own.
    pub fn without_noise(mut self) -> Cells {
        self.variances.fill([0.0; 3]);
        self
    }

    /// The cells as pixels. Renderings that do not count their samples state no noise: how many samples
    /// are in a cell is not known.
    pub fn film(&self) -> Film {
        let narrow = |values: &[[f64; 3]]| values.iter().map(|v| v.map(|x| x as f32)).collect();
        let (columns, rows, means) = (self.columns, self.rows, narrow(&self.means));
        match self.samples.filter(|_| !self.is_of_renderings) {
            Some(samples) => {
                let samples = samples.min(f64::from(u32::MAX)) as u32;
                Film::with_noise(columns, rows, means, narrow(&self.variances), samples)
            }
            None => Film::new(columns, rows, means),
        }
    }

    /// These cells with other values: a `map` of each, by its channel, to a value and the slope there.
    pub fn mapped(&self, map: impl Fn(f64, usize) -> (f64, f64)) -> Cells {
        let mut mapped = self.clone();
        for (means, variances) in mapped.means.iter_mut().zip(&mut mapped.variances) {
            for c in 0..3 {
                let (value, slope) = map(means[c], c);
                (means[c], variances[c]) = (value, variances[c] * slope * slope);
            }
        }
        mapped
    }

    /// Squared differences of `test` by cell, noise taken out, weighed as in [`misfit`](Self::misfit).
    pub fn squares_left(&self, test: &Cells, golden: &Cells) -> Vec<f64> {
        let noise_over_golden = test.noise_over(golden);
        let of_cell = |cell: usize| {
            let of_channel = |c: usize| {
                let difference = test.means[cell][c] - self.means[cell][c];
                let noise = self.variances[cell][c] + test.variances[cell][c];
                golden.weight(cell, c, noise_over_golden) * (difference * difference - noise)
            };
            (0..3).map(of_channel).sum()
        };
        (0..self.means.len()).map(of_cell).collect()
    }

    /// True if there are as many cells in each row and column.
    pub fn has_size_of(&self, other: &Cells) -> bool {
        (self.columns, self.rows) == (other.columns, other.rows)
    }

    /// The means of all channels of all cells.
    pub fn values(&self) -> Vec<f64> {
        self.means.as_flattened().to_vec()
    }

    /// The weights of squared differences from `test`, of all channels of all cells of this golden.
    pub fn weights(&self, test: &Cells) -> Vec<f64> {
        let noise = test.noise_over(self);
        let channels = (0..self.means.len()).flat_map(|cell| (0..3).map(move |c| (cell, c)));
        channels
            .map(|(cell, c)| self.weight(cell, c, noise))
            .collect()
    }

    /// These cells with at least the noise that an image of as many samples has by the noise of the
    /// `golden`: few samples that missed the light seem to have none.
    pub fn guarded_by(&self, golden: &Cells) -> Cells {
        let mut guarded = self.clone();
        for (cell, variances) in guarded.variances.iter_mut().enumerate() {
            for (c, variance) in variances.iter_mut().enumerate() {
                *variance = golden.variance_with(self, cell, c) - golden.variances[cell][c];
            }
        }
        guarded
    }

    /// True for each cell in which `other` differs from this by more than [`SHOWS`] standard errors.
    pub fn differs_from(&self, other: &Cells) -> Vec<bool> {
        let differs = |cell: usize| {
            (0..3).any(|c| {
                let difference = self.means[cell][c] - other.means[cell][c];
                let variance = self.variances[cell][c] + other.variances[cell][c];
                difference * difference > SHOWS * SHOWS * variance
            })
        };
        (0..self.means.len()).map(differs).collect()
    }

    /// The cells that are `kept`, in one row.
    pub fn only(&self, kept: &[bool]) -> Cells {
        fn only<T: Copy>(values: &[T], kept: &[bool]) -> Vec<T> {
            let values = values.iter().zip(kept).filter(|(_, kept)| **kept);
            values.map(|(value, _)| *value).collect()
        }
        let means = only(&self.means, kept);
        Cells {
            columns: means.len(),
            rows: 1,
            means,
            variances: only(&self.variances, kept),
            silent: only(&self.silent, kept),
            samples: self.samples,
            is_of_renderings: self.is_of_renderings,
        }
    }

    /// [`Amount`] of the change from `golden` to these cells that `test` has, in tiles of the edge that tells it best.
    /// `None` where the change is lost in noise.
    pub fn amount_in(&self, test: &Cells, golden: &Cells) -> Option<Amount> {
        let terms = |cell: usize, c: usize| {
            let base = golden.means[cell][c];
            let [change, difference] = [self, test].map(|it| it.means[cell][c] - base);
            let shared = golden.variances[cell][c];
            let own = golden.variance_with(self, cell, c) - shared;
            let noise = golden.variance_with(test, cell, c) + own;
            [change, difference, own, shared, noise]
        };
        let amounts = TILES.map(|edge| golden.amount_by_tiles(edge, terms));
        let amounts = amounts.into_iter().flatten();
        amounts.min_by(|a, b| a.error.total_cmp(&b.error))
    }

    /// Gain of the change from `before` to these cells, rendered with the same random numbers: where these are used
    /// alike, the change is known much better than either. Its noise counts as a change.
    pub fn gain_over(&self, before: &Cells, test: &Cells, golden: &Cells) -> f64 {
        let terms = |cell: usize, c: usize| {
            let change = self.means[cell][c] - before.means[cell][c];
            let difference = test.means[cell][c] - golden.means[cell][c];
            let noise = golden.variance_with(test, cell, c);
            [change, difference, 0.0, 0.0, noise]
        };
        let amount = golden.amount_by_tiles(TILES[TILES.len() - 1], terms);
        amount.map_or(0.0, |amount| amount.gain)
    }

    /// [`Amount`] of a change by its terms, by cell and channel: change, difference, the variances of the prediction and
    /// of the golden, which both share, and that of all.
    fn amount_by_tiles(
        &self,
        edge: usize,
        terms: impl Fn(usize, usize) -> [f64; 5],
    ) -> Option<Amount> {
        let (mut in_test, mut in_change) = (Sum::default(), Sum::default());
        let (mut error_in_test, mut error_in_change) = (Sum::default(), Sum::default());
        let columns = self.columns.div_ceil(edge);
        for tile in 0..columns * self.rows.div_ceil(edge) {
            let corner = [tile % columns * edge, tile / columns * edge];
            let [width, height] = [self.columns, self.rows];
            let cells = (corner[1]..(corner[1] + edge).min(height))
                .flat_map(|y| (corner[0]..(corner[0] + edge).min(width)).map(move |x| (x, y)))
                .map(|(x, y)| x + width * y)
                .filter(|&cell| !self.silent[cell]);
            let mut sums = [[0.0; 5]; 3];
            for cell in cells {
                for (c, sums) in sums.iter_mut().enumerate() {
                    let terms = terms(cell, c);
                    sums.iter_mut().zip(terms).for_each(|(sum, it)| *sum += it);
                }
            }
            let (mut of_test, mut of_change) = (0.0, 0.0);
            for [change, difference, own, shared, noise] in sums {
                if noise <= 0.0 {
                    continue;
                }
                in_test.add((change * difference - shared) / noise);
                in_change.add((change * change - shared - own) / noise);
                // The channels may share their noise: their errors add up.
                of_test += change.abs() / noise.sqrt();
                let of_both = own + shared;
                of_change += (of_both * (2.0 * of_both + 4.0 * change * change)).sqrt() / noise;
            }
            error_in_test.add(of_test * of_test);
            error_in_change.add(of_change * of_change);
        }
        let [size, error] = [in_change.value(), error_in_change.value().sqrt()];
        let value = in_test.value() / size;
        (size > 0.0).then(|| Amount {
            value,
            error: (error_in_test.value() + value * value * error * error).sqrt() / size,
            gain: 2.0 * in_test.value() - size,
        })
    }

    /// These cells as noisy as `other` ones.
    pub fn with_noise_of(&self, other: &Cells) -> Cells {
        Cells {
            means: self.means.clone(),
            ..other.clone()
        }
    }

    /// This golden with the noise of `renderings`, all of one size, added: cells in which
    /// predictions are uncertain weigh little.
    pub fn beside_noise_of(&self, renderings: &[Cells]) -> Cells {
        let mut scale = self.clone();
        let number = renderings.len() as f64;
        for rendering in renderings {
            let variances = scale.variances.as_flattened_mut().iter_mut();
            for (variance, of_rendering) in variances.zip(rendering.variances.as_flattened()) {
                *variance += of_rendering / (number * number);
            }
        }
        scale
    }

    /// This golden with the effect of a change added, taken from renderings with the same random
    /// numbers: one `before` and `after` for each seed, all of one size. The noise of the effect is
    /// proportional to that of the renderings, by as much as seeds differ.
    pub fn moved(&self, before: &[Cells], after: &[Cells]) -> Cells {
        let mut moved = self.clone();
        let seeds = after.len() as f64;
        let (mut apart, mut of_renderings) = (0.0, 0.0);
        let mut noise = Vec::with_capacity(3 * self.means.len());
        for (cell, means) in moved.means.iter_mut().enumerate() {
            for (c, mean) in means.iter_mut().enumerate() {
                let ways = || {
                    let pairs = after.iter().zip(before);
                    pairs.map(|(after, before)| after.means[cell][c] - before.means[cell][c])
                };
                let way = ways().sum::<f64>() / seeds;
                *mean += way;
                let stated = after.iter().map(|after| after.variances[cell][c]);
                let of_cell = stated.sum::<f64>() / (seeds * seeds);
                noise.push(of_cell);
                let weight = self.weight(cell, c, 0.0);
                of_renderings += weight * of_cell;
                if seeds > 1.0 {
                    let squares = ways().map(|one| (one - way) * (one - way));
                    apart += weight * squares.sum::<f64>() / (seeds * (seeds - 1.0));
                }
            }
        }
        if apart > 0.0 && of_renderings > 0.0 {
            let ratio = apart / of_renderings;
            let variances = moved.variances.as_flattened_mut().iter_mut();
            for (variance, noise) in variances.zip(noise) {
                *variance += ratio * noise;
            }
        }
        // From the samples of the golden and of the renderings.
        moved.samples = None;
        moved
    }

    /// Misfit of `test` to `self`, relative to the brightness of `golden`; all of one size. The
    /// weights of cells are the same for every `self`, so that distances may be compared.
    pub fn misfit(&self, test: &Cells, golden: &Cells) -> Misfit {
        let noise_over_golden = test.noise_over(golden);
        let mean_brightness = golden.mean_brightness();
        let mut in_noise = Sum::default();
        let mut sums = [PartSums::default(); 2];
        let mut by_other_weights = [PartSums::default(); 2];
        let mut test_from_black = PartSums::default();
        let mut least_squares = Sum::default();
        for cell in 0..self.means.len() {
            let part = &mut sums[usize::from(golden.silent[cell])];
            let (mut square, mut noise_of_square, mut least) = (0.0, 0.0, 0.0);
            let mut others = [[0.0; 2]; 2];
            let (mut from_black, mut noise_from_black) = (0.0, 0.0);
            for c in 0..3 {
                let (a, b) = (self.means[cell][c], test.means[cell][c]);
                let size = a.abs().max(b.abs());
                // Each pixel was rounded to 32 bits.
                let rounding = f64::from(f32::EPSILON) * size;
                let guarded = self.variance_with(test, cell, c) + rounding * rounding;
                let difference = (a - b) * (a - b);
                let ratio = if difference == 0.0 {
                    0.0
                } else {
                    difference / guarded
                };
                in_noise.add(ratio.min(FAR));
                let due = golden.due_variance(cell, c, noise_over_golden);
                let bright = golden.means[cell][c].abs();
                let [weight, absolute, of_brighter] =
                    [bright, mean_brightness, bright.max(b.abs())].map(|it| weight_of(it, due));
                let stated = self.variances[cell][c] + test.variances[cell][c];
                let stated = stated + rounding * rounding;
                let coarse = if golden.silent[cell] && golden.samples.is_some() {
                    HALF_ROUNDING * size
                } else {
                    0.0
                };
                let beyond = difference - stated;
                let counts = beyond > coarse * coarse;
                let beyond_rounding = if counts { beyond } else { beyond.min(0.0) };
                square += weight * beyond_rounding;
                // The square of a normal number of mean m has the variance 2 v² + 4 v m².
                let spread = guarded * (2.0 * guarded + 4.0 * beyond.max(0.0));
                // The channels of a cell may share their noise: their errors add up.
                noise_of_square += weight * spread.sqrt();
                least += weight * std::f64::consts::SQRT_2 * guarded;
                for (other, weight) in others.iter_mut().zip([absolute, of_brighter]) {
                    other[0] += weight * beyond_rounding;
                    other[1] += weight * spread.sqrt();
                }
                let noise = test.variances[cell][c];
                from_black += of_brighter * (b * b - noise);
                noise_from_black += of_brighter * (noise * (2.0 * noise + 4.0 * b * b)).sqrt();
            }
            test_from_black.add(from_black, noise_from_black);
            least_squares.add(least * least);
            part.add(square, noise_of_square);
            for (sums, [square, noise]) in by_other_weights.iter_mut().zip(others) {
                sums.add(square, noise);
            }
        }
        let cells = self.means.len() as f64;
        let has_noise = golden.samples.is_some() || test.samples.is_some();
        Misfit {
            in_noise: in_noise.value() / (3.0 * cells),
            parts: [
                sums[0].distance(cells, has_noise),
                sums[1].distance(cells, false),
            ],
            by_other_weights: by_other_weights.map(|sums| sums.distance(cells, has_noise)),
            test_from_black: test_from_black.distance(cells, has_noise),
            least_error: least_squares.value().sqrt() / (3.0 * cells),
            has_noise,
            gain: 0.0,
        }
    }

    /// The weight of a squared difference in a cell of this golden, from which the noise of a test
    /// image is this much times that of the golden. By the noise of the golden alone: that of the
    /// test image is smaller where it happens to be dark.
    fn weight(&self, cell: usize, c: usize, noise_over_golden: f64) -> f64 {
        let due = self.due_variance(cell, c, noise_over_golden);
        weight_of(self.means[cell][c].abs(), due)
    }

    /// Variance of the difference of a test image from this golden, by the noise of the golden.
    fn due_variance(&self, cell: usize, c: usize, noise_over_golden: f64) -> f64 {
        self.variances[cell][c] * (1.0 + noise_over_golden)
    }

    /// Mean of all values.
    fn mean_brightness(&self) -> f64 {
        let values = self.means.as_flattened();
        values.iter().map(|value| value.abs()).sum::<f64>() / values.len() as f64
    }

    /// Variance of all of `self` over that of `golden`; 0 where neither has any.
    fn noise_over(&self, golden: &Cells) -> f64 {
        let sum = |cells: &Cells| -> f64 { cells.variances.as_flattened().iter().sum() };
        let ratio = sum(self) / sum(golden);
        if ratio.is_finite() { ratio } else { 0.0 }
    }

    /// Variance of the difference of two cells. Whoever has more samples lends its variance, as in
    /// the stochastic gate: few samples that missed the light claim to have no noise.
    fn variance_with(&self, test: &Cells, cell: usize, channel: usize) -> f64 {
        let (own, other) = (self.variances[cell][channel], test.variances[cell][channel]);
        let (Some(own_samples), Some(samples)) = (self.samples, test.samples) else {
            return own + other;
        };
        let lent = other * samples / own_samples;
        let borrowed = own * own_samples / samples;
        if samples > own_samples {
            own.max(lent) + other
        } else {
            own + other.max(borrowed)
        }
    }
}

/// The weight of a squared difference where it is compared with this brightness, and has this variance: a cell
/// of much noise says little of distances.
fn weight_of(bright: f64, variance: f64) -> f64 {
    let bright = bright + DARK;
    1.0 / (bright * bright + 16.0 * variance)
}

/// Sums over the cells of a part of an image.
#[derive(Clone, Copy, Debug, Default)]
struct PartSums {
    squares: Sum,
    /// Sum of their squares.
    spread: Sum,
    /// Sum of their variances by noise.
    noise: Sum,
}

impl PartSums {
    fn add(&mut self, square: f64, noise: f64) {
        self.squares.add(square);
        self.spread.add(square * square);
        self.noise.add(noise * noise);
    }

    /// The distance: a mean over that many `cells`, those of the other part included.
    fn distance(&self, cells: f64, has_noise: bool) -> SquaredDistance {
        // Noise that comes from rare bright paths is no normal number, and what one cell carries
        // alone may be such a path: the error is at least that by which the cells differ.
        let variance = if has_noise {
            self.noise.value().max(self.spread.value())
        } else {
            self.noise.value()
        };
        SquaredDistance {
            value: self.squares.value() / (3.0 * cells),
            error: variance.sqrt() / (3.0 * cells),
        }
    }
}

/// Variance of a pixel within a block of an image that does not state it, by the differences of
/// neighbours that are left when all that is linear is taken away.
///
/// Source: Immerkær 1996, "Fast noise variance estimation", Computer Vision and Image
/// Understanding 64(2), with squares in place of absolute values.
fn guessed_variance(film: &Film, corner: [usize; 2], edge: usize) -> [f64; 3] {
    const MASK: [[f64; 3]; 3] = [[1.0, -2.0, 1.0], [-2.0, 4.0, -2.0], [1.0, -2.0, 1.0]];
    // Sum of the squares of the mask.
    const POWER: f64 = 36.0;
    let mut sums = [0.0; 3];
    let mut count = 0.0;
    for y in corner[1] + 1..corner[1] + edge - 1 {
        for x in corner[0] + 1..corner[0] + edge - 1 {
            count += 1.0;
            for (c, sum) in sums.iter_mut().enumerate() {
                let mut left = 0.0;
                for (row, weights) in MASK.iter().enumerate() {
                    for (column, weight) in weights.iter().enumerate() {
                        let index = x + column - 1 + film.width() * (y + row - 1);
                        left += weight * f64::from(film.radiance()[index][c]);
                    }
                }
                *sum += left * left / POWER;
            }
        }
    }
    sums.map(|sum| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Stream};

    /// Pixels of mean `mean` and a noise of uniform numbers with standard deviation `sigma`.
    fn noisy(mean: f64, sigma: f64, seed: u64, states_noise: bool) -> Film {
        let edge = 64;
        let mut pixels = Vec::new();
        for index in 0..edge * edge {
            let stream = Stream::new(seed, index as u32, 0);
            pixels.push(std::array::from_fn(|channel| {
                let u = stream.uniform(0, Purpose::Camera, channel as u32);
                (mean + (u - 0.5) * sigma * 12_f64.sqrt()) as f32
            }));
        }
        if states_noise {
            let variance = vec![[(sigma * sigma) as f32; 3]; edge * edge];
            Film::with_noise(edge, edge, pixels, variance, 16)
        } else {
            Film::new(edge, edge, pixels)
        }
    }

    #[test]
    fn equal_means_are_noise_and_others_are_not() {
        let scale = Cells::of_blocks(&noisy(1.0, 0.0, 0, true));
        for states in [true, false] {
            let a = Cells::of_blocks(&noisy(1.0, 0.2, 1, states));
            let b = Cells::of_blocks(&noisy(1.0, 0.2, 2, states));
            let same = a.misfit(&b, &scale);
            // 192 squares: their mean is 1 within four times √(2/192).
            assert!((same.in_noise - 1.0).abs() < 0.41, "{same:?}");
            let near = same.distance();
            assert!(near.at_least() == 0.0 && near.at_most() > 0.0, "{same:?}");
            let c = Cells::of_blocks(&noisy(1.1, 0.2, 3, states));
            let other = a.misfit(&c, &scale);
            // A tenth is four standard errors of a difference of blocks.
            assert!(!other.is_noise(), "{other:?}");
            let far = other.distance();
            assert!(
                (far.value - 0.01).abs() < 4.0 * far.error + 2e-3,
                "{other:?}"
            );
            // Whether the one or the other: what makes 1.1 of it explains it, what makes 1 does not.
            let right = Cells::of_blocks(&noisy(1.1, 0.02, 4, true));
            let golden = Cells::of_blocks(&noisy(1.0, 0.02, 5, true));
            let whole = golden.misfit(&c, &golden);
            let left = right.misfit(&c, &golden);
            assert!(left.may_explain(&whole, 0.02), "{left:?} of {whole:?}");
            assert!(!a.misfit(&c, &golden).may_explain(&whole, 0.02));
        }
    }

    #[test]
    fn slopes_are_not_taken_for_noise() {
        let pixels = (0..64)
            .map(|i| [(i % 8) as f32, (i / 8) as f32, 1.0])
            .collect();
        let film = Film::new(8, 8, pixels);
        assert_eq!(guessed_variance(&film, [0, 0], 8), [0.0; 3]);
    }
}

//! Places of the difference between two images: what it lies in more than in others.
//!
//! These are measurements, not causes: they hold whether or not anybody knows what went wrong. A sentence names a place
//! that holds far more of the squared difference than of the pixels, beyond its own uncertainty. The uncertainty comes
//! from leaving out a twentieth of the image at a time (the jackknife; Efron & Stein 1981, Annals of Statistics 9, 586–596).
//!
//! Differences are relative to the brightness of the golden plus its mean, and each sentence says so: a lamp
//! may hold most of the absolute difference and little of the relative one.

use super::stochastic::BLOCK;
use crate::film::{CHANNELS, Film};

/// Parts of the image for the jackknife, each of blocks from all over it.
const PARTS: usize = 20;

/// Smallest measurement that is reported, in standard errors: by chance one in 370 is.
const SIGNIFICANT: f64 = 3.0;

/// Smallest share of the squared difference for which a place is named.
const WORTH_SAYING: f64 = 0.3;

/// Smallest ratio of the odds of that share to the odds of the place's share of the pixels: a fifth of the pixels must hold
/// half of the difference, a half of them four fifths.
const ODDS: f64 = 4.0;

/// Share of the squared difference in one channel, if it is said to lie there: a third would be its due.
const IN_ONE_CHANNEL: f64 = 0.8;

/// Largest share of the squared difference that the golden times a factor for each channel leaves, if that is said.
const LEFT_BY_GAIN: f64 = 0.8;

/// Share of the lit pixels that count as edges.
const STEEPEST: f64 = 0.2;

/// A box that holds the difference is worth saying if it holds no more than this share of the lit
/// pixels.
const PART_OF_IMAGE: f64 = 0.5;

/// Share of the squared difference that is left out of such a box, at each of its four sides.
const OUTSIDE: f64 = 0.01;

/// Sentences, without a full stop, on where `test` differs from `golden`, and how; none where nothing can be measured:
/// other sizes, values that are no numbers, or no difference beyond noise.
pub fn measured(golden: &Film, test: &Film) -> Vec<String> {
    let Some(differences) = Differences::new(golden, test) else {
        return Vec::new();
    };
    let shares = Shares::of(&differences);
    let has_noise = [golden, test].iter().any(|film| film.noise().is_some());
    if shares.whole <= 0.0 || has_noise && shares.whole <= SIGNIFICANT * shares.error {
        return Vec::new();
    }
    let mut said = Vec::new();
    let is_in_one = |c: &usize| shares.channel(*c).is_at_least(IN_ONE_CHANNEL);
    if let Some(c) = (0..3).find(is_in_one) {
        let (share, name) = (left(shares.channel(c).value), CHANNELS[c]);
        said.push(format!(
            "{share} of the squared relative difference is in {name}"
        ));
    }
    if !has_noise {
        said.extend(gain(&differences, shares.whole));
    }
    said.extend(places(&differences, &shares));
    // Noise of single lines would decide where the box ends.
    let unit = if has_noise { BLOCK } else { 1 };
    said.extend(in_a_box(&differences, &shares, unit));
    said
}

/// Differences of pixels, weighed by the brightness of the golden.
struct Differences<'f> {
    golden: &'f Film,
    test: &'f Film,
    /// Mean brightness of the golden.
    mean: f64,
}

impl<'f> Differences<'f> {
    /// The differences; `None` of images that cannot be compared, and where the golden is black.
    fn new(golden: &'f Film, test: &'f Film) -> Option<Differences<'f>> {
        let mean = golden.mean_magnitude().filter(|&mean| mean > 0.0)?;
        let differences = Differences { golden, test, mean };
        golden.is_comparable(test).then_some(differences)
    }

    fn value(&self, i: usize, c: usize) -> f64 {
        f64::from(self.golden.radiance()[i][c])
    }

    fn difference(&self, i: usize, c: usize) -> f64 {
        f64::from(self.test.radiance()[i][c]) - self.value(i, c)
    }

    /// Variance of the difference, as far as it is stated.
    fn variance(&self, i: usize, c: usize) -> f64 {
        self.golden.variance_at(i, c) + self.test.variance_at(i, c)
    }

    /// Weight of a difference: by relative differences, except near black.
    fn weight(&self, i: usize, c: usize) -> f64 {
        let size = self.value(i, c).abs() + self.mean;
        1.0 / (size * size)
    }

    /// Square of the difference, weighed, without that of the noise.
    fn square(&self, i: usize, c: usize) -> f64 {
        let difference = self.difference(i, c);
        self.weight(i, c) * (difference * difference - self.variance(i, c))
    }

    fn squares(&self, i: usize) -> f64 {
        (0..3).map(|c| self.square(i, c)).sum()
    }

    /// True for a pixel at least a tenth as bright as the mean: a background has neither edges nor brightness.
    fn is_lit(&self, i: usize) -> bool {
        (0..3).map(|c| self.value(i, c)).sum::<f64>() > 0.3 * self.mean
    }

    fn lit_pixels(&self) -> Vec<usize> {
        let all = 0..self.golden.radiance().len();
        all.filter(|&i| self.is_lit(i)).collect()
    }

    /// Square of the golden's slope to the pixels beside, weighed.
    fn steepness(&self, i: usize) -> f64 {
        let [width, height] = [self.golden.width(), self.golden.height()];
        let along = |at: usize, count: usize, step: usize, c: usize| {
            let before = if at > 0 { i - step } else { i };
            let after = if at + 1 < count { i + step } else { i };
            let length = ((after - before) / step).max(1) as f64;
            (self.value(after, c) - self.value(before, c)) / length
        };
        let of = |c: usize| {
            let slopes = [
                along(i % width, width, 1, c),
                along(i / width, height, width, c),
            ];
            self.weight(i, c) * slopes.map(|slope| slope * slope).iter().sum::<f64>()
        };
        (0..3).map(of).sum()
    }
}

/// The squared difference by channel, in parts of the jackknife.
struct Shares {
    squares: [[f64; 3]; PARTS],
    part: Vec<usize>,
    whole: f64,
    /// Standard error of the whole.
    error: f64,
}

/// A share of the squared difference, and its standard error.
struct Share {
    value: f64,
    error: f64,
}

impl Share {
    /// True if it is at least this, beyond doubt.
    fn is_at_least(&self, least: f64) -> bool {
        self.value - SIGNIFICANT * self.error >= least
    }
}

impl Shares {
    fn of(differences: &Differences<'_>) -> Shares {
        let width = differences.golden.width();
        // Neighbours in a row and in a column are of different parts.
        let part = |i: usize| (i % width / BLOCK + 7 * (i / width / BLOCK)) % PARTS;
        let part: Vec<usize> = (0..differences.golden.radiance().len()).map(part).collect();
        let mut squares = [[0.0; 3]; PARTS];
        for (i, &part) in part.iter().enumerate() {
            (0..3).for_each(|c| squares[part][c] += differences.square(i, c));
        }
        let wholes = squares.map(|of| of.iter().sum());
        let (whole, error) = jackknife(wholes.map(|of: f64| [of, 1.0]), |[sum, _]| sum);
        Shares {
            squares,
            part,
            whole,
            error,
        }
    }

    fn channel(&self, c: usize) -> Share {
        self.share(self.squares.map(|of| of[c]))
    }

    /// The share in pixels for which `is` holds.
    fn pixels(&self, differences: &Differences<'_>, is: &dyn Fn(usize) -> bool) -> Share {
        let mut sums = [0.0; PARTS];
        for (i, &part) in self.part.iter().enumerate().filter(|(i, _)| is(*i)) {
            sums[part] += differences.squares(i);
        }
        self.share(sums)
    }

    fn share(&self, sums: [f64; PARTS]) -> Share {
        let pairs = std::array::from_fn(|k| [sums[k], self.squares[k].iter().sum()]);
        let (value, error) = jackknife(pairs, |[sum, whole]| sum / whole);
        Share { value, error }
    }
}

/// An estimate by sums over all parts, and its standard error.
fn jackknife(parts: [[f64; 2]; PARTS], estimate: fn([f64; 2]) -> f64) -> (f64, f64) {
    let all = [0, 1].map(|k| parts.iter().map(|of| of[k]).sum::<f64>());
    let without = parts.map(|of| estimate([all[0] - of[0], all[1] - of[1]]));
    let count = PARTS as f64;
    let mean = without.iter().sum::<f64>() / count;
    let squares: f64 = without.iter().map(|x| (x - mean) * (x - mean)).sum();
    (estimate(all), ((count - 1.0) / count * squares).sqrt())
}

/// True if this `share` of the squared difference is worth saying of pixels of which the share is `due`.
fn is_clearly_more(share: f64, due: f64) -> bool {
    let odds = |share: f64| share / (1.0 - share).max(1e-9);
    share >= WORTH_SAYING && odds(share.min(1.0)) >= ODDS * odds(due)
}

/// The factors on the channels of the golden that lead nearest to the test image, if they leave clearly less.
fn gain(differences: &Differences<'_>, whole: f64) -> Option<String> {
    let (mut factors, mut gained) = ([1.0; 3], 0.0);
    for (c, factor) in factors.iter_mut().enumerate() {
        let (mut squares, mut products) = (0.0, 0.0);
        for i in 0..differences.golden.radiance().len() {
            let (weight, value) = (differences.weight(i, c), differences.value(i, c));
            squares += weight * value * value;
            products += weight * value * differences.difference(i, c);
        }
        if squares > 0.0 {
            *factor += products / squares;
            gained += products * products / squares;
        }
    }
    let rest = 1.0 - gained / whole;
    let [r, g, b] = factors.map(|factor| format!("{factor:.4}"));
    (rest <= LEFT_BY_GAIN).then(|| {
        format!(
            "the golden times {r} in red, {g} in green and {b} in blue, over all pixels, would leave {} of the squared \
             relative difference",
            left(rest)
        )
    })
}

/// Sentences on the places that hold clearly more than their share.
fn places(differences: &Differences<'_>, shares: &Shares) -> Vec<String> {
    let lit = differences.lit_pixels();
    let mut steepness: Vec<f64> = lit.iter().map(|&i| differences.steepness(i)).collect();
    steepness.sort_by(f64::total_cmp);
    let steep = ((1.0 - STEEPEST) * lit.len().saturating_sub(1) as f64) as usize;
    let steep = steepness.get(steep).copied().unwrap_or(0.0);
    let noise = differences.golden.noise();
    let noise = noise.filter(|noise| !noise.is_known());
    let said = |place: &str, is: &dyn Fn(usize) -> bool| {
        let due = lit.iter().filter(|&&i| is(i)).count() as f64 / lit.len().max(1) as f64;
        let share = shares.pixels(differences, is);
        let in_words = left(share.value);
        (is_clearly_more(share.value, due) && share.is_at_least(due))
            .then(|| format!("{in_words} of the squared relative difference lies {place}"))
    };
    let edges = "at edges: in the fifth of the lit pixels where the golden is steepest";
    let silent = "in pixels without noise, such as a lamp or a sky that is seen";
    let is_silent = |i: usize| noise.is_some_and(|noise| noise.variance()[i] == [0.0; 3]);
    let found = [
        said(edges, &|i| differences.steepness(i) > steep),
        said(silent, &is_silent),
    ];
    found.into_iter().flatten().collect()
}

/// The box that holds all but a few per cent of the squared difference; its sides lie at multiples of `unit` pixels.
fn in_a_box(differences: &Differences<'_>, shares: &Shares, unit: usize) -> Option<String> {
    let [width, height] = [differences.golden.width(), differences.golden.height()];
    let counts = [width, height].map(|length| length.div_ceil(unit));
    let mut along = counts.map(|count| vec![0.0; count]);
    for i in 0..width * height {
        along[0][i % width / unit] += differences.squares(i);
        along[1][i / width / unit] += differences.squares(i);
    }
    let [columns, rows] = [(0, width), (1, height)].map(|(axis, length)| {
        let outside = |sums: &mut dyn Iterator<Item = &f64>| {
            let mut left_out = 0.0;
            let is_outside = |square: &&f64| {
                left_out += **square;
                left_out <= OUTSIDE * shares.whole
            };
            sums.take_while(is_outside).count()
        };
        let first = outside(&mut along[axis].iter());
        let last = counts[axis] - outside(&mut along[axis].iter().rev());
        first * unit..(last * unit).clamp(first * unit, length)
    });
    let is_inside = |i: &usize| columns.contains(&(i % width)) && rows.contains(&(i / width));
    let lit = differences.lit_pixels();
    let inside = lit.iter().filter(|i| is_inside(i)).count() as f64 / lit.len() as f64;
    let area = (columns.len() * rows.len()) as f64 / (width * height) as f64;
    (area > 0.0 && area <= PART_OF_IMAGE && inside <= PART_OF_IMAGE).then(|| {
        format!(
            "nearly all of the squared relative difference lies in {} and {}, {} of the image",
            lines("column", [columns.start, columns.end - 1]),
            lines("row", [rows.start, rows.end - 1]),
            left(area)
        )
    })
}

/// A share in per cent, with one decimal: `12.3 %`, `less than 0.1 %`.
pub(crate) fn left(share: f64) -> String {
    match 100.0 * share {
        percent if percent < 0.1 => "less than 0.1 %".to_owned(),
        percent => format!("{percent:.1} %"),
    }
}

/// Columns or rows, from the first to the last: `columns 8 to 15`, `row 79`.
pub(super) fn lines(name: &str, [first, last]: [usize; 2]) -> String {
    if first == last {
        format!("{name} {first}")
    } else {
        format!("{name}s {first} to {last}")
    }
}

//! Measurements of the difference between two images: its size as a gain or a shift, and where it
//! lies.
//!
//! These are measurements, not names: they hold whether or not anybody knows what went wrong. Each
//! is said only where it is beyond its own uncertainty, which comes from leaving out a twentieth of
//! the image at a time (the jackknife), and where it accounts for a good part of the squared
//! difference, noise taken out.
//!
//! Differences are relative to the brightness of the golden plus its mean, and each sentence says so: a lamp
//! may hold most of the absolute difference and little of the relative one.
//!
//! Sources: Efron & Stein 1981, Annals of Statistics 9, 586–596 (jackknife); Lucas & Kanade 1981,
//! "An iterative image registration technique" (shift below a pixel).

use super::parts::{MOST_PARTS, Part, Seen, is_clearly_more, lines, percent};
use super::pixels::Pixels;
use super::stochastic::BLOCK;
use crate::film::{CHANNELS, Film};
use std::ops::Range;

/// Parts of the image for the jackknife, each of blocks from all over it.
const PARTS: usize = 20;

/// Smallest measurement that is reported, in standard errors: by chance one in 370 is.
const SIGNIFICANT: f64 = 3.0;

/// Share of the squared difference that a gain or a shift accounts for, if it is worth saying. One
/// that is fitted to a difference of another kind accounts for a few per cent.
const WORTH_SAYING: f64 = 0.2;

/// Share of the squared difference that lies in one channel, if it is said to lie there.
const MOST: f64 = 0.8;

/// Share of the squared difference in black pixels from which the parts that they happen to lie in are not said.
const NEARLY_ALL: f64 = 0.95;

/// Share of the squared difference at edges, in shares of the pixels there, below which it is said to lie
/// inside areas.
const INSIDE: f64 = 0.5;

/// A box that holds the difference is worth saying if it holds no more than this share of the lit
/// pixels.
const PART_OF_IMAGE: f64 = 0.5;

/// Share of the squared difference that is left out of such a box, at each of its four sides.
const OUTSIDE: f64 = 0.01;

/// Fewest values of a channel that end at the same number, if they are said to be cut off there.
const CUT_OFF: usize = 16;

/// Share of the values that should be above that number, and end there.
const MOST_CUT_OFF: f64 = 0.9;

/// Ratio of the golden's largest and smallest of these values: those of a lamp that is only darker are
/// all the same.
const APART: f64 = 1.02;

/// Sentences, without a full stop, on how `test` differs from `golden`; none where nothing can be
/// measured: other sizes, values that are no numbers, or no difference beyond noise.
pub fn measured_difference(golden: &Film, test: &Film, seen: &Seen) -> Vec<String> {
    measured(golden, test, seen, false).unwrap_or_default()
}

/// [`measured_difference`]; nothing where nothing can be measured. Gain and shift are left out for a difference
/// that `is_explained`.
pub(crate) fn measured(
    golden: &Film,
    test: &Film,
    seen: &Seen,
    is_explained: bool,
) -> Option<Vec<String>> {
    if !golden.is_comparable(test) {
        return None;
    }
    let pixels = Pixels::new(golden, test)?;
    let parts = Part::all(&pixels, seen);
    let sums = PartSums::of(&pixels, &parts);
    let whole = Jackknife::of(&sums, |sums| sums.squares());
    let has_noise = [golden, test]
        .into_iter()
        .any(|film| film.noise().is_some());
    if whole.value <= 0.0 || has_noise && !whole.is_beyond(0.0) {
        return None;
    }
    let shift = Shift::of(&sums);
    // By chance a pixel of few samples is black, too.
    let black = (!has_noise)
        .then(|| Black::of(&pixels, whole.value))
        .flatten();
    let sentences = [
        black.as_ref().map(Black::in_words),
        cut_off(&pixels),
        in_one_channel(&sums),
        gain(&sums).filter(|_| !is_explained),
        (shift.as_ref().filter(|_| !is_explained)).map(|shift| shift.in_words(seen)),
        shift
            .filter(|shift| shift.may_be_of_seeds(test))
            .map(|_| SHARED_POSITIONS.to_owned()),
    ];
    let mut sentences: Vec<String> = sentences.into_iter().flatten().collect();
    if black.is_none_or(|black| black.share < NEARLY_ALL) {
        sentences.extend(in_parts(&sums, &parts));
    }
    // Noise of single lines would decide where the box ends.
    sentences.extend(in_a_box(&pixels, &sums, if has_noise { BLOCK } else { 1 }));
    Some(sentences)
}

/// Place of what is left of a difference, of `squares` by pixel: `80 % of that lies at edges`; nothing
/// where it lies in no part more than in others.
pub(crate) fn place_of_rest(golden: &Film, seen: &Seen, squares: &[f64]) -> Option<String> {
    let pixels = Pixels::new(golden, golden)?;
    let parts = Part::all(&pixels, seen);
    let mut sums = [PartSums::default(); PARTS];
    for (i, square) in squares.iter().enumerate() {
        let sums = &mut sums[part_of_jackknife(pixels.block(i))];
        sums.squares[0] += square;
        for (sum, part) in sums.parts.iter_mut().zip(&parts) {
            *sum += if part.pixels[i] { *square } else { 0.0 };
        }
    }
    // Where the rest is noise it has no place.
    let whole = Jackknife::of(&sums, |sums| sums.squares());
    if whole.value <= 0.0 || golden.noise().is_some() && !whole.is_beyond(0.0) {
        return None;
    }
    parts.iter().enumerate().find_map(|(k, part)| {
        let share = share_of_part(&sums, k);
        let words = || format!("{} of that lies {}", percent(share.value), part.words);
        is_clearly_in(part, &share).then(words)
    })
}

/// Part of the jackknife to which a block belongs: neighbours in a row and in a column are of different
/// parts.
fn part_of_jackknife([x, y]: [usize; 2]) -> usize {
    (x + 7 * y) % PARTS
}

/// Weighted sums over a part of the image.
#[derive(Clone, Copy, Default)]
struct PartSums {
    /// Squared differences by channel, noise taken out.
    squares: [f64; 3],
    /// Golden squared, and golden times difference, by channel.
    golden_squared: [f64; 3],
    golden_difference: [f64; 3],
    /// Products of the slopes, xx, xy and yy, and slopes times difference.
    slopes: [f64; 3],
    slope_difference: [f64; 2],
    /// Squared differences in each [`Part`].
    parts: [f64; MOST_PARTS],
}

impl PartSums {
    /// Sums of each part of the jackknife.
    fn of(pixels: &Pixels<'_>, kinds: &[Part]) -> [PartSums; PARTS] {
        let mut parts = [PartSums::default(); PARTS];
        for i in 0..pixels.golden.radiance().len() {
            let part = &mut parts[part_of_jackknife(pixels.block(i))];
            for c in 0..3 {
                let (weight, difference) = (pixels.weight(i, c), pixels.difference(i, c));
                let square = pixels.square(i, c);
                let golden = pixels.value(i, c);
                part.squares[c] += square;
                part.golden_squared[c] += weight * golden * golden;
                part.golden_difference[c] += weight * golden * difference;
                let [right, down] = pixels.slope(i, c);
                for (sum, product) in
                    part.slopes
                        .iter_mut()
                        .zip([right * right, right * down, down * down])
                {
                    *sum += weight * product;
                }
                part.slope_difference[0] += weight * right * difference;
                part.slope_difference[1] += weight * down * difference;
                for (sum, kind) in part.parts.iter_mut().zip(kinds) {
                    *sum += if kind.pixels[i] { square } else { 0.0 };
                }
            }
        }
        parts
    }

    fn add(&mut self, other: &PartSums, sign: f64) {
        for c in 0..3 {
            self.squares[c] += sign * other.squares[c];
            self.golden_squared[c] += sign * other.golden_squared[c];
            self.golden_difference[c] += sign * other.golden_difference[c];
            self.slopes[c] += sign * other.slopes[c];
        }
        for axis in 0..2 {
            self.slope_difference[axis] += sign * other.slope_difference[axis];
        }
        for (sum, other) in self.parts.iter_mut().zip(other.parts) {
            *sum += sign * other;
        }
    }

    fn squares(&self) -> f64 {
        self.squares.iter().sum()
    }

    /// The factor on the golden that is nearest to the test image.
    fn gain(&self, c: usize) -> f64 {
        if self.golden_squared[c] > 0.0 {
            1.0 + self.golden_difference[c] / self.golden_squared[c]
        } else {
            1.0
        }
    }

    /// Share of the squared difference that the gains account for.
    fn share_of_gains(&self) -> f64 {
        let of = |c: usize| (self.gain(c) - 1.0) * self.golden_difference[c];
        (0..3).map(of).sum::<f64>() / self.squares()
    }

    /// The shift of the golden to the right and down: where it rises by the slope g per
    /// pixel, a shift by s makes it darker by g s.
    fn shift(&self) -> [f64; 2] {
        let [xx, xy, yy] = self.slopes;
        let [x, y] = self.slope_difference;
        let determinant = xx * yy - xy * xy;
        if determinant > 1e-12 * xx * yy {
            [
                -(yy * x - xy * y) / determinant,
                -(xx * y - xy * x) / determinant,
            ]
        } else {
            [0.0; 2]
        }
    }

    fn share_of_shift(&self) -> f64 {
        let [right, down] = self.shift();
        let [x, y] = self.slope_difference;
        -(right * x + down * y) / self.squares()
    }
}

/// An estimate and its standard error.
#[derive(Clone, Copy)]
struct Jackknife {
    value: f64,
    error: f64,
}

impl Jackknife {
    fn of(parts: &[PartSums; PARTS], estimate: impl Fn(&PartSums) -> f64) -> Jackknife {
        let mut all = PartSums::default();
        for part in parts {
            all.add(part, 1.0);
        }
        let value = estimate(&all);
        let without = parts.map(|part| {
            let mut rest = all;
            rest.add(&part, -1.0);
            estimate(&rest)
        });
        let count = PARTS as f64;
        let mean = without.iter().sum::<f64>() / count;
        let squares: f64 = without.iter().map(|x| (x - mean) * (x - mean)).sum();
        Jackknife {
            value,
            error: ((count - 1.0) / count * squares).sqrt(),
        }
    }

    /// True if it differs from `other` by more than its uncertainty.
    fn is_beyond(&self, other: f64) -> bool {
        (self.value - other).abs() > SIGNIFICANT * self.error
    }

    /// True if it is at least `least`, beyond doubt.
    fn is_at_least(&self, least: f64) -> bool {
        self.value - SIGNIFICANT * self.error >= least
    }
}

/// The value with the decimals that are known: the standard error has one digit, or four decimals.
fn decimals(value: f64, error: f64) -> String {
    let places = (1..4).find(|&places| error * crate::math::powu(10.0, places) >= 1.0);
    format!("{value:.*}", places.unwrap_or(4) as usize)
}

/// Pixels that are black, exactly 0 in all channels, where the golden is not.
struct Black {
    count: usize,
    /// Share of the squared difference.
    share: f64,
}

impl Black {
    /// The pixels that the image shows black, if they hold clearly more of `whole`, the squared difference, than
    /// their share of the pixels that are not.
    fn of(pixels: &Pixels<'_>, whole: f64) -> Option<Black> {
        let [golden, test] = [pixels.golden, pixels.test].map(Film::radiance);
        let shown: Vec<usize> = (0..golden.len())
            .filter(|&i| golden[i] != [0.0; 3])
            .collect();
        let is_black = |&i: &usize| test[i] == [0.0; 3];
        let black: Vec<usize> = shown.iter().copied().filter(is_black).collect();
        let squares = black
            .iter()
            .flat_map(|&i| (0..3).map(move |c| pixels.square(i, c)));
        let share = squares.sum::<f64>() / whole;
        let (count, shown) = (black.len(), shown.len().max(1));
        is_clearly_more(share, count as f64 / shown as f64).then_some(Black { count, share })
    }

    fn in_words(&self) -> String {
        let pixels = match self.count {
            1 => "a pixel that is black where the golden is not".to_owned(),
            count => format!("{count} pixels that are black where the golden is not"),
        };
        let share = percent(self.share);
        format!("{share} of the squared relative difference lies in {pixels}")
    }
}

/// Values that end at one number, which nearly all that should be above it have, whatever they should be.
/// A lamp, of one value in the golden, shows nothing of that: it may be darker as a whole.
fn cut_off(pixels: &Pixels<'_>) -> Option<String> {
    let test = pixels.test.radiance();
    let most = test.as_flattened().iter().copied().fold(0.0, f32::max);
    let (mut cut, mut above, mut is_spread) = (0, 0, false);
    for c in 0..3 {
        let mut values: Vec<(f64, bool)> = (0..test.len())
            .map(|i| (i, pixels.value(i, c)))
            .filter(|&(i, value)| {
                let beyond = value - 1.001 * f64::from(most);
                beyond > SIGNIFICANT * pixels.variance(i, c).sqrt()
            })
            .map(|(i, value)| (value, test[i][c] == most))
            .collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let lamp = longest_run(&values);
        let others = values[..lamp.start].iter().chain(&values[lamp.end..]);
        let ends: Vec<f64> = others.clone().filter(|it| it.1).map(|it| it.0).collect();
        above += others.count();
        cut += ends.len();
        let is_apart = || ends[ends.len() - 1] >= APART * ends[0];
        is_spread |= ends.len() >= CUT_OFF && is_apart();
    }
    let is_cut = most > 0.0 && is_spread && cut as f64 >= MOST_CUT_OFF * above as f64;
    is_cut.then(|| {
        format!("no value is above {most}, where at least {cut} values should be: they look cut off there")
    })
}

/// The longest run of equal values, to a thousandth, in values in order.
fn longest_run(values: &[(f64, bool)]) -> Range<usize> {
    let (mut longest, mut start) = (0..0, 0);
    for end in 1..=values.len() {
        while values[end - 1].0 > 1.001 * values[start].0 {
            start += 1;
        }
        if end - start > longest.len() {
            longest = start..end;
        }
    }
    longest
}

fn in_one_channel(sums: &[PartSums; PARTS]) -> Option<String> {
    let share = |c: usize| Jackknife::of(sums, |sums| sums.squares[c] / sums.squares());
    (0..3).map(|c| (c, share(c))).find_map(|(c, share)| {
        // A third would be its due.
        let is_most = share.value >= MOST && share.is_at_least(0.5);
        is_most.then(|| {
            let part = percent(share.value);
            format!(
                "{part} of the squared relative difference is in {}",
                CHANNELS[c]
            )
        })
    })
}

fn gain(sums: &[PartSums; PARTS]) -> Option<String> {
    let share = Jackknife::of(sums, PartSums::share_of_gains);
    let gains = [0, 1, 2].map(|c| Jackknife::of(sums, |sums| sums.gain(c)));
    let is_known = gains.iter().any(|gain| gain.is_beyond(1.0));
    if !(is_known && share.value >= WORTH_SAYING && share.is_beyond(0.0)) {
        return None;
    }
    let [r, g, b] = gains.map(|gain| decimals(gain.value, gain.error));
    let factors = if r == g && g == b {
        format!("{r}, all channels alike,")
    } else {
        format!("{r} in red, {g} in green and {b} in blue,")
    };
    Some(format!(
        "the golden times {factors} over all pixels, would leave {} of the squared relative difference",
        left(1.0 - share.value)
    ))
}

/// A share that is left.
pub(crate) fn left(share: f64) -> String {
    match 100.0 * share {
        percent if percent < 0.1 => "less than 0.1 %".to_owned(),
        percent => format!("{percent:.1} %"),
    }
}

/// Question on a shift by half a pixel or less, of images that are means of several renderings.
pub(crate) const SHARED_POSITIONS: &str = "half a pixel or less, in a mean of renderings that do not \
    count their samples: do all seeds share the positions within a pixel? With few samples each, their \
    mean does not lie at its centre";

/// Largest shift, in pixels along an axis, by positions within a pixel.
pub(crate) const WITHIN_A_PIXEL: f64 = 0.5;

/// A shift of the image, pixels to the right and down.
struct Shift {
    axes: [Jackknife; 2],
    share: f64,
}

impl Shift {
    /// The shift that the slopes of the golden tell, if it accounts for a good part of the difference.
    fn of(sums: &[PartSums; PARTS]) -> Option<Shift> {
        let share = Jackknife::of(sums, PartSums::share_of_shift);
        let axes = [0, 1].map(|axis| Jackknife::of(sums, |sums| sums.shift()[axis]));
        let is_known = axes.iter().any(|axis| axis.is_beyond(0.0));
        // By slopes nothing is known of a shift beyond the next pixel.
        let is_small = axes.iter().all(|axis| axis.value.abs() <= 1.0);
        let is_worth_saying = share.value >= WORTH_SAYING && share.is_beyond(0.0);
        (is_known && is_small && is_worth_saying).then_some(Shift {
            axes,
            share: share.value,
        })
    }

    /// Components that are known.
    fn known(&self) -> [f64; 2] {
        self.axes
            .map(|axis| if axis.is_beyond(0.0) { axis.value } else { 0.0 })
    }

    fn in_words(&self, seen: &Seen) -> String {
        let sides = [["right", "left"], ["down", "up"]];
        let along = |axis: usize| {
            let Jackknife { value, error } = self.axes[axis];
            let side = sides[axis][usize::from(value < 0.0)];
            format!("{} pixels {side}", decimals(value.abs(), error))
        };
        let known = (0..2).filter(|&axis| self.axes[axis].is_beyond(0.0));
        let known: Vec<String> = known.map(along).collect();
        let voxels = seen.voxels_in_words(self.known());
        format!(
            "the golden moved by {}{}, by its slopes, would account for {} of the squared relative difference",
            known.join(" and "),
            voxels.map_or(String::new(), |voxels| format!(" ({voxels})")),
            percent(self.share)
        )
    }

    fn may_be_of_seeds(&self, test: &Film) -> bool {
        let within = |axis: &f64| axis.abs() <= WITHIN_A_PIXEL;
        test.noise().is_some_and(|noise| noise.is_of_renderings())
            && self.known().iter().all(within)
    }
}

/// Sentences on the parts that hold clearly more than their share.
fn in_parts(sums: &[PartSums; PARTS], parts: &[Part]) -> Vec<String> {
    let mut sentences = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        let share = share_of_part(sums, k);
        if is_clearly_in(part, &share) {
            let percent = percent(share.value);
            sentences.push(format!(
                "{percent} of the squared relative difference lies {}",
                part.words
            ));
        }
        let is_edge = k == 0;
        if is_edge && share.value + SIGNIFICANT * share.error <= INSIDE * part.due {
            let words =
                "the squared relative difference lies inside areas rather than at their edges";
            sentences.push(words.to_owned());
        }
    }
    sentences
}

/// The share of the squared difference in the part of number `k`.
fn share_of_part(sums: &[PartSums; PARTS], k: usize) -> Jackknife {
    Jackknife::of(sums, |sums| sums.parts[k] / sums.squares())
}

/// True if `part` holds this share, clearly more than its share of the pixels.
fn is_clearly_in(part: &Part, share: &Jackknife) -> bool {
    part.holds(share.value) && share.is_beyond(part.due)
}

/// The box that holds all but a few per cent of the squared difference; its sides lie at multiples of `unit` pixels.
fn in_a_box(pixels: &Pixels<'_>, sums: &[PartSums; PARTS], unit: usize) -> Option<String> {
    let [width, height] = [pixels.golden.width(), pixels.golden.height()];
    let whole: f64 = sums.iter().map(PartSums::squares).sum();
    let counts = [width, height].map(|length| length.div_ceil(unit));
    let mut along = counts.map(|count| vec![0.0; count]);
    for i in 0..width * height {
        for c in 0..3 {
            let square = pixels.square(i, c);
            along[0][i % width / unit] += square;
            along[1][i / width / unit] += square;
        }
    }
    let [columns, rows] = [(0, width), (1, height)].map(|(axis, length)| {
        let within = |sums: &mut dyn Iterator<Item = &f64>| {
            let mut left_out = 0.0;
            let is_outside = |square: &&f64| {
                left_out += **square;
                left_out <= OUTSIDE * whole
            };
            sums.take_while(is_outside).count()
        };
        let first = within(&mut along[axis].iter());
        let last = counts[axis] - within(&mut along[axis].iter().rev());
        first * unit..(last * unit).clamp(first * unit, length)
    });
    let is_inside = |i: &usize| columns.contains(&(i % width)) && rows.contains(&(i / width));
    let lit: Vec<usize> = (0..width * height).filter(|&i| pixels.is_lit(i)).collect();
    let inside = lit.iter().filter(|i| is_inside(i)).count() as f64 / lit.len() as f64;
    let area = (columns.len() * rows.len()) as f64 / (width * height) as f64;
    (area > 0.0 && area <= PART_OF_IMAGE && inside <= PART_OF_IMAGE).then(|| {
        format!(
            "nearly all of the squared relative difference lies in {} and {}, {} of the image",
            lines("column", [columns.start, columns.end - 1]),
            lines("row", [rows.start, rows.end - 1]),
            percent(area)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;
    use crate::math::rng::{Purpose, Stream};

    /// Hills of three colours, as far as `at` in pixels.
    fn hills(at: impl Fn(f64, f64) -> [f64; 2]) -> Film {
        let pixel = |i: usize| {
            let [x, y] = at((i % 96) as f64, (i / 96) as f64);
            let hill = |p: f64, q: f64| 0.6 + 0.4 * math::sin(p * x) * math::cos(q * y);
            [hill(0.21, 0.17), hill(0.13, 0.25), hill(0.3, 0.1)].map(|x| x as f32)
        };
        Film::new(96, 80, (0..96 * 80).map(pixel).collect())
    }

    fn golden() -> Film {
        hills(|x, y| [x, y])
    }

    fn edited(map: impl Fn(f64, usize, [usize; 2]) -> f64) -> Film {
        let golden = golden();
        let pixels = golden.radiance().iter().enumerate().map(|(i, pixel)| {
            std::array::from_fn(|c| map(f64::from(pixel[c]), c, [i % 96, i / 96]) as f32)
        });
        Film::new(96, 80, pixels.collect())
    }

    /// Both with noise of this standard deviation, stated or not.
    fn noisy(film: &Film, sigma: f64, seed: u64, states: bool) -> Film {
        let pixels = film.radiance().iter().enumerate().map(|(i, pixel)| {
            let stream = Stream::new(seed, i as u32, 0);
            std::array::from_fn(|c| {
                let u = stream.uniform(0, Purpose::Camera, c as u32) - 0.5;
                (f64::from(pixel[c]) + u * sigma * 12_f64.sqrt()) as f32
            })
        });
        let pixels: Vec<[f32; 3]> = pixels.collect();
        if states {
            let variance = vec![[(sigma * sigma) as f32; 3]; pixels.len()];
            Film::with_noise(96, 80, pixels, variance, 16)
        } else {
            Film::new(96, 80, pixels)
        }
    }

    fn said(test: &Film) -> String {
        measured_difference(&golden(), test, &Seen::default()).join("; ")
    }

    #[test]
    fn gains_and_shifts_have_their_size() {
        let text = said(&edited(|x, c, _| [1.05, 1.0, 0.9][c] * x));
        assert!(
            text.contains("the golden times 1.0500 in red, 1.0000 in green and 0.9000 in blue, over all pixels"),
            "{text}"
        );
        assert!(text.contains("would leave less than 0.1 % of"), "{text}");
        let text = said(&edited(|x, _, _| 0.91 * x));
        assert!(
            text.contains("the golden times 0.9100, all channels alike,"),
            "{text}"
        );
        let text = said(&hills(|x, y| [x - 0.3, y]));
        assert!(
            text.contains("moved by 0.3") && text.contains("pixels right"),
            "{text}"
        );
        let text = said(&hills(|x, y| [x, y + 0.5]));
        assert!(
            text.contains("moved by 0.5") && text.contains("pixels up"),
            "{text}"
        );
        assert_eq!(said(&golden()), "");
    }

    #[test]
    fn where_it_lies_is_said() {
        let text = said(&edited(|x, c, _| if c == 1 { 1.1 * x } else { x }));
        assert!(
            text.contains("all of the squared relative difference is in green"),
            "{text}"
        );
        let text = said(&edited(
            |x, _, [i, j]| if i < 32 && j >= 40 { 0.5 * x } else { x },
        ));
        assert!(
            text.contains("columns 0 to 31 and rows 40 to 79, 17 % of"),
            "{text}"
        );
        let text = said(&edited(|x, _, _| x.min(0.75)));
        assert!(text.contains("no value is above 0.75"), "{text}");
    }

    /// Rows that were never written; not what is nearly black, nor what noise makes black.
    #[test]
    fn black_pixels_are_counted() {
        let with_rows = |value: f32| {
            let pixels = golden().radiance().to_vec().into_iter().enumerate();
            let pixels = pixels.map(|(i, pixel)| match i / 96 % 16 {
                3 => [value; 3],
                _ => pixel,
            });
            Film::new(96, 80, pixels.collect())
        };
        let said = |golden: &Film, test: &Film| {
            measured_difference(golden, test, &Seen::default()).join("; ")
        };
        let golden = golden();
        let text = said(&golden, &with_rows(0.0));
        let words = "all of the squared relative difference lies in 480 pixels that are black where the golden is not";
        assert!(text.contains(words), "{text}");
        let mut pixels = golden.radiance().to_vec();
        pixels[40 + 96 * 40] = [0.0; 3];
        let text = said(&golden, &Film::new(96, 80, pixels));
        let words = "all of the squared relative difference lies in a pixel that is black";
        assert!(text.contains(words), "{text}");
        let pixels = with_rows(0.0).radiance().to_vec();
        let variance = vec![[1e-4; 3]; pixels.len()];
        let with_noise = Film::with_noise(96, 80, pixels, variance, 16);
        for test in [with_rows(1e-6), with_noise] {
            let text = said(&golden, &test);
            assert!(!text.contains("black"), "{text}");
        }
    }

    /// In noise, stated or not, the size is found within its error; of noise alone nothing is said.
    #[test]
    fn noise_is_no_difference() {
        let right = noisy(&golden(), 0.01, 1, true);
        for states in [true, false] {
            let same = noisy(&golden(), 0.1, 2, states);
            assert_eq!(
                measured_difference(&right, &same, &Seen::default()),
                Vec::<String>::new()
            );
            let brighter = edited(|x, _, _| 1.1 * x);
            let text =
                measured_difference(&right, &noisy(&brighter, 0.1, 3, states), &Seen::default())
                    .join("; ");
            // 0.1/0.6 a pixel, of 7680: 0.2 %.
            assert!(
                text.contains("times 1.1") || text.contains("times 1.09"),
                "{text}"
            );
            assert!(
                !text.contains("moved") && !text.contains("columns"),
                "{text}"
            );
        }
    }

    /// A volume in a box of 64 pixels.
    fn seen() -> Seen {
        let is_inside = |[x, y]: [usize; 2]| (16..80).contains(&x) && (8..72).contains(&y);
        let border = |i: usize| {
            let [x, y] = [i % 96, i / 96];
            let near = |[x, y]: [usize; 2]| is_inside([x.max(2) - 2, y.max(2) - 2]);
            is_inside([x, y]) != near([x, y]) || is_inside([x, y]) != is_inside([x + 2, y + 2])
        };
        Seen {
            border: Some((0..96 * 80).map(border).collect()),
            voxels: Some([[0.4, 0.0, 0.3], [0.0, -1.2, 0.0]]),
        }
    }

    #[test]
    fn the_border_of_the_volume_is_told() {
        let seen = seen();
        let border = seen.border.as_ref().unwrap();
        let said = |edit: &dyn Fn(f64, bool) -> f64| {
            let test = edited(|x, _, [i, j]| edit(x, border[96 * j + i]));
            measured_difference(&golden(), &test, &seen).join("; ")
        };
        let words = "lies at the border of the volume, the silhouette of its box";
        let larger = said(&|x, border| if border { x + 0.05 } else { x });
        assert!(larger.contains(words), "{larger}");
        let all = said(&|x, _| x + 0.02 * (x + 0.2));
        assert!(!all.contains(words), "{all}");
    }

    #[test]
    fn shifts_are_said_in_voxels() {
        let seen = seen();
        let shifted = |by: [f64; 2], seen: &Seen| {
            let test = hills(|x, y| [x - by[0], y - by[1]]);
            measured_difference(&golden(), &test, seen).join("; ")
        };
        // 0.3 pixels of half a voxel each, 0.4 of 0.5 along x.
        let text = shifted([0.3, 0.0], &seen);
        let words =
            "pixels up (0.15 voxels at the centre of the volume: +0.12 along x, +0.09 along z)";
        assert!(text.contains(words), "{text}");
        let text = shifted([0.0, -0.5], &seen);
        assert!(text.contains("pixels up (0.6"), "{text}");
        assert!(text.contains("along y)"), "{text}");
        let text = shifted([0.3, 0.0], &Seen::default());
        assert!(text.contains("pixels up, by its slopes"), "{text}");
        let text = measured_difference(&golden(), &edited(|x, _, _| 1.1 * x), &seen).join("; ");
        assert!(!text.contains("voxels"), "{text}");
    }

    /// Four renderings of a few samples each.
    #[test]
    fn seeds_may_share_positions_within_a_pixel() {
        let of_renderings = |film: &Film| {
            let films = [1, 2, 3, 4].map(|seed| noisy(film, 0.01, seed, false));
            Film::from_replicates(&films).unwrap()
        };
        let right = noisy(&golden(), 0.001, 9, true);
        let said = |test: &Film| measured_difference(&right, test, &Seen::default()).join("; ");
        let asks = |text: &str| text.contains("do all seeds share the positions within a pixel?");
        let shifted = hills(|x, y| [x - 0.4, y + 0.3]);
        let text = said(&of_renderings(&shifted));
        assert!(text.contains("moved by") && asks(&text), "{text}");
        // By most of a pixel; with noise of samples; and no shift.
        let far = hills(|x, y| [x - 0.8, y]);
        let brighter = edited(|x, _, _| 1.1 * x);
        for test in [
            of_renderings(&far),
            noisy(&shifted, 0.01, 5, true),
            of_renderings(&brighter),
        ] {
            let text = said(&test);
            assert!(!text.is_empty() && !asks(&text), "{text}");
        }
    }
}

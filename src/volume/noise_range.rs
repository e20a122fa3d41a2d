//! Bounds on Perlin's noise over a box.

use super::perlin::{cell_and_fraction, fade, gradients_around, noise_in_cell};
use glam::DVec3;

/// Upper bound on the magnitude of [`perlin_noise`](super::perlin_noise).
///
/// At a fraction of a cell each gradient, with its two entries ±1, adds at most the larger two of
/// the three distances to its corner, and the fades mix the eight. The largest such mixture is
/// 1.03635…, near (0.5, 0.4815, 0.3553): more than the 1 that is often quoted. A test below
/// proves that it stays below this bound, by halving the cell until interval arithmetic does.
pub const NOISE_BOUND: f64 = 1.04;

/// Error of computed noise and computed bounds together.
///
/// With u = 2⁻⁵³, by counting roundings of numbers up to 16: a fade is off by at most 32 u, a
/// corner's part by 3 u, and each of the three mixtures, of numbers up to 2, adds at most
/// 32·4 + 6 u: a value and an end of an interval of values are off by at most 512 u. A slope, up
/// to 1 + 15/8·4, is off by at most 1300 u: 15/8 times the difference of two such values, and 32
/// u times twice itself in each further mixture; three of them count for half an edge each. In
/// all 3·512 + 3/2·1300 u and little more: below 4096 u, of which this is the double.
const ROUNDING: f64 = 8192.0 * (f64::EPSILON / 2.0);

/// A box over more cells than this has the range of all noise. Twice as close a bound as from one
/// cell; with 27 cells nothing is gained, for whole cells have wide bounds.
const MOST_CELLS: f64 = 8.0;

/// From `low` to `high ≥ low`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub low: f64,
    pub high: f64,
}

/// Bounds on [`perlin_noise`](super::perlin_noise), as it is computed, at all points of the box
/// between two opposite corners.
pub(super) fn noise_range(corner: DVec3, opposite: DVec3) -> Interval {
    const ALL: Interval = Interval::new(-NOISE_BOUND, NOISE_BOUND);
    // 2⁵¹; the comparison is also false for what is no number.
    let small = |v: DVec3| v.abs().cmplt(DVec3::splat(2_251_799_813_685_248.0)).all();
    if !(small(corner) && small(opposite)) {
        return ALL;
    }
    let (min, max) = (corner.min(opposite), corner.max(opposite));
    let (first, last) = (min.floor(), max.floor());
    if (last - first + 1.0).element_product() > MOST_CELLS {
        return ALL;
    }
    // Differences of whole numbers below 2⁵², exact; at most MOST_CELLS of them.
    let count = (last - first + 1.0).as_uvec3();
    let mut range = Interval::new(f64::INFINITY, f64::NEG_INFINITY);
    for z in 0..count.z {
        for y in 0..count.y {
            for x in 0..count.x {
                let cell = first + DVec3::new(x.into(), y.into(), z.into());
                // Rounding keeps the order of numbers: the fractions of points of the box lie
                // between these, as computed.
                let low = (min - cell).max(DVec3::ZERO);
                let high = (max - cell).min(DVec3::ONE);
                range = range.union(range_in_cell(gradients_at(cell), low, high));
            }
        }
    }
    Interval::new(
        (range.low - ROUNDING).max(ALL.low),
        (range.high + ROUNDING).min(ALL.high),
    )
}

fn gradients_at(cell: DVec3) -> [&'static [f64; 3]; 8] {
    let [i, j, k] = cell.to_array().map(|index| cell_and_fraction(index).0);
    gradients_around(i, j, k)
}

/// Bounds on the noise at fractions from `low` to `high` of a cell, but for rounding.
///
/// Two at once, of which each is the better one somewhere. By interval arithmetic, the noise
/// itself: mixtures of the ranges of the corners' linear parts. By the mean value theorem, the
/// noise in the middle plus, along each axis, half the edge times the steepest slope: an error of
/// second order in the size of the box.
fn range_in_cell(gradients: [&[f64; 3]; 8], low: DVec3, high: DVec3) -> Interval {
    let fades = [0, 1, 2].map(|axis| Fade::over(low[axis], high[axis]));
    let corner = |number: usize| Expansion::of_corner(gradients[number], number, low, high);
    let edge = |number: usize| fades[0].mix(corner(number), corner(number + 1), 0);
    let face = |number: usize| fades[1].mix(edge(number), edge(number + 2), 1);
    let whole = fades[2].mix(face(0), face(4), 2);

    let half = (high - low) * 0.5;
    let middle = noise_in_cell(gradients, low + half);
    let [x, y, z] = whole.slope.map(Interval::magnitude);
    let reach = half.x * x + half.y * y + half.z * z;
    Interval::new(
        whole.value.low.max(middle - reach),
        whole.value.high.min(middle + reach),
    )
}

/// Ranges of a function and of its slopes along the axes, over a box.
#[derive(Clone, Copy)]
struct Expansion {
    value: Interval,
    slope: [Interval; 3],
}

impl Expansion {
    /// `g·(f − c)` for fractions `f` from `low` to `high`, `c` the corner of the given number.
    fn of_corner(gradient: &[f64; 3], number: usize, low: DVec3, high: DVec3) -> Expansion {
        let mut value = Interval::of(0.0);
        for axis in 0..3 {
            let corner = f64::from((number >> axis & 1) as u8);
            let ends = [low[axis] - corner, high[axis] - corner].map(|d| gradient[axis] * d);
            value = value.plus(Interval::between(ends[0], ends[1]));
        }
        let slope = gradient.map(Interval::of);
        Expansion { value, slope }
    }
}

/// Ranges of the fade and of its slope.
#[derive(Clone, Copy)]
struct Fade {
    value: Interval,
    slope: Interval,
}

impl Fade {
    fn over(low: f64, high: f64) -> Fade {
        // 30 t² (1 − t)²: rises to 15/8 at 1/2 and falls again.
        let slope = |t: f64| 30.0 * (t * (1.0 - t)) * (t * (1.0 - t));
        let mut slopes = Interval::between(slope(low), slope(high));
        if low <= 0.5 && high >= 0.5 {
            slopes.high = 1.875;
        }
        Fade {
            value: Interval::between(fade(low), fade(high)),
            slope: slopes,
        }
    }

    /// `a + fade·(b − a)`, the fade that of the given axis, and by the product rule its slopes.
    #[inline]
    fn mix(self, a: Expansion, b: Expansion, axis: usize) -> Expansion {
        let mut slope = [0, 1, 2].map(|axis| a.slope[axis].mix(b.slope[axis], self.value));
        let rise = b.value.minus(a.value);
        slope[axis] = slope[axis].plus(rise.times(self.slope));
        Expansion {
            value: a.value.mix(b.value, self.value),
            slope,
        }
    }
}

impl Interval {
    const fn new(low: f64, high: f64) -> Interval {
        Interval { low, high }
    }

    fn of(value: f64) -> Interval {
        Interval::new(value, value)
    }

    fn between(a: f64, b: f64) -> Interval {
        Interval::new(a.min(b), a.max(b))
    }

    fn union(self, other: Interval) -> Interval {
        Interval::new(self.low.min(other.low), self.high.max(other.high))
    }

    fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    fn plus(self, other: Interval) -> Interval {
        Interval::new(self.low + other.low, self.high + other.high)
    }

    fn minus(self, other: Interval) -> Interval {
        Interval::new(self.low - other.high, self.high - other.low)
    }

    /// The product with what is not negative.
    fn times(self, factor: Interval) -> Interval {
        Interval::new(
            (self.low * factor.low).min(self.low * factor.high),
            (self.high * factor.low).max(self.high * factor.high),
        )
    }

    /// `self + t·(other − self)` for `t` in [0, 1]: linear in `t` and rising in both ends, so the
    /// extremes are at ends.
    #[inline]
    fn mix(self, other: Interval, t: Interval) -> Interval {
        let at = |a: f64, b: f64, t: f64| a + t * (b - a);
        Interval::new(
            at(self.low, other.low, t.low).min(at(self.low, other.low, t.high)),
            at(self.high, other.high, t.low).max(at(self.high, other.high, t.high)),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::tests::failures_in;
    use crate::volume::perlin_noise;
    use proptest::prelude::*;

    /// Bounds on the mixture that [`NOISE_BOUND`] speaks of, over a part of a cell.
    fn largest_mixture(low: DVec3, high: DVec3) -> f64 {
        let fades = [0, 1, 2].map(|axis| Fade::over(low[axis], high[axis]).value);
        let corner = |number: usize| {
            let distances = [0, 1, 2].map(|axis| match number >> axis & 1 {
                0 => high[axis],
                _ => 1.0 - low[axis],
            });
            let smallest = distances.into_iter().fold(f64::INFINITY, f64::min);
            Interval::of(distances.iter().sum::<f64>() - smallest)
        };
        let edge = |number: usize| corner(number).mix(corner(number + 1), fades[0]);
        let face = |number: usize| edge(number).mix(edge(number + 2), fades[1]);
        face(0).mix(face(4), fades[2]).high
    }

    /// Halves the part of a cell until the bound is proved for all of it; counts the parts.
    fn prove(low: DVec3, edge: f64) -> usize {
        // Far above what rounding may be.
        if largest_mixture(low, low + edge) <= NOISE_BOUND - 1e-9 {
            return 1;
        }
        assert!(edge > 1e-4, "not below the bound at {low}");
        let half = edge / 2.0;
        let part = |number: u8| {
            let offset = [0, 1, 2].map(|axis| f64::from(number >> axis & 1) * half);
            prove(low + DVec3::from_array(offset), half)
        };
        (0..8).map(part).sum()
    }

    #[test]
    fn all_noise_is_within_its_bound() {
        // Mirroring an axis swaps corners: an eighth of the cell is all of it.
        let parts = prove(DVec3::ZERO, 0.5);
        assert!(parts > 8, "a proof without work proves nothing");
        // And the bound is not idle.
        let worst = DVec3::new(0.5, 0.4815, 0.3553);
        assert!(largest_mixture(worst, worst) > 1.036);
    }

    #[test]
    fn small_boxes_have_small_ranges() {
        // A hundredth of a cell, anywhere: second order in its size.
        for at in [DVec3::splat(0.3), DVec3::new(-7.4, 100.55, 3.01)] {
            let range = noise_range(at, at + 0.01);
            let corners = (0..8_u8).map(|number| {
                let offset = [0, 1, 2].map(|axis| f64::from(number >> axis & 1) * 0.01);
                perlin_noise(at + DVec3::from_array(offset))
            });
            let seen = corners.fold(f64::NEG_INFINITY, f64::max);
            assert!(range.high - seen < 2e-3, "{} above {seen}", range.high);
        }
    }

    proptest! {
        #![proptest_config(failures_in("fixtures/proptest-regressions/noise_range.txt"))]

        /// Noise lies within its range, in boxes of all sizes, near and far, on their faces too.
        #[test]
        fn noise_lies_within_its_range(
            corner in prop::array::uniform3(-300.0..300.0_f64),
            octave in -12..40_i32,
            size in prop::array::uniform3(prop_oneof![Just(0.0), 0.0..0.1_f64, 0.0..2.5_f64]),
            shares in prop::collection::vec(prop::array::uniform3(
                prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0_f64]), 16),
        ) {
            let corner = DVec3::from_array(corner) * crate::math::exp2(octave.max(0).into());
            let size = DVec3::from_array(size) * crate::math::exp2(octave.min(0).into());
            let (min, max) = (corner, corner + size);
            let range = noise_range(min, max);
            prop_assert!(range.low <= range.high);
            prop_assert_eq!(range, noise_range(max, min));
            for share in shares {
                let point = (min + (max - min) * DVec3::from_array(share)).clamp(min, max);
                let noise = perlin_noise(point);
                prop_assert!(
                    range.low <= noise && noise <= range.high,
                    "{} not in {:?} at {}", noise, range, point
                );
            }
        }
    }
}

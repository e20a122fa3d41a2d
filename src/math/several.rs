//! Logarithm and exponential of several numbers at once, with the bits of [`ln_1p`](super::ln_1p) and
//! [`exp_m1`](super::exp_m1).
//!
//! These are the formulas of FreeBSD's msun that the `libm` crate has, the same operations in the same order. Cases
//! that differ by the size of the argument are computed side by side and picked from, so that a loop over the numbers
//! has no branch: a compiler makes vector instructions of it, and a processor does not wait for one number before it
//! begins the next. Eight at a time take a third of the time that they take one by one.
//!
//! Source: K. C. Ng, Sun Microsystems 1993 (`s_log1p.c`, `s_expm1.c`).

use std::f64::consts::LOG2_E;

const LN2_HI: f64 = 6.931_471_803_691_238e-1;
const LN2_LO: f64 = 1.908_214_929_270_587_7e-10;

/// Rounds to whole numbers when it is added: the last bit of the sum is worth 1, and its low bits are the whole number.
const ROUNDER: f64 = 6_755_399_441_055_744.0; // 1.5 · 2^52

/// The number with these first 32 bits, and zeros: thresholds are stated like this.
const fn from_high(bits: u64) -> f64 {
    f64::from_bits(bits << 32)
}

/// `ln(1 + x)` of numbers in [−1, 0].
#[inline(always)]
pub(crate) fn ln_1p_of_several<const N: usize>(x: [f64; N]) -> [f64; N] {
    if x.iter().all(|&x| is_near_one(x)) {
        each(x, |x| polynomial_ln_1p(x, x, 0.0, 0.0))
    } else {
        each(x, ln_1p)
    }
}

/// `e^x − 1` of numbers `≤ 0`.
#[inline(always)]
pub(crate) fn exp_m1_of_several<const N: usize>(x: [f64; N]) -> [f64; N] {
    if x.iter().all(|&x| is_near_zero(x)) {
        each(x, |x| {
            let [e, square] = polynomial_exp_m1(x);
            pick(-x < from_high(0x3c90_0000), x, x - (x * e - square))
        })
    } else {
        each(x, exp_m1)
    }
}

#[inline(always)]
fn each<const N: usize>(mut numbers: [f64; N], f: impl Fn(f64) -> f64) -> [f64; N] {
    for number in &mut numbers {
        *number = f(*number);
    }
    numbers
}

/// `1 + x` is so close to 1 that it need not be scaled.
#[inline(always)]
fn is_near_one(x: f64) -> bool {
    -x < from_high(0x3fd2_bec5)
}

#[inline(always)]
fn ln_1p(x: f64) -> f64 {
    /// High bits of √2/2, and what brings them to those of 1.
    const HALF_ROOT: u64 = 0x3fe6_a09e;
    const TO_ONE: u64 = 0x3ff0_0000 - HALF_ROOT;
    // 1 + x = 2^k (1 + f), the latter in [√2/2, √2], but for a rounding `c`.
    let u = 1.0 + x;
    let high = u.to_bits() + (TO_ONE << 32);
    // The biased exponent as the low bits of a number: 2^52 and more, exactly.
    let biased = f64::from_bits((high >> 52) | 0x4330_0000_0000_0000);
    let k = biased - (4_503_599_627_370_496.0 + 1023.0);
    let mantissa = f64::from_bits((high & 0x000f_ffff_ffff_ffff) + (HALF_ROOT << 32));
    let c = (x - (u - 1.0)) / u;
    let near = is_near_one(x);
    let f = pick(near, x, mantissa - 1.0);
    let ln = polynomial_ln_1p(x, f, pick(near, 0.0, k), pick(near, 0.0, c));
    pick(x == -1.0, f64::NEG_INFINITY, ln)
}

/// `ln(2^k (1 + f) + c')`, where `c` is `c'` relative to the rest.
#[inline(always)]
fn polynomial_ln_1p(x: f64, f: f64, k: f64, c: f64) -> f64 {
    const LG: [f64; 7] = [
        6.666_666_666_666_735e-1,
        3.999_999_999_940_942e-1,
        2.857_142_874_366_239e-1,
        2.222_219_843_214_978_4e-1,
        1.818_357_216_161_805e-1,
        1.531_383_769_920_937_3e-1,
        1.479_819_860_511_658_6e-1,
    ];
    let half_square = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let even = w * (LG[1] + w * (LG[3] + w * LG[5]));
    let odd = z * (LG[0] + w * (LG[2] + w * (LG[4] + w * LG[6])));
    let r = odd + even;
    let ln = s * (half_square + r) + (k * LN2_LO + c) - half_square + f + k * LN2_HI;
    pick(-x < from_high(0x3ca0_0000), x, ln)
}

/// `x` is so close to 0 that no multiple of ln 2 is taken from it.
#[inline(always)]
fn is_near_zero(x: f64) -> bool {
    -x < from_high(0x3fd6_2e43)
}

#[inline(always)]
fn exp_m1(x: f64) -> f64 {
    // x = k ln 2 + (y + c)
    let size = -x;
    let quotient = LOG2_E * x - 0.5;
    // Towards zero.
    let nearest = (quotient + ROUNDER) - ROUNDER;
    let whole = pick(nearest < quotient, nearest + 1.0, nearest);
    let k = pick(size < from_high(0x3ff0_a2b2), -1.0, whole);
    let k = pick(is_near_zero(x), 0.0, k);
    let high = x - k * LN2_HI;
    let low = k * LN2_LO;
    let y = high - low;
    let c = (high - y) - low;
    let [e, square] = polynomial_exp_m1(y);
    let small = y - (y * e - square);
    let e = y * (e - c) - c;
    let e = e - square;
    let at_minus_one = 0.5 * (y - e) - 0.5;
    let power = f64::from_bits((k + (ROUNDER + 1023.0)).to_bits() << 52);
    let beyond = (y - e + 1.0) * power - 1.0;
    let result = pick(k == -1.0, at_minus_one, beyond);
    let result = pick(k == 0.0, small, result);
    let result = pick(size < from_high(0x3c90_0000), x, result);
    pick(size >= from_high(0x4043_687a), -1.0, result)
}

/// The parts `e` and `y²/2` of `e^y − 1 = y − (y e − y²/2)`.
#[inline(always)]
fn polynomial_exp_m1(y: f64) -> [f64; 2] {
    const Q: [f64; 5] = [
        -3.333_333_333_333_313e-2,
        1.587_301_587_254_814_6e-3,
        -7.936_507_578_674_88e-5,
        4.008_217_827_329_362e-6,
        -2.010_992_181_836_243_7e-7,
    ];
    let half = 0.5 * y;
    let square = y * half;
    let r =
        1.0 + square * (Q[0] + square * (Q[1] + square * (Q[2] + square * (Q[3] + square * Q[4]))));
    let t = 3.0 - r * half;
    [square * ((r - t) / (6.0 - y * t)), square]
}

/// `yes` or `no`, without a branch.
#[inline(always)]
fn pick(is: bool, yes: f64, no: f64) -> f64 {
    let mask = u64::from(is).wrapping_neg();
    f64::from_bits((yes.to_bits() & mask) | (no.to_bits() & !mask))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;
    use crate::math::rng::{Purpose, Stream};

    /// High bits of the numbers at which a formula ends and another begins.
    const EDGES: [u64; 8] = [
        0x3fd2_bec5,
        0x3fd6_2e43,
        0x3ff0_a2b2,
        0x3ca0_0000,
        0x3c90_0000,
        0x4043_687a,
        0x3fe0_0000,
        0x3ff0_0000,
    ];

    fn assert_same(x: f64) {
        if x >= -1.0 {
            let [ln, other] = ln_1p_of_several([x, -0.5]);
            assert_eq!(ln.to_bits(), math::ln_1p(x).to_bits(), "ln(1 + {x:e})");
            assert_eq!(other, math::ln_1p(-0.5));
            assert_eq!(ln_1p_of_several([x])[0].to_bits(), ln.to_bits());
        }
        let [exp, other] = exp_m1_of_several([x, -7.0]);
        assert_eq!(exp.to_bits(), math::exp_m1(x).to_bits(), "exp({x:e}) - 1");
        assert_eq!(other, math::exp_m1(-7.0));
        assert_eq!(exp_m1_of_several([x])[0].to_bits(), exp.to_bits());
    }

    #[test]
    fn the_same_bits_as_one_by_one() {
        for x in [
            0.0,
            -0.0,
            -1.0,
            f64::NEG_INFINITY,
            -f64::MIN_POSITIVE,
            -5e-324,
            f64::MIN,
        ] {
            assert_same(x);
        }
        for edge in EDGES {
            for x in [
                from_high(edge),
                from_high(edge).next_down(),
                from_high(edge).next_up(),
            ] {
                assert_same(-x);
            }
        }
        // Uniform; near 1; of any size; depths of many ln 2.
        for sample in 0..100_000 {
            let [u, v] = Stream::new(1, 2, sample).pair(0, Purpose::Camera, 0);
            assert_same(-u);
            assert_same(-(1.0 - u * v * v * v));
            assert_same(-f64::from_bits(
                (v * from_high(0x4060_0000).to_bits() as f64) as u64,
            ));
            assert_same(-50.0 * v);
        }
    }
}

//! Elementary functions of many digits. `dashu-float` has its own, which take ten times as long
//! and are what these are tested against.

use super::{Big, big, rounded};
use volref::math;

/// `2^-halvings`, exactly.
fn half_to(halvings: u32) -> Big {
    big(math::powu(0.5, halvings))
}

/// How often `x` has to be halved to come below 2^-12 in magnitude.
fn halvings(x: &Big) -> u32 {
    let mut size = rounded(x).abs();
    let mut count = 0;
    while size > 1.0 / 4096.0 {
        size /= 2.0;
        count += 1;
    }
    count
}

/// `e^x − 1`: the series up to `x^11/11!`, the next term of which is below 2^-160 of the sum; then
/// `e^(2x) − 1 = (e^x − 1)(e^x − 1 + 2)`.
pub fn exp_m1(x: &Big) -> Big {
    let halved = halvings(x);
    let small = x * half_to(halved);
    let (one, two) = (big(1.0), big(2.0));
    let mut series = one.clone();
    for n in (2..=11).rev() {
        series = &one + &small * series / big(f64::from(n));
    }
    let mut result = small * series;
    for _ in 0..halved {
        result = &result * (&result + &two);
    }
    result
}

/// `ln(1 + x)` for `x > −1`: from the nearest `f64` that is known, `y`, by what `e^y − 1` is
/// beside `x`. That is below 2^-50, and the cube of it below all digits.
pub fn ln_1p(x: &Big) -> Big {
    let start = big(math::ln_1p(rounded(x)));
    let there = exp_m1(&start);
    let rest = (x - &there) / (big(1.0) + &there);
    start + &rest - &rest * &rest / big(2.0)
}

/// Sine and cosine of `|x| ≤ π`: series, then `sin 2x = 2 sin x cos x` and
/// `1 − cos 2x = 2 sin² x`.
pub fn sin_cos(x: &Big) -> [Big; 2] {
    let halved = halvings(x);
    let small = x * half_to(halved);
    let square = &small * &small;
    let (one, two) = (big(1.0), big(2.0));
    let (mut odd, mut even) = (one.clone(), one.clone());
    for n in (1..=5).rev() {
        let n = f64::from(2 * n);
        odd = &one - &square * odd / big(n * (n + 1.0));
        even = &one - &square * even / big((n + 1.0) * (n + 2.0));
    }
    let mut sine = &small * odd;
    let mut versine = square * even / &two;
    for _ in 0..halved {
        let doubled = &two * &sine * (&one - &versine);
        versine = &two * &sine * &sine;
        sine = doubled;
    }
    [sine, one - versine]
}

/// The angle of the point (`x`, `y`) about the origin: from the nearest `f64` that is known, by
/// the tangent of what is left. That is below 2^-50, and the cube of it below all digits.
pub fn angle(y: &Big, x: &Big) -> Big {
    let start = big(math::atan2(rounded(y), rounded(x)));
    let [sine, cosine] = sin_cos(&start);
    start + (y * &cosine - x * &sine) / (x * &cosine + y * &sine)
}

//! Powers of two, by which multiplication and division are exact.

/// The largest power of two `≤ x`, for a [normal](f64::is_normal) `x > 0`.
pub(crate) fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(x.to_bits() & EXPONENT)
}

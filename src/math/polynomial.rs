//! Real roots of polynomials.

/// Halvings of an interval, at most: more than the digits of a place that is not near 0.
const MOST_HALVINGS: usize = 100;

/// The value at `x` of the polynomial with these coefficients of 1, x, x², ….
pub fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients
        .iter()
        .rev()
        .fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// The places from `from` to `to`, in order, where the polynomial with these coefficients of 1, x, x², …
/// changes its sign. Between two such places of its derivative it rises or falls, and has one at most, found by
/// halving.
pub fn sign_changes(coefficients: &[f64], from: f64, to: f64) -> Vec<f64> {
    if coefficients.len() < 2 {
        return vec![];
    }
    let powers = coefficients[1..].iter().enumerate();
    let derivative: Vec<f64> = powers.map(|(power, c)| (power + 1) as f64 * c).collect();
    let mut turns = vec![from];
    turns.extend(sign_changes(&derivative, from, to));
    turns.push(to);
    let is_negative = |x: f64| polynomial(coefficients, x) < 0.0;
    let change = |ends: &[f64]| {
        let (mut low, mut high) = (ends[0], ends[1]);
        let before = is_negative(low);
        if before == is_negative(high) {
            return None;
        }
        for _ in 0..MOST_HALVINGS {
            let middle = low + 0.5 * (high - low);
            if middle <= low || middle >= high {
                break;
            }
            if is_negative(middle) == before {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(high)
    };
    turns.windows(2).filter_map(change).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (x + 3/4)(x + 1/4)(x − 1/8)(x − 1/2)², whose last root changes no sign.
    #[test]
    fn changes_of_sign_are_found_in_order() {
        let mut product = vec![1.0];
        for root in [-0.75, -0.25, 0.125, 0.5, 0.5] {
            let mut next = vec![0.0; product.len() + 1];
            for (power, c) in product.iter().enumerate() {
                next[power] -= root * c;
                next[power + 1] += c;
            }
            product = next;
        }
        let found = sign_changes(&product, -1.0, 1.0);
        assert_eq!(found.len(), 3, "{found:?}");
        for (found, right) in found.iter().zip([-0.75, -0.25, 0.125]) {
            assert!((found - right).abs() < 1e-14, "{found} {right}");
        }
        assert_eq!(sign_changes(&product, -0.5, 0.0).len(), 1);
        assert!(sign_changes(&[1.0], -1.0, 1.0).is_empty());
        assert!(sign_changes(&[0.0, 0.0, 0.0], -1.0, 1.0).is_empty());
    }
}

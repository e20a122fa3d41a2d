//! Multiple importance sampling.

/// The weight of a sample of density `mine > 0` that another technique samples with density
/// `other`, by the power heuristic with exponent 2. Both weights add up to 1.
///
/// Source: Veach & Guibas 1995, "Optimally combining sampling techniques for Monte Carlo
/// rendering", SIGGRAPH '95, §4.2.
pub(crate) fn power_heuristic(mine: f64, other: f64) -> f64 {
    let ratio = other / mine;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::power_heuristic;

    #[test]
    fn weights_add_up_to_one_over_the_whole_range() {
        for (a, b) in [(1.0, 1.0), (3.0, 1.0), (1e-300, 1e300), (1e200, 1e-200)] {
            assert!((power_heuristic(a, b) + power_heuristic(b, a) - 1.0).abs() < 1e-15);
        }
        assert_eq!(power_heuristic(2.0, 1.0), 0.8);
        assert_eq!(power_heuristic(1.0, 0.0), 1.0);
        assert_eq!(power_heuristic(1.0, f64::INFINITY), 0.0);
    }
}

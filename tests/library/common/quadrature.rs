//! Integrals for tests, as an independent second opinion on closed forms and densities.

use volref::math::Sum;

/// Gauss and Legendre's rule with five nodes on each of `panels` equal panels: exact for
/// polynomials of degree nine.
pub fn integral(from: f64, to: f64, panels: u32, function: impl Fn(f64) -> f64) -> f64 {
    // Abramowitz & Stegun, table 25.4.
    const NODES: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    let half = (to - from) / f64::from(panels) / 2.0;
    let mut sum = Sum::default();
    for panel in 0..panels {
        let middle = from + half * f64::from(2 * panel + 1);
        for (node, weight) in NODES {
            sum.add(weight * half * function(middle + half * node));
        }
    }
    sum.value()
}

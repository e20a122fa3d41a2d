//! Predicted variances of estimators of transmittance.

use volref::math::exp_m1;
use volref::optics::{opacity, transmittance};

/// Variance of one flight counted as 1 if it survives `depth`, as 0 if not: `T (1 − T)`.
pub fn delta_tracking_variance(depth: f64) -> f64 {
    transmittance(depth) * opacity(depth)
}

/// Variance of one ratio-tracking estimate of the transmittance of `depth`:
/// `T² (exp(∫ σ²/σ̄ dt) − 1)`, with extinction σ and majorant σ̄.
///
/// `squared_over_majorant` is that integral; at most `depth` where the majorant is one.
/// Source: Novák, Selle & Jarosz 2014, ACM TOG 33(6), 179.
pub fn ratio_tracking_variance(depth: f64, squared_over_majorant: f64) -> f64 {
    let transmitted = transmittance(depth);
    transmitted * transmitted * exp_m1(squared_over_majorant)
}

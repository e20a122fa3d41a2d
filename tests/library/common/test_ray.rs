//! The smooth test ray of the catalogue of hard cases, from 0 to [`LENGTH`].

use volref::math::sin;

/// Its length.
pub const LENGTH: f64 = 2.0;

/// Its optical depth, to the last digits.
pub const DEPTH: f64 = 4.751_743_965_520_435;

/// Its transmittance.
pub const TRANSMITTANCE: f64 = 0.008_636_620_094_049_104;

/// Its extinction at distance `t`.
pub fn smooth(t: f64) -> f64 {
    1.5 + sin(3.7 * t) + 0.6 * t * t
}

//! The sRGB transfer curve, IEC 61966-2-1.

use super::pow;

/// Linear light, in [0, 1], of an sRGB-encoded value in [0, 1].
pub fn srgb_to_linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        pow((encoded + 0.055) / 1.055, 2.4)
    }
}

/// sRGB-encoded value, in [0, 1], of linear light in [0, 1].
pub fn linear_to_srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        1.055 * pow(linear, 1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_the_round_trip() {
        for code in 0..=255_u8 {
            let linear = srgb_to_linear(f64::from(code) / 255.0);
            assert_eq!((linear_to_srgb(linear) * 255.0 + 0.5) as u8, code);
        }
    }
}

//! An error map as an image.

use super::ErrorMap;

/// The errors in the magma palette, from black for 0 to pale yellow for 1: 8-bit sRGB, row-major,
/// top row first.
pub fn magma(errors: &ErrorMap) -> Vec<[u8; 3]> {
    let colour = |error: &f64| colorous::MAGMA.eval_continuous(*error).into_array();
    errors.values().iter().map(colour).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_error_is_black_and_full_error_pale_yellow() {
        let ends = magma(&ErrorMap(vec![0.0, 1.0]));
        // The ends of the palette of S. van der Walt and N. Smith.
        assert_eq!(ends, [[0, 0, 4], [252, 253, 191]]);
    }
}

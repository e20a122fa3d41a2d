//! Perlin's improved noise.

use glam::DVec3;

/// Perlin's improved noise of 2002 at `point`, in lattice cells: 0 at points of whole
/// coordinates, twice continuously differentiable, of period 256 along each axis, within
/// ±[`NOISE_BOUND`](super::NOISE_BOUND).
///
/// Between the corners of a cell the linear functions `g·d`, `g` a corner's gradient and `d` the
/// way from the corner, are mixed by the fades `6t⁵ − 15t⁴ + 10t³` of the fractions.
///
/// Domain: any coordinates; those of magnitude 2⁶¹ and more are multiples of 256, like every such
/// `f64`; values that are not finite are treated alike.
///
/// Source: Perlin 2002, "Improving noise", ACM Transactions on Graphics 21(3), 681–682, and the
/// author's reference implementation.
pub fn perlin_noise(point: DVec3) -> f64 {
    let (i, x) = cell_and_fraction(point.x);
    let (j, y) = cell_and_fraction(point.y);
    let (k, z) = cell_and_fraction(point.z);
    noise_in_cell(gradients_around(i, j, k), DVec3::new(x, y, z))
}

/// The noise at `fraction` of a cell with these gradients at its corners, x fastest.
#[inline]
pub(super) fn noise_in_cell(gradients: [&[f64; 3]; 8], fraction: DVec3) -> f64 {
    let DVec3 { x, y, z } = fraction;
    let (u, v, w) = (fade(x), fade(y), fade(z));
    let dot = |corner: usize, x: f64, y: f64, z: f64| {
        let g = gradients[corner];
        g[0] * x + g[1] * y + g[2] * z
    };
    // Along each edge in x, by its place in y and z.
    let edge_00 = lerp(dot(0, x, y, z), dot(1, x - 1.0, y, z), u);
    let edge_10 = lerp(dot(2, x, y - 1.0, z), dot(3, x - 1.0, y - 1.0, z), u);
    let edge_01 = lerp(dot(4, x, y, z - 1.0), dot(5, x - 1.0, y, z - 1.0), u);
    let edge_11 = lerp(
        dot(6, x, y - 1.0, z - 1.0),
        dot(7, x - 1.0, y - 1.0, z - 1.0),
        u,
    );
    lerp(lerp(edge_00, edge_10, v), lerp(edge_01, edge_11, v), w)
}

/// The gradients at the corners of cell (i, j, k), x fastest; indices modulo 256.
#[inline]
pub(super) fn gradients_around(i: u8, j: u8, k: u8) -> [&'static [f64; 3]; 8] {
    let hash = |index: usize| usize::from(PERMUTATION[index]);
    // At most 255 + 255, and 1 more for the next corner: never beyond the doubled permutation.
    let (i, j, k) = (usize::from(i), usize::from(j), usize::from(k));
    let (left, right) = (hash(i) + j, hash(i + 1) + j);
    let columns = [
        hash(left) + k,
        hash(right) + k,
        hash(left + 1) + k,
        hash(right + 1) + k,
    ];
    let gradient = |index: usize| &GRADIENTS[hash(index) & 15];
    [
        gradient(columns[0]),
        gradient(columns[1]),
        gradient(columns[2]),
        gradient(columns[3]),
        gradient(columns[0] + 1),
        gradient(columns[1] + 1),
        gradient(columns[2] + 1),
        gradient(columns[3] + 1),
    ]
}

/// Index modulo 256 of the cell that holds `x`, and where in it `x` lies, in [0, 1]: 1 only by
/// rounding, just below a whole number.
#[inline]
pub(super) fn cell_and_fraction(x: f64) -> (u8, f64) {
    // 1.5·2⁵²: doubles of that size are the whole numbers, so adding it rounds `x` to one, whose
    // last bits are those of the sum. Several times as fast as asking the platform for `floor`.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    // 2⁵¹: the sum stays in the binade of `WHOLE`.
    if x.abs() < 2_251_799_813_685_248.0 {
        let sum = x + WHOLE;
        let nearest = sum - WHOLE;
        // All bits where `x` lies below it, else none: no branch, which would go the unexpected way
        // half of the time and double the cost. Adding 0 gives −0 its sign.
        let below = ((x - nearest + 0.0).to_bits() as i64 >> 63) as u64;
        let cell = nearest - f64::from_bits(below & 1.0_f64.to_bits());
        let index = (sum.to_bits() as u8).wrapping_add(below as u8);
        return (index, x - cell);
    }
    if x.abs() < TWO_TO_61 {
        let cell = x.floor();
        // Exact, as it fits 62 bits; the last 8 of two's complement are the index.
        return (cell as i64 as u8, x - cell);
    }
    (0, 0.0)
}

/// 2⁶¹: from there on doubles lie 512 apart.
const TWO_TO_61: f64 = 2_305_843_009_213_693_952.0;

/// `6t⁵ − 15t⁴ + 10t³`: from 0 to 1 over [0, 1], with no slope and no curvature at either end.
#[inline]
pub(super) fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[inline]
fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + t * (b - a)
}

/// The author's permutation of 0 to 255, twice, so that sums of an index and a hash need no
/// reduction.
const PERMUTATION: [u8; 512] = {
    let mut doubled = [0; 512];
    let mut i = 0;
    while i < 512 {
        doubled[i] = PUBLISHED[i % 256];
        i += 1;
    }
    doubled
};

/// The permutation as published.
#[rustfmt::skip]
pub(crate) const PUBLISHED: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225,
    140, 36, 103, 30, 69, 142, 8, 99, 37, 240, 21, 10, 23, 190, 6, 148,
    247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175,
    74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122,
    60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54,
    65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169,
    200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64,
    52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212,
    207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213,
    119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9,
    129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104,
    218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241,
    81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157,
    184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93,
    222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215, 61, 156, 180,
];

/// Gradient by the last four bits of a hash: towards the twelve edges of a cube, four of them
/// twice.
#[rustfmt::skip]
pub(crate) const GRADIENTS: [[f64; 3]; 16] = [
    [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0], [0.0, -1.0, 1.0], [0.0, 1.0, -1.0], [0.0, -1.0, -1.0],
    [1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [-1.0, 1.0, 0.0], [0.0, -1.0, -1.0],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::tests::failures_in;
    use proptest::prelude::*;

    #[test]
    fn the_permutation_is_one() {
        let mut sorted = PUBLISHED;
        sorted.sort_unstable();
        assert!(
            sorted
                .iter()
                .enumerate()
                .all(|(i, &hash)| i == usize::from(hash))
        );
    }

    /// The first value is the well-known one of the author's program; the others come from a
    /// sum over the eight corners in rational arithmetic, rounded once.
    #[test]
    #[allow(clippy::approx_constant, reason = "3.14 is the published argument")]
    fn published_and_exact_values() {
        for (point, value) in [
            ([3.14, 42.0, 7.0], 0.136_919_958_784_000_12),
            ([0.5, 0.5, 0.5], -0.25),
            ([-0.25, 1.75, 10.3], 0.070_738_983_787_536_6),
            ([-3.7, -12.1, 255.9], 0.231_276_652_404_785_62),
            ([123.456, -78.9, 0.1], 0.128_632_328_256_325_42),
            ([255.5, 255.5, 255.5], -0.875),
            ([1e6 + 0.3, -1e6 - 0.7, 0.9], -0.015_084_154_734_383_784),
            ([TWO_TO_61, 0.25, -7.75], -0.448_242_187_5),
        ] {
            let noise = perlin_noise(point.into());
            // Some hundred roundings of numbers up to 4, most of which cancel.
            assert!(
                (noise - value).abs() <= 16.0 * f64::EPSILON,
                "{point:?}: {noise} for {value}"
            );
        }
    }

    #[test]
    fn cells_of_huge_and_tiny_coordinates() {
        let two = |n: u32| (1_u64 << n) as f64;
        for (x, cell, fraction) in [
            (0.0, 0, 0.0),
            (-0.0, 0, 0.0),
            (0.5, 0, 0.5),
            (1.5, 1, 0.5),
            (2.5, 2, 0.5),
            (-0.5, 255, 0.5),
            (-1.5, 254, 0.5),
            (-256.0, 0, 0.0),
            (1.0_f64.next_down(), 0, 1.0_f64.next_down()),
            (-1e-300, 255, 1.0),
            (two(51) - 0.25, 255, 0.75),
            (0.25 - two(51), 0, 0.25),
            (two(51) + 3.5, 3, 0.5),
            (-two(51) - 3.5, 252, 0.5),
            (two(53) + 6.0, 6, 0.0),
            (-two(53) - 6.0, 250, 0.0),
            (two(60) + 256.0, 0, 0.0),
            (two(62), 0, 0.0),
            (f64::MIN, 0, 0.0),
            (f64::INFINITY, 0, 0.0),
            (f64::NAN, 0, 0.0),
        ] {
            assert_eq!(cell_and_fraction(x), (cell, fraction), "{x}");
        }
    }

    proptest! {
        #![proptest_config(failures_in("fixtures/proptest-regressions/perlin.txt"))]

        /// The noise vanishes at lattice points and repeats after 256 cells.
        #[test]
        fn zeros_and_period(
            cell in prop::array::uniform3(-100_000i32..100_000),
            fraction in prop::array::uniform3(0u16..1024),
            periods in prop::array::uniform3(-4096i32..4096),
        ) {
            let corner = DVec3::from_array(cell.map(f64::from));
            prop_assert_eq!(perlin_noise(corner), 0.0);
            // Sums of these have 31 bits before and 10 after the point: exact.
            let point = corner + DVec3::from_array(fraction.map(f64::from)) / 1024.0;
            let away = point + DVec3::from_array(periods.map(f64::from)) * 256.0;
            prop_assert_eq!(perlin_noise(point), perlin_noise(away));
        }

        /// The quick way to the cell is the plain one, for all that doubles can hold.
        #[test]
        fn cells_are_floors_modulo_256(x in prop::num::f64::ANY) {
            let (cell, fraction) = cell_and_fraction(x);
            prop_assert!((0.0..=1.0).contains(&fraction));
            if x.is_finite() {
                let below = x.floor();
                // Division by a power of two and both differences are exact.
                let wrapped = below - 256.0 * (below / 256.0).floor();
                prop_assert_eq!(f64::from(cell), wrapped);
                prop_assert_eq!(fraction, x - below);
            }
        }
    }
}

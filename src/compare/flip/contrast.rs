//! The eye's blur: contrast sensitivity filters (the paper's spatial filtering, section 4.1).

use std::f64::consts::PI;

use super::colour::{Colour, OpponentPlanes};
use super::kernel::Blur;
use super::plane::{PaddedRow, Plane};
use crate::math::exp;

/// A term `a·√(π/b)·exp(−π²x²/b)` of a filter, with x the distance in degrees: the inverse
/// Fourier transform of the contrast sensitivity `a·exp(−b f²)`, f in cycles per degree.
#[derive(Clone, Copy)]
struct Gaussian {
    a: f64,
    /// Square degrees.
    b: f64,
}

/// Achromatic contrast. Source: the paper's table of filter parameters, like the two below.
const ACHROMATIC: Gaussian = Gaussian { a: 1.0, b: 0.0047 };
const RED_GREEN: Gaussian = Gaussian { a: 1.0, b: 0.0053 };
/// Blue–yellow contrast is a sum of two terms.
const BLUE_YELLOW: [Gaussian; 2] = [
    Gaussian { a: 34.1, b: 0.04 },
    Gaussian { a: 13.5, b: 0.025 },
];

impl Gaussian {
    /// Weight at the square of a distance in degrees, up to its factor [`Self::height`].
    fn shape(self, distance_squared: f64) -> f64 {
        exp(-PI * PI * distance_squared / self.b)
    }

    fn height(self) -> f64 {
        self.a * (PI / self.b).sqrt()
    }

    /// Standard deviation in degrees: `exp(−π²x²/b) = exp(−x²/2σ²)`.
    fn standard_deviation(self) -> f64 {
        (self.b / (2.0 * PI * PI)).sqrt()
    }
}

/// The filters of the three opponent channels as kernels along rows and columns.
///
/// A Gaussian of the distance is a product of one along the row and one along the column. The
/// blue–yellow filter is a sum of two, each blurred on its own and then added.
#[derive(Clone, Debug)]
pub struct ContrastFilter {
    achromatic: Blur,
    red_green: Blur,
    /// Along columns, each summing to one.
    blue_yellow: [Blur; 2],
    /// The same along rows, times each term's share of the sum.
    blue_yellow_shares: [Blur; 2],
}

impl ContrastFilter {
    pub fn new(pixels_per_degree: f64) -> Self {
        // One radius for all, three standard deviations of the widest term, as in the paper.
        let widest = BLUE_YELLOW[0].standard_deviation();
        let radius = (3.0 * widest * pixels_per_degree).ceil() as usize;
        let blur = |term: Gaussian| {
            Blur::new(radius, |pixels| {
                let degrees = pixels / pixels_per_degree;
                term.shape(degrees * degrees)
            })
        };
        let terms = BLUE_YELLOW.map(blur);
        // The sum of a term over the plane is its height times the square of its sum on a line.
        let sums = [0, 1].map(|i| BLUE_YELLOW[i].height() * terms[i].1 * terms[i].1);
        let shares = sums.map(|sum| sum / (sums[0] + sums[1]));
        let [first, second] = terms.map(|(kernel, _)| kernel);
        Self {
            achromatic: blur(ACHROMATIC).0,
            red_green: blur(RED_GREEN).0,
            blue_yellow_shares: [first.scaled(shares[0]), second.scaled(shares[1])],
            blue_yellow: [first, second],
        }
    }
}

/// One row of an image as the eye sees it, in the opponent space.
#[derive(Clone, Debug)]
pub struct BlurredRow {
    /// The row blurred along columns only.
    column_blurred: PaddedRow,
    channels: [Vec<f64>; 3],
}

impl BlurredRow {
    pub fn new(width: usize, filter: &ContrastFilter) -> Self {
        Self {
            column_blurred: PaddedRow::new(width, filter.achromatic.radius()),
            channels: [(); 3].map(|()| vec![0.0; width]),
        }
    }

    /// Blurs row `y` of the image into this row.
    pub fn fill(&mut self, filter: &ContrastFilter, image: &OpponentPlanes, y: usize) {
        let [luminance, red_green, blue_yellow] = &mut self.channels;
        let between = &mut self.column_blurred;
        let mut blur = |plane: &Plane, along_column: &Blur, along_row: &Blur, sum: &mut [f64]| {
            between.fill(|row| {
                row.fill(0.0);
                along_column.add(|k| plane.row(y, k), row);
            });
            along_row.add(|k| between.shifted(k), sum);
        };

        luminance.fill(0.0);
        blur(
            image.luminance(),
            &filter.achromatic,
            &filter.achromatic,
            luminance,
        );
        red_green.fill(0.0);
        blur(
            image.red_green(),
            &filter.red_green,
            &filter.red_green,
            red_green,
        );
        blue_yellow.fill(0.0);
        for (along_column, along_row) in filter.blue_yellow.iter().zip(&filter.blue_yellow_shares) {
            blur(image.blue_yellow(), along_column, along_row, blue_yellow);
        }
    }

    /// The blurred colour of column `x`.
    pub fn colour(&self, x: usize) -> Colour {
        [
            self.channels[0][x],
            self.channels[1][x],
            self.channels[2][x],
        ]
    }
}

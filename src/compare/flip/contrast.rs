//! The eye's blur: contrast sensitivity filters (the paper's spatial filtering, section 4.1).

use std::f64::consts::PI;

use super::colour::{Colour, OpponentPlanes};
use super::kernel::Kernel;
use super::plane::PaddedRow;
use crate::math::exp;

/// A term `a·√(π/b)·exp(−π²x²/b)` of a filter, with x the distance in degrees: the inverse
/// Fourier transform of the contrast sensitivity `a·exp(−b f²)`, f in cycles per degree.
#[derive(Clone, Copy)]
struct Gaussian {
    a: f64,
    /// Width, square degrees.
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
/// The first kernel of each term runs along columns and sums to one; the kernel along rows is the same times the
/// term's share of the sum.
#[derive(Clone, Debug)]
pub struct ContrastFilter([Vec<[Kernel; 2]>; 3]);

impl ContrastFilter {
    pub fn new(pixels_per_degree: f64) -> Self {
        // One radius for all, three standard deviations of the widest term, as in the paper.
        let widest = BLUE_YELLOW[0].standard_deviation();
        let radius = (3.0 * widest * pixels_per_degree).ceil() as usize;
        let blur = |term: Gaussian| {
            Kernel::blur(radius, |pixels| {
                let degrees = pixels / pixels_per_degree;
                term.shape(degrees * degrees)
            })
        };
        let terms = BLUE_YELLOW.map(blur);
        // The sum of a term over the plane is its height times the square of its sum on a line.
        let sums = [0, 1].map(|i| BLUE_YELLOW[i].height() * terms[i].1 * terms[i].1);
        let shares = sums.map(|sum| sum / (sums[0] + sums[1]));
        let single = |term: Gaussian| {
            let (kernel, _) = blur(term);
            vec![[kernel.clone(), kernel]]
        };
        let shared =
            |((kernel, _), share): ((Kernel, f64), f64)| [kernel.clone(), kernel.scaled(share)];
        let blue_yellow = terms.into_iter().zip(shares).map(shared).collect();
        Self([single(ACHROMATIC), single(RED_GREEN), blue_yellow])
    }

    /// Radius of every kernel, pixels.
    fn radius(&self) -> usize {
        self.0[0][0][0].radius()
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
            column_blurred: PaddedRow::new(width, filter.radius()),
            channels: [(); 3].map(|()| vec![0.0; width]),
        }
    }

    /// Blurs row `y` of the image into this row.
    pub fn fill(&mut self, filter: &ContrastFilter, image: &OpponentPlanes, y: usize) {
        let between = &mut self.column_blurred;
        let channels = image.0.iter().zip(&filter.0).zip(&mut self.channels);
        for ((plane, terms), channel) in channels {
            channel.fill(0.0);
            for [along_column, along_row] in terms {
                between.filter(plane, y, along_column);
                between.add_filtered(along_row, channel);
            }
        }
    }

    /// The blurred colour of column `x`.
    pub fn colour(&self, x: usize) -> Colour {
        self.channels.each_ref().map(|channel| channel[x])
    }
}

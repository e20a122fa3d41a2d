//! One quantity over an image or a row, continued beyond its borders by its edge value.

use super::kernel::Kernel;

/// One quantity at every pixel, row-major, top row first.
#[derive(Clone, Debug)]
pub struct Plane {
    width: usize,
    height: usize,
    pub samples: Vec<f64>,
}

impl Plane {
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            samples: vec![0.0; width * height],
        }
    }

    /// The row `offset` rows below row `y`; beyond the border, the border row.
    pub fn row(&self, y: usize, offset: isize) -> &[f64] {
        let y = y.saturating_add_signed(offset).min(self.height - 1);
        &self.samples[y * self.width..][..self.width]
    }
}

/// One quantity along a row, with `margin` more samples on either side that repeat the ends.
#[derive(Clone, Debug)]
pub struct PaddedRow {
    margin: usize,
    width: usize,
    samples: Vec<f64>,
}

impl PaddedRow {
    pub fn new(width: usize, margin: usize) -> Self {
        Self {
            margin,
            width,
            samples: vec![0.0; width + 2 * margin],
        }
    }

    /// Fills the samples proper with row `y` of `plane`, filtered along columns by `kernel`, and
    /// repeats the ends into the margins.
    pub fn filter(&mut self, plane: &Plane, y: usize, kernel: &Kernel) {
        let (left, rest) = self.samples.split_at_mut(self.margin);
        let (row, right) = rest.split_at_mut(self.width);
        row.fill(0.0);
        kernel.add(|k| plane.row(y, k), row);
        left.fill(row[0]);
        right.fill(row[self.width - 1]);
    }

    /// Adds the row, filtered along itself by `kernel`, to `sum`.
    pub fn add_filtered(&self, kernel: &Kernel, sum: &mut [f64]) {
        // The row seen `offset` samples further right, by the margin at most.
        let shifted =
            |offset: isize| &self.samples[self.margin.wrapping_add_signed(offset)..][..self.width];
        kernel.add(shifted, sum);
    }
}

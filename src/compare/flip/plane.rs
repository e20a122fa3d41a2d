//! One quantity over an image or a row, continued beyond its borders by its edge value.

/// One quantity at every pixel, row-major, top row first.
#[derive(Clone, Debug)]
pub struct Plane {
    width: usize,
    height: usize,
    samples: Vec<f64>,
}

impl Plane {
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            samples: vec![0.0; width * height],
        }
    }

    pub fn samples_mut(&mut self) -> &mut [f64] {
        &mut self.samples
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

    /// Lets `write` fill the samples proper, then repeats the ends into the margins.
    pub fn fill(&mut self, write: impl FnOnce(&mut [f64])) {
        let (left, rest) = self.samples.split_at_mut(self.margin);
        let (row, right) = rest.split_at_mut(self.width);
        write(row);
        left.fill(row[0]);
        right.fill(row[self.width - 1]);
    }

    /// The row seen `offset` samples further right, `|offset| ≤ margin`: its sample `x` is
    /// sample `x + offset`.
    pub fn shifted(&self, offset: isize) -> &[f64] {
        &self.samples[self.margin.wrapping_add_signed(offset)..][..self.width]
    }
}

//! Pixels that are off, counted alike by several gates.

/// Pixels of an image by how far each is off, in what it may be off by.
#[derive(Default)]
pub(crate) struct Outliers {
    /// Number of all pixels.
    pub count: usize,
    /// Number of pixels that are off by more than they may be.
    pub outside: usize,
    /// Number of pixels that are off by more than twice that.
    pub far: usize,
    /// Index of the worst pixel, and how far it is off.
    pub worst: (usize, f64),
}

impl Outliers {
    /// By how far each pixel is off, row by row.
    pub(super) fn of(excesses: impl Iterator<Item = f64>) -> Outliers {
        let mut outliers = Outliers::default();
        for (index, excess) in excesses.enumerate() {
            outliers.count += 1;
            outliers.outside += usize::from(excess > 1.0);
            outliers.far += usize::from(excess > 2.0);
            if excess > outliers.worst.1 {
                outliers.worst = (index, excess);
            }
        }
        outliers
    }

    /// Share of the pixels that are off by more than they may be.
    pub fn share(&self) -> f64 {
        self.outside as f64 / self.count as f64
    }

    /// Share of the pixels that are off by more than twice that.
    pub fn far_share(&self) -> f64 {
        self.far as f64 / self.count as f64
    }
}

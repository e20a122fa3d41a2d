//! The range of values that is shown if nobody states one.

use super::{Grid, Lattice};
use glam::DVec3;

/// Bins of a histogram.
const BINS: usize = 256;

impl Grid<f32> {
    /// What most viewers show of the values, which must be finite: from the 1st to the 99.9th percentile, by the
    /// nearest rank. Where these are equal, from the least to the largest; where all values are equal, one end is 0.
    pub fn usual_range(&self) -> [f64; 2] {
        let mut values: Vec<f64> = self.values().iter().map(|&value| value.into()).collect();
        let last = values.len() - 1;
        let mut at = |share: f64| {
            let rank = (share * last as f64).round() as usize;
            *values.select_nth_unstable_by(rank, f64::total_cmp).1
        };
        let ([low, high], (least, most)) = ([at(0.01), at(0.999)], self.range());
        if low < high {
            [low, high]
        } else if least < most {
            [least, most]
        } else {
            let one = if least == 0.0 { 1.0 } else { least };
            [one.min(0.0), one.max(0.0)]
        }
    }

    /// True if a quarter of the values or more are at most `low`.
    pub(crate) fn is_empty_below(&self, low: f64) -> bool {
        let values = self.values().iter();
        let below = values.filter(|&&value| f64::from(value) <= low).count();
        4 * below >= self.values().len()
    }

    /// The position in a range, between 0 and 1, that best parts the values in it into two classes: with the largest
    /// variance between the classes, values beyond the ends being left out.
    ///
    /// Source: Otsu 1979, "A threshold selection method from gray-level histograms".
    pub(crate) fn threshold(&self, [low, high]: [f64; 2]) -> f64 {
        let mut counts = [0.0; BINS];
        for &value in self.values() {
            let position = (f64::from(value) - low) / (high - low);
            if (0.0..1.0).contains(&position) {
                counts[(position * BINS as f64) as usize] += 1.0;
            }
        }
        let total: f64 = counts.iter().sum();
        let moment = |(bin, count): (usize, &f64)| bin as f64 * count;
        let whole: f64 = counts.iter().enumerate().map(moment).sum();
        let (mut below, mut sum, mut best, mut most) = (0.0, 0.0, BINS / 2, 0.0);
        for (bin, &count) in counts.iter().enumerate() {
            below += count;
            sum += bin as f64 * count;
            let difference = sum * total - whole * below;
            let variance = difference * difference / (below * (total - below));
            // Not where a class is empty, and the quotient no number.
            if below > 0.0 && below < total && variance > most {
                (best, most) = (bin + 1, variance);
            }
        }
        best as f64 / BINS as f64
    }

    /// Means of the rows of nodes along an axis, as a grid of one layer with its nodes one unit apart.
    pub(crate) fn means_along(&self, axis: usize) -> Grid<f32> {
        let nodes = self.lattice().nodes();
        let stride: usize = nodes[..axis].iter().product();
        let length = nodes[axis];
        let mean = |row: usize| {
            let first = row / stride * stride * length + row % stride;
            let of = (0..length).map(|index| f64::from(self.values()[first + index * stride]));
            (of.sum::<f64>() / length as f64) as f32
        };
        let means = (0..self.values().len() / length).map(mean).collect();
        let mut layer = nodes;
        layer[axis] = 1;
        // Not where the volume lies: a layer is as thick as its nodes are apart, and might reach beyond the largest number.
        let lattice = Lattice::new(layer, DVec3::ONE, DVec3::ZERO);
        Grid::new(lattice.expect("fewer nodes"), means).expect("one for each row")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(nodes: [usize; 3], values: Vec<f32>) -> Grid<f32> {
        Grid::new(
            Lattice::new(nodes, DVec3::ONE, DVec3::ZERO).unwrap(),
            values,
        )
        .unwrap()
    }

    #[test]
    fn ranges_leave_outliers_out_and_are_never_empty() {
        let mut values: Vec<f32> = (0..=1000_u16).map(f32::from).collect();
        values[7] = 1e9;
        assert_eq!(grid([1001, 1, 1], values).usual_range(), [11.0, 1000.0]);
        let mut rare = vec![2.0; 10_000];
        rare[5] = 3.0;
        assert_eq!(grid([100, 100, 1], rare).usual_range(), [2.0, 3.0]);
        for (value, range) in [(5.0, [0.0, 5.0]), (-5.0, [-5.0, 0.0]), (0.0, [0.0, 1.0])] {
            assert_eq!(grid([2, 2, 2], vec![value; 8]).usual_range(), range);
        }
    }

    #[test]
    fn the_threshold_parts_two_classes() {
        let value = |i: u16| f32::from(i % 10) + if i < 700 { 0.0 } else { 80.0 };
        let values = (0..1000).map(value).collect();
        let threshold = grid([1000, 1, 1], values).threshold([0.0, 100.0]);
        assert!((0.09..=0.81).contains(&threshold), "{threshold}");
    }

    #[test]
    fn means_are_those_of_rows() {
        let grid = grid([2, 2, 2], vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        assert_eq!(grid.means_along(0).values(), [0.5, 2.5, 4.5, 6.5]);
        assert_eq!(grid.means_along(1).values(), [1.0, 2.0, 5.0, 6.0]);
        assert_eq!(grid.means_along(2).values(), [2.0, 3.0, 4.0, 5.0]);
        let first = DVec3::new(-1.7e308, 0.0, 0.0);
        let far = Lattice::new([2, 1, 1], DVec3::splat(1e308), first).unwrap();
        let far = Grid::new(far, vec![1.0, 3.0]).unwrap();
        assert_eq!(far.means_along(0).values(), [2.0]);
    }
}

//! Edges and points that only one image has (the paper's feature pipeline, section 4.2).

use super::kernel::Kernel;
use super::plane::{PaddedRow, Plane};
use crate::math::exp;

/// `w`: width of the features looked for, in degrees. Source: section 4.2.
const FEATURE_WIDTH: f64 = 0.082;

/// Detectors of edges and points: the first and second derivative of a Gaussian across the
/// feature, and the Gaussian itself along it.
#[derive(Clone, Debug)]
pub struct FeatureFilter {
    along: Kernel,
    edge: Kernel,
    point: Kernel,
}

impl FeatureFilter {
    pub fn new(pixels_per_degree: f64) -> Self {
        // The feature spans one standard deviation on either side of its middle.
        let sigma = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let radius = (3.0 * sigma).ceil() as usize;
        let gaussian = |x: f64| exp(-x * x / (2.0 * sigma * sigma));
        Self {
            along: Kernel::blur(radius, gaussian).0,
            edge: Kernel::slope(radius, |x| x * gaussian(x)),
            point: Kernel::bend(radius, |x| (x * x / (sigma * sigma) - 1.0) * gaussian(x)),
        }
    }
}

/// Strength of edges and points along one row of an image.
#[derive(Clone, Debug)]
pub struct FeatureRow {
    /// The row after filtering along columns only.
    column_filtered: PaddedRow,
    /// Horizontal and vertical components.
    edge: [Vec<f64>; 2],
    point: [Vec<f64>; 2],
}

impl FeatureRow {
    pub fn new(width: usize, filter: &FeatureFilter) -> Self {
        let row = || vec![0.0; width];
        Self {
            column_filtered: PaddedRow::new(width, filter.along.radius()),
            edge: [row(), row()],
            point: [row(), row()],
        }
    }

    /// Looks for features of row `y`. Luminance is a fraction of white's: (Y + 16)/116 of the
    /// paper's Y. (It prints a division by 100; the authors' errata make that 116.)
    pub fn fill(&mut self, filter: &FeatureFilter, luminance: &Plane, y: usize) {
        let [edge_across, edge_down] = &mut self.edge;
        let [point_across, point_down] = &mut self.point;
        for row in [&mut *edge_across, edge_down, point_across, point_down] {
            row.fill(0.0);
        }
        let between = &mut self.column_filtered;
        between.filter(luminance, y, &filter.along);
        between.add_filtered(&filter.edge, edge_across);
        between.add_filtered(&filter.point, point_across);
        between.filter(luminance, y, &filter.edge);
        between.add_filtered(&filter.along, edge_down);
        between.filter(luminance, y, &filter.point);
        between.add_filtered(&filter.along, point_down);
    }

    /// Strength of edge and point at column `x`: the lengths of the two gradients.
    pub fn strength(&self, x: usize) -> [f64; 2] {
        [&self.edge, &self.point].map(|[across, down]| {
            let (across, down) = (across[x], down[x]);
            (across * across + down * down).sqrt()
        })
    }
}

/// `ΔE_f`: the feature difference in [0, 1], from strengths of edge and point.
/// Source: section 4.2, `(max(|Δedge|, |Δpoint|)/√2)^q_f` with `q_f = 1/2`.
pub fn feature_difference(reference: [f64; 2], test: [f64; 2]) -> f64 {
    let edge = (reference[0] - test[0]).abs();
    let point = (reference[1] - test[1]).abs();
    (edge.max(point) * std::f64::consts::FRAC_1_SQRT_2).sqrt()
}

//! Splatting of a point cloud: every point shares its weight among the nodes around it.

use super::error::{VolumeFault, refused};
use super::{Grid, Lattice};
use crate::geometry::{Aabb, InvalidParameter};
use glam::DVec3;

/// A point of a cloud.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudPoint {
    /// World position, finite.
    pub position: DVec3,
    /// Density it carries, finite and not negative; 1 where the file gives none.
    pub weight: f64,
}

/// Resolution of the grid of a point cloud.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Splatting {
    /// Nodes along the longest side of the cloud, padding included: at least 2 + 2·padding.
    /// `None`: one point per voxel of the cloud's box, on average.
    pub resolution: Option<usize>,
    /// Empty nodes beyond the cloud on each side of each axis.
    pub padding: usize,
}

impl Default for Splatting {
    fn default() -> Splatting {
        Splatting {
            resolution: None,
            padding: 2,
        }
    }
}

/// The density grid of a cloud: [`splat_weights`], divided by the largest of them, so that the
/// densest node is exactly 1.
pub fn splat(points: &[CloudPoint], splatting: Splatting) -> Result<Grid<f32>, VolumeFault> {
    let weights = splat_weights(points, splatting)?;
    let (_, largest) = weights.range();
    if largest == 0.0 {
        let message = "every density is zero: the fourth number of a `v` line is its density";
        return refused(message);
    }
    let densities = weights.values().iter().map(|weight| weight / largest);
    let densities = densities.map(|density| density as f32).collect();
    Ok(Grid::new(*weights.lattice(), densities).expect("one density per node"))
}

/// The weight of each node when every point distributes its own to the eight nodes around it in
/// trilinear shares: for a point at `t` between two nodes of an axis, `1 − t` and `t`.
///
/// The nodes have one spacing on all axes, the longest extent of the cloud divided by
/// `resolution − 1 − 2·padding`; the first lies `padding` spacings before the cloud's minimum.
/// The other axes have as many nodes as hold their extent, and the padding. Weights add up in
/// the order of the points. Their total is that of the points, but for rounding: at most
/// `n + 6` roundings of it for `n` points (three of `1 − t` and three products in a share, and
/// the additions).
pub fn splat_weights(
    points: &[CloudPoint],
    splatting: Splatting,
) -> Result<Grid<f64>, VolumeFault> {
    let total: f64 = points.iter().map(|point| point.weight).sum();
    // Twice: no node may overflow by rounding where the total does not.
    if !(2.0 * total).is_finite() {
        return refused(
            "the weights of the points add up to more than a number holds: scale them down",
        );
    }
    let frame = SplatFrame::new(points, splatting)?;
    let lattice = frame.lattice()?;
    let count = lattice.node_count();
    let mut weights: Vec<f64> = Vec::new();
    weights
        .try_reserve_exact(count)
        .map_err(|_| format!("no memory for a grid of {count} nodes: lower the resolution"))?;
    weights.resize(count, 0.0);
    for point in points {
        let position = frame.coordinates(point.position);
        let low = position.floor();
        // Exact: both are multiples of the last place of `position`.
        let t = position - low;
        for corner in 0..8 {
            let mut node = low.to_array().map(|low| low as usize + frame.padding);
            let mut share = 1.0;
            for axis in 0..3 {
                if corner >> axis & 1 == 1 {
                    node[axis] += 1;
                    share *= t[axis];
                } else {
                    share *= 1.0 - t[axis];
                }
            }
            // A point on a node has no share in the next one, which need not exist.
            if share > 0.0 {
                weights[lattice.index(node)] += point.weight * share;
            }
        }
    }
    Ok(Grid::new(lattice, weights).expect("one weight per node"))
}

/// Intervals along the longest side of a box of size `extent` for which its voxels are about as
/// many as `points`; a side shorter than a voxel counts as one.
fn one_point_per_voxel(extent: DVec3, points: usize) -> usize {
    let shape = extent / extent.max_element();
    let voxels = |intervals: usize| (shape * intervals as f64).max(DVec3::ONE).element_product();
    // 1024 intervals of a flat cloud are a million points; more is asked for by name.
    (1..=1024)
        .take_while(|&n| voxels(n) <= points as f64)
        .last()
        .unwrap_or(1)
}

/// Frame of a cloud's grid.
struct SplatFrame {
    /// Corners of the cloud.
    min: DVec3,
    max: DVec3,
    /// Distance between nodes.
    spacing: f64,
    /// Nodes before the cloud's minimum on each axis.
    padding: usize,
    /// A point this near to a node, in spacings, lies on it.
    tolerance: f64,
}

impl SplatFrame {
    fn new(points: &[CloudPoint], splatting: Splatting) -> Result<SplatFrame, VolumeFault> {
        let Splatting {
            resolution,
            padding,
        } = splatting;
        let bounds = Aabb::around(points.iter().map(|point| point.position));
        let Aabb { min, max } = bounds.ok_or("the cloud has no points")?;
        let extent = (max - min).max_element();
        if extent == 0.0 {
            return refused(format!(
                "the point cloud has zero extent (points: {}, all at one position): it needs at least two distinct \
                 points",
                points.len()
            ));
        }
        if !extent.is_finite() {
            return refused("the cloud is wider than the largest number: scale it down");
        }
        let around = padding.saturating_mul(2).saturating_add(1);
        let resolution = resolution
            .unwrap_or_else(|| around.saturating_add(one_point_per_voxel(max - min, points.len())));
        let intervals = resolution.saturating_sub(around);
        if intervals == 0 {
            let least = around.saturating_add(1);
            return refused(format!(
                "a resolution of {resolution} with {padding} nodes of padding on each side leaves \
                 no room for the cloud: use at least {least}"
            ));
        }
        Lattice::check_count([resolution as u64, 1, 1])?;
        let spacing = extent / intervals as f64;
        let largest = min.abs().max(max.abs()).max_element();
        let tolerance = tolerance(largest, spacing, intervals);
        // Below the normal numbers the quotient has lost digits.
        if !spacing.is_normal() || tolerance >= 0.5 {
            return refused(format!(
                "the spacing of the nodes would be {spacing}, too fine beside coordinates as large \
                 as {largest}: lower the resolution, or move the cloud near the origin"
            ));
        }
        Ok(SplatFrame {
            min,
            max,
            spacing,
            padding,
            tolerance,
        })
    }

    /// Position of a point of the cloud in spacings from the cloud's minimum: a whole number
    /// where that is less than the tolerance away, so that a cloud which is itself a lattice
    /// leaves nothing on the nodes that it leaves out. Increases with `point` on every axis, so
    /// no point lies beyond `coordinates(max)`.
    ///
    /// Taken from the minimum and not from the first node, whose position is rounded.
    fn coordinates(&self, point: DVec3) -> DVec3 {
        let exact = (point - self.min) / self.spacing;
        let whole = exact.round();
        DVec3::select(
            (exact - whole).abs().cmple(DVec3::splat(self.tolerance)),
            whole,
            exact,
        )
    }

    fn lattice(&self) -> Result<Lattice, InvalidParameter> {
        // Whole multiples of the spacing have become whole numbers and gain no node.
        let intervals = self.coordinates(self.max).ceil();
        let nodes = intervals
            .to_array()
            .map(|intervals| intervals as usize + 1 + 2 * self.padding);
        let first = self.min - self.padding as f64 * self.spacing;
        Lattice::new(nodes, DVec3::splat(self.spacing), first)
    }
}

/// Largest distance, in spacings, of the computed coordinate of a point from a whole number `k`
/// when the cloud is meant to be a lattice of this spacing, whose points were computed as `first +
/// k·step` in `f64` from decimal numbers.
///
/// Let u = 2⁻⁵³, B the largest coordinate, h the spacing, N the intervals of the longest axis.
/// The step is rounded, multiplied and added: with |k·step| ≤ 2B that is an error of at most
/// 5uB, and with uB for the minimum, the difference of two positions is off by 6uB. The
/// longest extent, N·h, is off by as much, which moves k ≤ N by 6uB/h at most. Two differences
/// and two quotients are rounded: 4u·k. Together
///
/// ```text
/// 6uB/h + 6uB/h + 4uN ≤ 12u(B/h + N),
/// ```
///
/// and 16 instead of 12 covers the products of two errors. On the longest axis the maximum is
/// within the bound of N whatever the cloud: only its extent and two quotients are rounded.
///
/// Coordinates printed with fewer digits than `f64` holds are farther off, and are not helped.
fn tolerance(largest: f64, spacing: f64, intervals: usize) -> f64 {
    8.0 * f64::EPSILON * (largest / spacing + intervals as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64, z: f64) -> CloudPoint {
        CloudPoint {
            position: DVec3::new(x, y, z),
            weight: 1.0,
        }
    }

    fn error(points: &[CloudPoint], resolution: usize, padding: usize) -> String {
        let splatting = Splatting {
            resolution: Some(resolution),
            padding,
        };
        splat(points, splatting).unwrap_err().to_string()
    }

    fn weights(points: &[CloudPoint], resolution: usize, padding: usize) -> Grid<f64> {
        let splatting = Splatting {
            resolution: Some(resolution),
            padding,
        };
        splat_weights(points, splatting).unwrap()
    }

    #[test]
    fn a_point_between_nodes_gives_each_its_share() {
        // Spacing 1; the third point stands at ¼, ½, ¾ of the first cell.
        let points = [
            point(0.0, 0.0, 0.0),
            point(4.0, 2.0, 1.0),
            point(0.25, 0.5, 0.75),
        ];
        let grid = weights(&points, 5, 0);
        assert_eq!(grid.lattice().nodes(), [5, 3, 2]);
        let at = |node| grid.values()[grid.lattice().index(node)];
        assert_eq!(at([0, 0, 0]), 1.0 + 0.75 * 0.5 * 0.25);
        assert_eq!(at([1, 0, 0]), 0.25 * 0.5 * 0.25);
        assert_eq!(at([0, 1, 1]), 0.75 * 0.5 * 0.75);
        assert_eq!(at([1, 1, 1]), 0.25 * 0.5 * 0.75);
        assert_eq!(at([4, 2, 1]), 1.0);
    }

    #[test]
    fn the_densest_node_is_one() {
        let points = [
            point(0.0, 0.0, 0.0),
            point(1.0, 0.0, 0.0),
            point(1.0, 0.0, 0.0),
            point(1.0, 0.0, 0.0),
        ];
        let splatting = Splatting {
            resolution: Some(2),
            padding: 0,
        };
        let grid = splat(&points, splatting).unwrap();
        assert_eq!(grid.values(), [1.0 / 3.0, 1.0]);
    }

    #[test]
    fn padding_is_empty_and_moves_the_first_node() {
        let grid = weights(&[point(1.0, 1.0, 1.0), point(3.0, 1.0, 1.0)], 7, 2);
        assert_eq!(grid.lattice().nodes(), [7, 5, 5]);
        assert_eq!(grid.lattice().spacing(), DVec3::ONE);
        assert_eq!(grid.lattice().first(), DVec3::splat(-1.0));
        let filled: Vec<_> = (0..grid.lattice().node_count())
            .filter(|&index| grid.values()[index] != 0.0)
            .map(|index| grid.lattice().node(index))
            .collect();
        assert_eq!(filled, [[2, 2, 2], [4, 2, 2]]);
    }

    #[test]
    fn an_extent_between_two_multiples_gains_a_node() {
        let grid = weights(&[point(0.0, 0.0, 0.0), point(2.0, 1.25, 0.75)], 3, 0);
        assert_eq!(grid.lattice().nodes(), [3, 3, 2]);
    }

    /// Neither the multiples of a decimal step nor their distance from the origin spoil the
    /// lattice: one node per point, nothing beside it.
    #[test]
    fn a_cloud_that_is_a_lattice_stays_one() {
        for step in [0.0125, 0.1, 1.0 / 3.0, 0.7] {
            for first in [0.0, -0.3, 17.1, 1000.7, -123_456.789] {
                let nodes = [41, 8, 30];
                let mut points = Vec::new();
                for k in (0..nodes[2]).step_by(2) {
                    for j in 0..nodes[1] {
                        for i in 0..nodes[0] {
                            let [x, y, z] = [i, j, k].map(|n| first + f64::from(n) * step);
                            points.push(point(x, y, z));
                        }
                    }
                }
                let grid = weights(&points, 43, 1);
                assert_eq!(grid.lattice().nodes(), [43, 10, 31], "{step} {first}");
                let inside = |node: [usize; 3]| {
                    let [i, j, k] = node;
                    (1..=41).contains(&i) && (1..=8).contains(&j) && (1..=29).contains(&k)
                };
                for (index, &weight) in grid.values().iter().enumerate() {
                    let node = grid.lattice().node(index);
                    let expected = inside(node) && node[2] % 2 == 1;
                    assert_eq!(weight, f64::from(u8::from(expected)), "{step} {first}");
                }
            }
        }
    }

    #[test]
    fn flat_and_straight_clouds_make_thin_grids() {
        let flat = [
            point(0.0, 5.0, 0.0),
            point(1.0, 5.0, 0.0),
            point(0.0, 5.0, 2.0),
        ];
        assert_eq!(weights(&flat, 5, 0).lattice().nodes(), [3, 1, 5]);
        let straight = [point(0.0, 0.0, 0.0), point(0.0, 7.0, 0.0)];
        assert_eq!(weights(&straight, 5, 0).lattice().nodes(), [1, 5, 1]);
    }

    #[test]
    fn clouds_without_size_or_points() {
        assert_eq!(error(&[], 8, 1), "the cloud has no points");
        for points in [&[point(1.0, 2.0, 3.0)][..], &[point(0.0, -0.0, 0.0); 5]] {
            let expected = format!("the point cloud has zero extent (points: {}", points.len());
            assert!(error(points, 8, 1).starts_with(&expected));
        }
    }

    #[test]
    fn resolutions_that_cannot_be() {
        let pair = [point(0.0, 0.0, 0.0), point(1.0, 1.0, 1.0)];
        for (resolution, padding, least) in
            [(0, 0, 2), (1, 0, 2), (5, 2, 6), (7, usize::MAX, usize::MAX)]
        {
            assert_eq!(
                error(&pair, resolution, padding),
                format!(
                    "a resolution of {resolution} with {padding} nodes of padding on each side \
                     leaves no room for the cloud: use at least {least}"
                )
            );
        }
        for resolution in [1 << 11, 1 << 31, 1 << (usize::BITS - 4), usize::MAX] {
            let message = error(&pair, resolution, 0);
            assert!(
                message.ends_with("is too large: at most 2³¹ nodes are accepted"),
                "{message}"
            );
        }
    }

    #[test]
    fn a_cloud_lost_in_its_own_coordinates() {
        assert_eq!(
            error(&[point(1e16, 0.0, 0.0), point(1e16 + 2.0, 0.0, 0.0)], 5, 0),
            "the spacing of the nodes would be 0.5, too fine beside coordinates as large as \
             10000000000000002: lower the resolution, or move the cloud near the origin"
        );
        let tiny = f64::from_bits(5);
        assert!(error(&[point(0.0, 0.0, 0.0), point(tiny, 0.0, 0.0)], 3, 0).contains("too fine"));
        let huge = [point(-1e308, 0.0, 0.0), point(1e308, 0.0, 0.0)];
        assert_eq!(
            error(&huge, 3, 0),
            "the cloud is wider than the largest number: scale it down"
        );
        let nearly = [point(0.0, 0.0, 0.0), point(1.7e308, 0.0, 0.0)];
        assert!(error(&nearly, 5, 1).contains("beyond the largest number"));
    }

    #[test]
    fn impossible_weights() {
        let weighing = |weight| CloudPoint {
            weight,
            ..point(1.0, 0.0, 0.0)
        };
        let with = |other| error(&[point(0.0, 0.0, 0.0), other], 4, 0);
        assert!(with(weighing(1.7e308)).starts_with("the weights of the points add up to more"));
        let mut weightless = [point(0.0, 0.0, 0.0), point(1.0, 0.0, 0.0)];
        weightless.iter_mut().for_each(|point| point.weight = 0.0);
        assert!(error(&weightless, 4, 0).starts_with("every density is zero"));
    }

    #[test]
    fn without_a_resolution_a_voxel_holds_one_point_on_average() {
        // A solid block of 10 × 20 × 5 points has as many points as voxels at 20 intervals.
        assert_eq!(one_point_per_voxel(DVec3::new(1.0, 2.0, 0.5), 1000), 20);
        // A flat cloud has voxels in one layer only, a line in one row.
        assert_eq!(one_point_per_voxel(DVec3::new(3.0, 3.0, 0.0), 900), 30);
        assert_eq!(one_point_per_voxel(DVec3::new(0.0, 0.0, 7.0), 50), 50);
        assert_eq!(one_point_per_voxel(DVec3::ONE, 2), 1);
    }
}

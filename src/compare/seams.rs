//! Seams of a difference, at the borders of bricks that a volume may be stored in.
//!
//! Between neighbouring pixels a difference jumps at a seam, whether the seam itself is wrong or all behind it. Jumps are
//! gathered in layers of the volume across an axis, several to each brick, one of them around the border. If a
//! difference has nothing to do with bricks, each of the L layers of a brick is equally likely to be the steepest.
//! All of n borders are so by chance in one of Lⁿ pictures.

use super::parts::Seen;
use super::pixels::Pixels;

/// Edges of bricks, in nodes.
const EDGES: [usize; 5] = [8, 16, 32, 64, 128];

/// Fewest layers to a brick, of which one is not a border by being nearly all of it.
const FEWEST_LAYERS: f64 = 3.0;

/// Ratio of the squared jumps in the layer of a border and in any other of its brick: twice as far.
const STEEPER: f64 = 4.0;

/// Probability that such a layer is there by chance in none of all looks, of five edges along three axes: one in 370, that
/// of other measurements.
const BY_CHANCE: f64 = 1.0 / (370.0 * 15.0);

/// A jump of the difference between two neighbouring pixels.
struct Jump {
    /// Node coordinates in the middle between what they show.
    nodes: [f64; 3],
    square: f64,
}

/// Sentence on seams, without a full stop.
pub(super) fn seams(pixels: &Pixels<'_>, seen: &Seen) -> Option<String> {
    let (nodes, steps) = (seen.nodes.as_ref()?, seen.voxels?);
    if pixels.golden.noise().is_some() || pixels.test.noise().is_some() {
        return None;
    }
    let jumps = jumps(pixels, nodes);
    let found: Vec<(usize, usize, &str)> = ["x", "y", "z"]
        .into_iter()
        .enumerate()
        .filter_map(|(axis, name)| {
            let pixel = steps[0][axis].abs().max(steps[1][axis].abs());
            let of = |edge: &usize| borders(&jumps, axis, *edge, pixel).map(|n| (*edge, n, name));
            EDGES.iter().find_map(of)
        })
        .collect();
    if found.is_empty() {
        return None;
    }
    let words = found.iter().map(|(edge, borders, axis)| {
        format!("every {edge} voxels along {axis}, at all {borders} borders seen")
    });
    let words: Vec<String> = words.collect();
    Some(format!(
        "seams {}: there the difference jumps from pixel to pixel, at least twice as far as anywhere between them",
        words.join(", and ")
    ))
}

fn jumps(pixels: &Pixels<'_>, nodes: &[Option<[f64; 3]>]) -> Vec<Jump> {
    let (width, count) = (pixels.golden.width(), nodes.len());
    let jump = |i: usize, j: usize| {
        let (a, b) = (nodes[i]?, nodes[j]?);
        let square = |c: usize| {
            let jump = pixels.difference(i, c) - pixels.difference(j, c);
            0.5 * (pixels.weight(i, c) + pixels.weight(j, c)) * jump * jump
        };
        Some(Jump {
            nodes: [0, 1, 2].map(|axis| 0.5 * (a[axis] + b[axis])),
            square: (0..3).map(square).sum(),
        })
    };
    let across = (0..count).filter(|i| (i + 1) % width != 0);
    let across = across.filter_map(|i| jump(i, i + 1));
    let down = (0..count.saturating_sub(width)).filter_map(|i| jump(i, i + width));
    across.chain(down).collect()
}

/// Number of borders between bricks of that edge along an axis, if each is steeper than the rest of its bricks and
/// there are enough of them; with the width of a pixel in voxels along the axis.
fn borders(jumps: &[Jump], axis: usize, edge: usize, pixel: f64) -> Option<usize> {
    let edge = edge as f64;
    // A seam is a cell wide, and seen from half a pixel on either side.
    let layers = (edge / (1.0 + pixel)).floor();
    if layers < FEWEST_LAYERS {
        return None;
    }
    // Layer 0 is around the cell before the first node of a brick, that around the origin is no border.
    let layer = |jump: &Jump| ((jump.nodes[axis] + 0.5) / edge * layers + 0.5).floor();
    let least = jumps.iter().map(layer).fold(f64::INFINITY, f64::min);
    let most = jumps.iter().map(layer).fold(f64::NEG_INFINITY, f64::max);
    let mut sums = vec![(0.0, 0_usize); (most - least).max(0.0) as usize + 1];
    for jump in jumps {
        let (sum, count) = &mut sums[(layer(jump) - least) as usize];
        *sum += jump.square;
        *count += 1;
    }
    let mean = |layer: f64| {
        let (sum, count) = *sums
            .get((layer - least) as usize)
            .filter(|_| layer >= least)?;
        (count > 0).then(|| sum / count as f64)
    };
    let before = ((layers - 1.0) / 2.0).floor();
    let offsets = (0..layers as usize).map(|layer| layer as f64 - before);
    let offsets: Vec<f64> = offsets.filter(|&offset| offset != 0.0).collect();
    let last = (most / layers).ceil().max(0.0) as usize;
    let mut count = 0;
    for border in 1..=last {
        let centre = border as f64 * layers;
        let others = offsets.iter().map(|offset| mean(centre + offset));
        // A brick that is seen in part tells nothing.
        let (Some(here), Some(others)) = (mean(centre), others.collect::<Option<Vec<f64>>>())
        else {
            continue;
        };
        if !others.iter().all(|other| here > STEEPER * other) {
            return None;
        }
        count += 1;
    }
    let chance = (0..count).map(|_| 1.0 / layers).product::<f64>();
    (count > 0 && chance <= BY_CHANCE).then_some(count)
}

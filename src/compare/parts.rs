//! Parts of an image that may hold more than their share of a difference.

use super::pixels::Pixels;

/// Facts about the golden's pixels that its scene tells.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// Pixels at the silhouette of the volume's box, row by row.
    pub border: Option<Vec<bool>>,
    /// Width of a pixel at the volume's centre, to the right and down, in voxels along x, y and z.
    pub voxels: Option<[[f64; 3]; 2]>,
}

impl Seen {
    /// A shift by so many pixels, to the right and down, in voxels of the volume.
    pub(crate) fn voxels_in_words(&self, pixels: [f64; 2]) -> Option<String> {
        let [right, down] = self.voxels?;
        let moved = [0, 1, 2].map(|k| pixels[0] * right[k] + pixels[1] * down[k]);
        let size = moved.iter().map(|x| x * x).sum::<f64>().sqrt();
        let axes = moved.iter().zip(["x", "y", "z"]);
        let axes = axes.filter(|(x, _)| x.abs() >= LEAST_ALONG_AXIS * size);
        let axes = axes.map(|(x, axis)| {
            let sign = if *x < 0.0 { "−" } else { "+" };
            format!("{sign}{:.2} along {axis}", x.abs())
        });
        let axes: Vec<String> = axes.collect();
        let axes = axes.join(", ");
        Some(format!(
            "{size:.2} voxels at the centre of the volume: {axes}"
        ))
    }
}

/// Part of a shift along an axis of the volume below which it is not said.
const LEAST_ALONG_AXIS: f64 = 0.05;

/// Largest number of parts.
pub(super) const MOST_PARTS: usize = 3;

/// Share of the lit pixels that count as edges.
const STEEPEST: f64 = 0.2;

/// Share of the squared difference that is worth saying, and its odds over those of the part's share
/// of the pixels: a fifth of them holds half, a half of them four fifths.
const WORTH_SAYING: f64 = 0.3;
const ODDS: f64 = 4.0;

/// Pixels of one kind.
pub(super) struct Part {
    /// Place, with its preposition.
    pub words: String,
    /// Pixels that belong to it, row by row.
    pub pixels: Vec<bool>,
    /// Share of the pixels that show anything.
    pub due: f64,
}

impl Part {
    /// The parts of the golden of `pixels`; steep ones first.
    pub fn all(pixels: &Pixels<'_>, seen: &Seen) -> Vec<Part> {
        let golden = pixels.golden;
        let count = golden.radiance().len();
        let is_at_border = |i: usize| seen.border.as_ref().is_some_and(|border| border[i]);
        let shows = |i: usize| pixels.is_lit(i) || is_at_border(i);
        let shown: Vec<usize> = (0..count).filter(|&i| shows(i)).collect();
        let part = |words: &str, is_in: &dyn Fn(usize) -> bool| {
            let pixels: Vec<bool> = (0..count).map(is_in).collect();
            let inside = shown.iter().filter(|&&i| pixels[i]).count();
            let due = inside as f64 / shown.len().max(1) as f64;
            let words = words.replace(
                "{due}",
                &format!("{} of the pixels that show anything", percent(due)),
            );
            Part { words, pixels, due }
        };
        // Pixels that are not dark: a background has neither edges nor brightness.
        let lit: Vec<usize> = (0..count).filter(|&i| pixels.is_lit(i)).collect();
        let steep = quantile(lit.iter().map(|&i| pixels.steepness(i)), 1.0 - STEEPEST);
        let noise = golden.noise().filter(|noise| !noise.is_known());
        vec![
            part(
                "at edges: in the fifth of the lit pixels where the golden is steepest",
                &|i| pixels.steepness(i) > steep,
            ),
            part(
                "in pixels without noise, such as a lamp or a sky that is seen",
                &|i| noise.is_some_and(|noise| noise.variance()[i] == [0.0; 3]),
            ),
            part(
                "at the border of the volume, the silhouette of its box ({due})",
                &is_at_border,
            ),
        ]
    }

    /// True if this share of the squared difference is clearly more than the part's due.
    pub fn holds(&self, share: f64) -> bool {
        is_clearly_more(share, self.due)
    }
}

/// True if this `share` of the squared difference is worth saying of pixels of which the share is `due`.
pub(super) fn is_clearly_more(share: f64, due: f64) -> bool {
    let odds = |share: f64| share / (1.0 - share).max(1e-9);
    share >= WORTH_SAYING && odds(share.min(1.0)) >= ODDS * odds(due)
}

/// The value below which a share of the `values` lies.
fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1) as f64;
    values.get((last * share) as usize).copied().unwrap_or(0.0)
}

/// Columns or rows, from the first to the last: `columns 8 to 15`, `row 79`.
pub(super) fn lines(name: &str, [first, last]: [usize; 2]) -> String {
    if first == last {
        format!("{name} {first}")
    } else {
        format!("{name}s {first} to {last}")
    }
}

/// A share in per cent, rounded; never 0 for some, nor 100 for less than all.
pub(super) fn percent(share: f64) -> String {
    match 100.0 * share {
        all if all >= 99.95 => "all".to_owned(),
        most if most >= 99.0 => format!("{most:.1} %"),
        0.0 => "0 %".to_owned(),
        least if least < 0.05 => "less than 0.1 %".to_owned(),
        little if little < 0.95 => format!("{little:.1} %"),
        part => format!("{part:.0} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_share_is_none_or_all_by_rounding() {
        let shares = [0.0, 1e-4, 0.0039, 0.0095, 0.5, 0.989, 0.996, 1.0];
        let words = shares.map(percent);
        let right = [
            "0 %",
            "less than 0.1 %",
            "0.4 %",
            "1 %",
            "50 %",
            "99 %",
            "99.6 %",
            "all",
        ];
        assert_eq!(words, right);
    }
}

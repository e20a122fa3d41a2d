//! Placement of labels, so that none covers another or a mark.

/// A rectangle: left, top, right, bottom.
pub(super) type Box = [f64; 4];

/// Approximate width of a text: there are no fonts here to measure with.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let letters: f64 = text
        .chars()
        .map(|letter| match letter {
            'i' | 'l' | 'j' | '.' | ',' | ':' | '\'' | '|' | ' ' | 't' | 'f' | 'r' => 0.34,
            'm' | 'w' | 'M' | 'W' | '×' | '−' => 0.82,
            'A'..='Z' => 0.7,
            _ => 0.62,
        })
        .sum();
    letters * size
}

/// Areas that are occupied already.
#[derive(Debug, Default)]
pub(super) struct OccupiedAreas {
    /// Nothing may cover these.
    occupied: Vec<Box>,
    /// Points of lines, which should not be covered.
    lines: Vec<[f64; 2]>,
}

/// Points of lines that a label may cover and still be read.
const BEARABLE: usize = 5;

impl OccupiedAreas {
    pub(super) fn take(&mut self, occupied: Box) {
        self.occupied.push(occupied);
    }

    /// Adds points along a line from one end to the other.
    pub(super) fn take_line(&mut self, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2], step: f64) {
        let (dx, dy) = (x1 - x0, y1 - y0);
        let count = ((dx * dx + dy * dy).sqrt() / step).ceil() as usize;
        for at in 0..=count {
            let share = at as f64 / count.max(1) as f64;
            self.lines.push([x0 + share * dx, y0 + share * dy]);
        }
    }

    /// The left end and the middle height of a text of that size about the point, inside of
    /// `frame`, where it covers least; none where it would cover a mark or a text.
    pub(super) fn find(
        &mut self,
        [x, y]: [f64; 2],
        [width, height]: [f64; 2],
        away: f64,
        frame: Box,
    ) -> Option<[f64; 2]> {
        let slant = 0.75 * away;
        let candidates = [
            [x + away, y - height / 2.0],
            [x + slant, y - slant - height],
            [x - width / 2.0, y - away - height],
            [x + slant, y + slant],
            [x - away - width, y - height / 2.0],
            [x - slant - width, y + slant],
            [x - width / 2.0, y + away],
            [x - slant - width, y - slant - height],
        ];
        let boxes = candidates.map(|[left, top]| [left, top, left + width, top + height]);
        let free = boxes.into_iter().filter(|wanted| {
            wanted[0] >= frame[0]
                && wanted[1] >= frame[1]
                && wanted[2] <= frame[2]
                && wanted[3] <= frame[3]
                && !self
                    .occupied
                    .iter()
                    .any(|occupied| overlap(occupied, wanted))
        });
        let covered = |wanted: &Box| {
            let inside = self.lines.iter().filter(|point| contains(wanted, point));
            inside.count()
        };
        let best = free.map(|wanted| (covered(&wanted), wanted));
        let (covered, best) = best.min_by_key(|(covered, _)| *covered)?;
        if covered > BEARABLE {
            return None;
        }
        self.take(best);
        Some([best[0], (best[1] + best[3]) / 2.0])
    }
}

fn overlap(a: &Box, b: &Box) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

fn contains(a: &Box, [x, y]: &[f64; 2]) -> bool {
    a[0] < *x && *x < a[2] && a[1] < *y && *y < a[3]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_avoid_one_another_until_there_is_no_room() {
        let mut areas = OccupiedAreas::default();
        let frame = [0.0, 0.0, 100.0, 100.0];
        areas.take([45.0, 45.0, 55.0, 55.0]);
        let mut found = Vec::new();
        while let Some(at) = areas.find([50.0, 50.0], [30.0, 10.0], 8.0, frame) {
            found.push(at);
        }
        assert_eq!(found[0], [58.0, 50.0]);
        assert!((2..=8).contains(&found.len()), "{found:?}");
    }

    #[test]
    fn labels_avoid_lines() {
        let mut areas = OccupiedAreas::default();
        areas.take_line([50.0, 50.0], [100.0, 50.0], 2.0);
        let at = areas.find([50.0, 50.0], [30.0, 10.0], 8.0, [0.0, 0.0, 100.0, 100.0]);
        assert_ne!(at, Some([58.0, 50.0]));
        assert!(at.is_some());
    }
}

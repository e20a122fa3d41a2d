//! The cells of a regular division of space along a straight line.

use crate::geometry::Span;
use glam::DVec3;

/// The cells that a straight line passes, in order.
///
/// The path is given in units of cells: cell (i, j, k) reaches from (i, j, k) to (i + 1, j + 1,
/// k + 1). The outermost cells reach as far out as the path does, so what is walked is exactly
/// the span, whatever was rounded on the way. Every crossing is computed from its plane; none
/// is added up from the one before. A line in a plane between cells belongs to the cell with the
/// larger index; one that crosses an edge or corner passes no cell beside it for longer than the
/// crossings of its planes are rounded apart.
///
/// At most `nx + ny + nz − 2` cells are visited.
///
/// Source: Amanatides & Woo 1987, "A fast voxel traversal algorithm for ray tracing",
/// EUROGRAPHICS '87, with integer cells and planes in place of running sums.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    cells: [usize; 3],
    origin: DVec3,
    direction: DVec3,
    cell: [usize; 3],
    /// Distance at which the line leaves the cell along each axis; infinite if it is the last.
    crossing: DVec3,
    rest: Span,
}

/// A cell, and the segment of the line in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Visit {
    /// The cell (i, j, k).
    pub cell: [usize; 3],
    /// The segment of the line in it.
    pub span: Span,
}

impl Walk {
    /// The cells of a division into `cells`, at least one along each axis, that the line
    /// `origin + t·direction` passes for `t` in `span`, where it does not leave the division but
    /// by roundings. `direction` need not have any length.
    pub fn new(cells: [usize; 3], origin: DVec3, direction: DVec3, span: Span) -> Walk {
        let mut walk = Walk {
            cells,
            origin,
            direction,
            cell: [0; 3],
            crossing: DVec3::INFINITY,
            rest: span,
        };
        for axis in 0..3 {
            let start = origin[axis] + direction[axis] * span.near;
            // Truncation of what is below 0 is 0; so is that of no number.
            let mut index = start as usize;
            if direction[axis] < 0.0 && index as f64 == start {
                // Downwards from a plane: the cell below.
                index = index.saturating_sub(1);
            }
            walk.cell[axis] = index.min(cells[axis] - 1);
            walk.crossing[axis] = walk.exit(axis);
        }
        walk
    }

    /// Distance at which the line leaves the present cell along `axis`.
    fn exit(&self, axis: usize) -> f64 {
        let (index, direction) = (self.cell[axis], self.direction[axis]);
        let plane = if direction > 0.0 && index + 1 < self.cells[axis] {
            index + 1
        } else if direction < 0.0 && index > 0 {
            index
        } else {
            return f64::INFINITY;
        };
        (plane as f64 - self.origin[axis]) / direction
    }
}

impl Iterator for Walk {
    type Item = Visit;

    fn next(&mut self) -> Option<Visit> {
        let Span { near, far } = self.rest;
        if near >= far {
            return None;
        }
        loop {
            let axis = self.crossing.min_position();
            let (cell, crossing) = (self.cell, self.crossing[axis]);
            if crossing < far {
                if self.direction[axis] > 0.0 {
                    self.cell[axis] += 1;
                } else {
                    self.cell[axis] -= 1;
                }
                self.crossing[axis] = self.exit(axis);
            }
            let end = crossing.min(far);
            if end > near {
                self.rest.near = end;
                let span = Span::new(near, end);
                return Some(Visit { cell, span });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Ray};
    use proptest::prelude::*;

    const SIDE: usize = 8;

    fn through(origin: DVec3, towards: DVec3) -> Option<(Span, Vec<Visit>)> {
        let ray = Ray::new(origin, towards).unwrap();
        let bounds = Aabb {
            min: DVec3::ZERO,
            max: DVec3::splat(SIDE as f64),
        };
        let span = bounds.span(&ray)?;
        let walk = Walk::new([SIDE; 3], ray.origin, *ray.direction, span);
        Some((span, walk.collect()))
    }

    /// What hard case G12 asks of every walk.
    fn check(span: Span, visits: &[Visit]) {
        assert!(visits.len() <= 3 * SIDE + 1);
        let mut at = span.near;
        for visit in visits {
            assert_eq!(visit.span.near, at);
            assert!(visit.span.length() > 0.0);
            at = visit.span.far;
        }
        if span.length() > 0.0 {
            assert_eq!(at, span.far);
        }
        for pair in visits.windows(2) {
            let steps: usize = (0..3)
                .map(|axis| pair[0].cell[axis].abs_diff(pair[1].cell[axis]))
                .sum();
            assert!((1..=3).contains(&steps), "{pair:?}");
        }
    }

    #[test]
    fn in_a_plane_between_cells() {
        for plane in 0..SIDE {
            let (span, visits) = through(DVec3::new(-1.0, plane as f64, 2.5), DVec3::X).unwrap();
            check(span, &visits);
            assert_eq!(visits.len(), SIDE);
            assert!(visits.iter().all(|visit| visit.cell[1] == plane));
        }
        // The last plane is no part of a half-open box.
        assert_eq!(through(DVec3::new(-1.0, 8.0, 2.5), DVec3::X), None);
    }

    #[test]
    fn along_diagonals_of_the_lattice() {
        for signs in 0..8 {
            let sign = |axis: usize| if signs >> axis & 1 == 0 { 1.0 } else { -1.0 };
            let direction = DVec3::new(sign(0), sign(1), sign(2));
            let centre = DVec3::splat(4.0);
            let (span, visits) = through(centre - direction * 6.0, direction).unwrap();
            check(span, &visits);
            // Through corners: each of the eight cells, and slivers of rounding between them.
            let long = visits.iter().filter(|visit| visit.span.length() > 1e-12);
            assert_eq!(long.count(), SIDE);
        }
    }

    #[test]
    fn from_inside_to_an_end_that_may_be_infinite() {
        let span = Span::new(0.0, f64::INFINITY);
        let origin = DVec3::new(3.5, 4.0, 7.9);
        let walk = Walk::new([SIDE; 3], origin, DVec3::new(-1.0, 0.0, 0.0), span);
        let visits: Vec<_> = walk.collect();
        assert_eq!(visits.len(), 4);
        assert_eq!(visits[3].cell, [0, 4, 7]);
        assert_eq!(visits[3].span.far, f64::INFINITY);
        let standing = Walk::new([SIDE; 3], origin, DVec3::ZERO, span);
        assert_eq!(standing.count(), 1);
    }

    proptest! {
        /// From anywhere, anywhere to: the middle of every visit lies in its cell.
        #[test]
        fn visits_are_where_they_say(
            origin in prop::array::uniform3(-20.0..20.0_f64),
            target in prop::array::uniform3(0.0..8.0_f64),
        ) {
            let (origin, target) = (DVec3::from(origin), DVec3::from(target));
            prop_assume!((target - origin).length() > 1e-3);
            if let Some((span, visits)) = through(origin, target - origin) {
                check(span, &visits);
                let ray = Ray::new(origin, target - origin).unwrap();
                for visit in visits {
                    let middle = ray.at(0.5 * (visit.span.near + visit.span.far));
                    for axis in 0..3 {
                        let low = visit.cell[axis] as f64;
                        // Coordinates up to 20, distances up to 60: a hundred roundings.
                        prop_assert!(low - 1e-12 <= middle[axis]);
                        prop_assert!(middle[axis] <= low + 1.0 + 1e-12);
                    }
                }
            }
        }
    }
}

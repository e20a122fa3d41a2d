//! A transfer function as a table of points.

use glam::DVec3;

/// Opacity and colour of one value of the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferPoint {
    /// Value of the field, in its own unit; within the range of `f32`.
    pub value: f64,
    /// Linear RGB, `≥ 0` and finite.
    pub colour: DVec3,
    /// Opacity over the reference length, in [0, 1].
    pub opacity: f64,
}

/// Opacity and colour by value: straight lines from point to point, constant below the first
/// and above the last.
///
/// Two points at one value make a step; at the value itself the later one holds, so that
/// "opaque from 300 on" means what it says. Opacity and colour are interpolated apart from each
/// other: a point of opacity 0 has a colour, towards which its neighbours fade.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferPoints {
    points: Vec<TransferPoint>,
    values: Vec<f64>,
    /// Before the first point, between each two, and behind the last.
    lines: Vec<Line>,
}

/// A straight line of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    /// Value where it begins.
    start: f64,
    /// Difference of values over which it changes; infinite where it is constant.
    width: f64,
    opacity: f64,
    opacity_change: f64,
    colour: DVec3,
    colour_change: DVec3,
}

impl Line {
    fn between(a: &TransferPoint, b: &TransferPoint) -> Line {
        Line {
            start: a.value,
            width: b.value - a.value,
            opacity: a.opacity,
            opacity_change: b.opacity - a.opacity,
            colour: a.colour,
            colour_change: b.colour - a.colour,
        }
    }

    fn constant(point: &TransferPoint) -> Line {
        Line {
            width: f64::INFINITY,
            ..Line::between(point, point)
        }
    }

    /// Part of the line that lies before `value`; 0 where it is constant, even where `value` is NaN.
    #[inline]
    fn part(&self, value: f64) -> f64 {
        let part = (value - self.start) / self.width;
        if part > 0.0 { part } else { 0.0 }
    }
}

/// Points up to which a table is searched from end to end: the processor need not guess where it stops.
const SHORT: usize = 16;

/// Why points are no table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct TransferPointsError {
    /// The point that does not fit, from 0; none where there are no points.
    pub index: Option<usize>,
    /// The fault, in words.
    pub message: String,
}

impl TransferPoints {
    /// The table of `points`, which stand in order of their values.
    pub fn new(points: Vec<TransferPoint>) -> Result<TransferPoints, TransferPointsError> {
        let refused = |index, message: String| Err(TransferPointsError { index, message });
        if points.is_empty() {
            return refused(None, "a table of points needs at least one".into());
        }
        for (index, point) in points.iter().enumerate() {
            let value = point.value;
            // Differences of such values are finite. NaN lies in no range.
            let in_range = value.abs() <= f64::from(f32::MAX)
                && (0.0..=1.0).contains(&point.opacity)
                && point.colour.is_finite()
                && point.colour.min_element() >= 0.0;
            let earlier = |back: usize| Some(points[index.checked_sub(back)?].value);
            let message = if !in_range {
                "a point needs a value within ±3.4e38, an opacity in [0, 1] and finite colours \
                 that are not negative"
                    .to_owned()
            } else if let Some(before) = earlier(1).filter(|&before| value < before) {
                format!("the points must be sorted by value, but {value} follows {before}")
            } else if earlier(2) == Some(value) {
                // Between the sides of a step it would mean nothing.
                format!(
                    "three points have the value {value}; two make a step, and a third means nothing"
                )
            } else {
                continue;
            };
            return refused(Some(index), message);
        }
        let mut lines = vec![Line::constant(&points[0])];
        lines.extend(
            points
                .windows(2)
                .map(|pair| Line::between(&pair[0], &pair[1])),
        );
        lines.push(Line::constant(&points[points.len() - 1]));
        Ok(TransferPoints {
            values: points.iter().map(|point| point.value).collect(),
            points,
            lines,
        })
    }

    /// The points, in order of their values.
    pub fn points(&self) -> &[TransferPoint] {
        &self.points
    }

    /// Opacity over the reference length at a finite `value`, in [0, 1].
    ///
    /// Rounding does not lead out of that: of `a + (b − a)·t` with `a`, `b` in [0, 1], the
    /// rounded difference is at least `−a`, and at most `1 − a` and half an ulp of 1, which the
    /// sum rounds away.
    #[inline]
    pub fn opacity(&self, value: f64) -> f64 {
        self.look(value).0
    }

    /// Colour at a finite `value`, linear RGB.
    #[inline]
    pub fn colour(&self, value: f64) -> DVec3 {
        self.look(value).1
    }

    /// Both [opacity](TransferPoints::opacity) and [colour](TransferPoints::colour) at a finite `value`.
    #[inline]
    pub fn look(&self, value: f64) -> (f64, DVec3) {
        let line = &self.lines[self.points_up_to(value)];
        let part = line.part(value);
        (
            line.opacity + line.opacity_change * part,
            line.colour + line.colour_change * part,
        )
    }

    /// The largest channel of all colours.
    pub fn brightest(&self) -> f64 {
        let channels = self.points.iter().map(|point| point.colour.max_element());
        channels.fold(0.0, f64::max)
    }

    /// Whether every value from `least` to `most` has an opacity of exactly 0, rounding aside:
    /// both ends of every line that the interval touches have it.
    pub(crate) fn is_transparent_between(&self, least: f64, most: f64) -> bool {
        let first = self.points_up_to(least).saturating_sub(1);
        let last = match self.points_up_to(most) {
            after if after > 0 && self.points[after - 1].value == most => after - 1,
            after => after.min(self.points.len() - 1),
        };
        let touched = &self.points[first..=last];
        touched.iter().all(|point| point.opacity == 0.0)
    }

    /// Whether any value from `least` to `most` has opacity 0. Lines that do not fall below 0
    /// touch it at their ends, if at all.
    pub(crate) fn may_be_transparent_between(&self, least: f64, most: f64) -> bool {
        let inside = |point: &&TransferPoint| point.value >= least && point.value <= most;
        let mut inside = self.points.iter().filter(inside);
        self.opacity(least) == 0.0
            || self.opacity(most) == 0.0
            || inside.any(|point| point.opacity == 0.0)
    }

    /// How many points have this value or a smaller one.
    #[inline]
    fn points_up_to(&self, value: f64) -> usize {
        if self.values.len() <= SHORT {
            self.values.iter().filter(|&&point| point <= value).count()
        } else {
            self.values.partition_point(|&point| point <= value)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(value: f64, opacity: f64) -> TransferPoint {
        TransferPoint {
            value,
            colour: DVec3::new(opacity, 1.0, 3.0),
            opacity,
        }
    }

    fn table(points: &[(f64, f64)]) -> TransferPoints {
        TransferPoints::new(points.iter().map(|&(v, a)| point(v, a)).collect()).unwrap()
    }

    #[test]
    fn straight_between_points_and_constant_beyond() {
        let table = table(&[(-1000.0, 0.25), (0.0, 0.75), (1.0, 0.5)]);
        assert_eq!(table.opacity(-1e30), 0.25);
        assert_eq!(table.opacity(-1000.0), 0.25);
        assert_eq!(table.opacity(-500.0), 0.5);
        assert_eq!(table.opacity(0.0), 0.75);
        assert_eq!(table.opacity(0.5), 0.625);
        assert_eq!(table.opacity(1.0), 0.5);
        assert_eq!(table.opacity(1e30), 0.5);
        assert_eq!(table.colour(0.5), DVec3::new(0.625, 1.0, 3.0));
        assert_eq!(table.brightest(), 3.0);
    }

    #[test]
    fn a_lone_point_is_a_constant() {
        let table = table(&[(7.0, 0.5)]);
        for value in [-1e300, 7.0, 1e300] {
            assert_eq!(table.opacity(value), 0.5);
        }
        assert!(!table.is_transparent_between(-1.0, 9.0));
        assert!(!table.may_be_transparent_between(-1.0, 9.0));
    }

    #[test]
    fn at_a_step_the_later_point_holds() {
        let table = table(&[(0.0, 0.0), (1.0, 0.5), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0)]);
        assert_eq!(
            table.opacity(1.0 - f64::EPSILON / 2.0),
            0.5 - f64::EPSILON / 4.0
        );
        assert_eq!(table.opacity(1.0), 0.0);
        assert_eq!(table.opacity(2.0 - f64::EPSILON), 0.0);
        assert_eq!(table.opacity(2.0), 1.0);
        assert!(table.is_transparent_between(1.0, 1.5));
        assert!(!table.is_transparent_between(1.0 - f64::EPSILON, 1.5));
        assert!(!table.is_transparent_between(1.0, 2.0));
    }

    #[test]
    fn transparency_of_an_interval_is_that_of_every_value_in_it() {
        let table = table(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.5), (3.0, 0.0), (5.0, 0.0)]);
        for (least, most, transparent) in [
            (-9.0, -8.0, true),
            (-9.0, 1.0, true),
            (0.0, 0.0, true),
            (1.0, 1.0, true),
            (1.0, 1.0 + f64::EPSILON, false),
            (0.0, 4.0, false),
            (1.5, 1.5, false),
            (3.0, 9.0, true),
            (5.0, 5.0, true),
            (6.0, 7.0, true),
            (2.9, 3.0, false),
        ] {
            let found = table.is_transparent_between(least, most);
            assert_eq!(found, transparent, "[{least}, {most}]");
        }
        assert!(table.may_be_transparent_between(1.5, 3.5));
        assert!(!table.may_be_transparent_between(1.5, 2.5));
    }

    /// No opacity beyond 1 or below 0 by rounding, whatever the ends of the line.
    #[test]
    fn opacities_stay_in_range() {
        for a in [0.0, 1e-300, 0.1, 0.3, 0.7, 1.0 - f64::EPSILON / 2.0, 1.0] {
            for b in [0.0, 1e-17, 0.2, 0.3, 0.9, 1.0 - f64::EPSILON / 2.0, 1.0] {
                let table = table(&[(0.0, a), (3.0, b)]);
                for i in 0..=3000 {
                    let opacity = table.opacity(f64::from(i) * 0.001);
                    assert!((0.0..=1.0).contains(&opacity), "{a} {b} {opacity:e}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_table() {
        let new = |points: &[(f64, f64)]| {
            let points = points.iter().map(|&(v, a)| point(v, a)).collect();
            TransferPoints::new(points).unwrap_err()
        };
        assert_eq!(new(&[]).index, None);
        let unordered = new(&[(2.0, 0.0), (1.0, 0.0)]);
        assert_eq!(unordered.index, Some(1));
        assert!(unordered.message.ends_with("but 1 follows 2"));
        let crowded = new(&[(1.0, 0.0), (1.0, 0.5), (1.0, 0.0)]);
        assert_eq!(crowded.index, Some(2));
        assert!(
            crowded
                .message
                .starts_with("three points have the value 1;")
        );
        for bad in [(f64::NAN, 0.5), (1e39, 0.5), (0.0, f64::NAN), (0.0, 1.1)] {
            let refused = new(&[bad]);
            assert_eq!(refused.index, Some(0));
            assert!(refused.message.starts_with("a point needs a value within"));
        }
    }
}

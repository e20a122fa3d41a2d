//! Drawing of a figure: axes, curves, labels that keep clear of one another, tooltips, legend.

use super::figure::{Curve, Figure, GuideKind, Key, Panel};
use super::labels::{OccupiedAreas, width};
use super::svg::{DOTTED, Ink, Point, Svg, Theme, dashes};

/// Heights above the axes, below them, between rows of panels, and around the legend.
const ABOVE: f64 = 24.0;
const BELOW: f64 = 42.0;
const BETWEEN: f64 = 16.0;
const GAP: f64 = 8.0;
const LEGEND_LINE: f64 = 16.0;
/// Widths of the room left of the axes for labels, and for a title; and right of them.
const LABELS_LEFT: f64 = 50.0;
const TITLE_LEFT: f64 = 18.0;
const RIGHT: f64 = 12.0;

/// Sizes of text: of titles, ticks and the legend, and of labels beside points.
const TEXT: f64 = 11.5;
const LABEL: f64 = 10.5;
/// Radius of marks, and half of the size of crosses.
const RADIUS: f64 = 3.9;
const ARM: f64 = 3.0;
/// Distance between the points of a line that labels keep clear of.
const ALONG: f64 = 4.0;

/// The figure as SVG; for a page, twice: panels side by side, and one below the other for narrow
/// windows. The page shows one of them.
pub(super) fn drawn(figure: &Figure, theme: Theme) -> String {
    let broad = drawn_as(figure, theme, "broad", 800.0, figure.panels.len().max(1));
    match theme {
        Theme::Standalone => broad,
        Theme::Page => broad + &drawn_as(figure, theme, "narrow", 440.0, 1),
    }
}

/// The figure of that width, with as many panels `across`.
fn drawn_as(figure: &Figure, theme: Theme, class: &str, all: f64, across: usize) -> String {
    let entries = figure.legend.iter();
    let widest = entries.map(|(_, text)| width(text, TEXT) + 52.0);
    let columns = ((all / widest.fold(1.0, f64::max)) as usize).clamp(1, 4);
    let lines = figure.legend.len().div_ceil(columns);
    let each = [all / across as f64, ABOVE + figure.height + BELOW + BETWEEN];
    let rows = figure.panels.len().max(1).div_ceil(across);
    let legend_top = each[1] * rows as f64 - BETWEEN + GAP;
    let height = legend_top + LEGEND_LINE * lines as f64 + GAP;
    let mut svg = Svg::new(theme, class, [all, height], &figure.title);
    for (at, panel) in figure.panels.iter().enumerate() {
        let (column, row) = (at % across, at / across);
        // Side by side the first has the title of all.
        let title_left = if column == 0 { TITLE_LEFT } else { 0.0 };
        let (left, top) = (each[0] * column as f64, each[1] * row as f64 + ABOVE);
        let frame = Frame {
            panel,
            left: left + LABELS_LEFT + title_left,
            top,
            right: left + each[0] - RIGHT,
            bottom: top + figure.height,
        };
        frame.draw_axes(&mut svg, column == 0);
        frame.draw(&mut svg);
    }
    let room = (all - 20.0) / columns as f64;
    for (at, (key, text)) in figure.legend.iter().enumerate() {
        let x = 14.0 + room * (at % columns) as f64;
        let y = legend_top + LEGEND_LINE * ((at / columns) as f64 + 0.5);
        draw_key(&mut svg, *key, [[x, y], [x + 30.0, y]]);
        let text = cut(text, room - 42.0);
        svg.text(&text, [x + 37.0, y], TEXT, Ink::Text, "start");
    }
    svg.finish()
}

/// A text, or its beginning and an ellipsis where it is wider than `room`.
fn cut(text: &str, room: f64) -> String {
    let mut kept = text.to_owned();
    while width(&kept, TEXT) > room && kept.pop().is_some() {}
    if kept.len() < text.len() {
        kept.pop();
        kept.push('…');
    }
    kept
}

/// The key of an entry of a legend, about the line between two points.
fn draw_key(svg: &mut Svg, key: Key, ends: [Point; 2]) {
    let middle = [0.5 * (ends[0][0] + ends[1][0]), ends[0][1]];
    match key {
        Key::Curve(style, width, has_marks) => {
            if width > 0.0 {
                svg.line(&ends, Ink::Curve(style), width, dashes(style));
            }
            if has_marks {
                svg.mark(middle, RADIUS, style, false);
            }
        }
        // In a colour of no other mark: grey.
        Key::Hollow => svg.mark(middle, RADIUS, 6, true),
        Key::Cross => svg.cross(middle, ARM, Ink::Text),
        Key::Front => svg.line(&ends, Ink::Front, 6.0, ""),
        Key::Guide => svg.line(&ends, Ink::Guide, 1.0, DOTTED),
    }
}

/// The rectangle of the axes of a panel.
struct Frame<'p> {
    panel: &'p Panel,
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

impl Frame<'_> {
    /// The point of the drawing at a place of the axes.
    fn place(&self, [x, y]: [f64; 2]) -> Point {
        [
            self.left + self.panel.x.share(x) * (self.right - self.left),
            self.bottom - self.panel.y.share(y) * (self.bottom - self.top),
        ]
    }

    /// Shading, grid, axes, ticks and titles.
    fn draw_axes(&self, svg: &mut Svg, has_y_title: bool) {
        let (panel, corner) = (self.panel, [self.left, self.bottom]);
        for line in panel.lines.iter().filter(|line| line.is_shaded) {
            let [_, y] = self.place([panel.x.low, line.at]);
            svg.rectangle(
                [self.left, y.max(self.top)],
                [self.right, self.bottom],
                Ink::Shade,
            );
        }
        let grid = |label: &Option<String>| if label.is_some() { 1.0 } else { 0.5 };
        for (at, label) in &panel.x.ticks {
            let [x, y] = self.place([*at, panel.y.low]);
            svg.line(&[[x, self.top], [x, y]], Ink::Grid, grid(label), "");
            if let Some(label) = label {
                svg.line(&[[x, y], [x, y + 4.0]], Ink::Soft, 1.0, "");
                svg.text(label, [x, y + 12.0], TEXT, Ink::Soft, "middle");
            }
        }
        for (at, label) in &panel.y.ticks {
            let [x, y] = self.place([panel.x.low, *at]);
            svg.line(&[[x, y], [self.right, y]], Ink::Grid, grid(label), "");
            if let Some(label) = label {
                svg.line(&[[x - 4.0, y], [x, y]], Ink::Soft, 1.0, "");
                svg.text(label, [x - 7.0, y], TEXT, Ink::Soft, "end");
            }
        }
        let axes = [[self.left, self.top], corner, [self.right, self.bottom]];
        svg.line(&axes, Ink::Soft, 1.0, "");
        let middle = [
            0.5 * (self.left + self.right),
            0.5 * (self.top + self.bottom),
        ];
        let size = TEXT + 0.5;
        svg.text(
            &panel.x.title,
            [middle[0], self.bottom + 33.0],
            size,
            Ink::Text,
            "middle",
        );
        if has_y_title {
            let x = self.left - LABELS_LEFT - 6.0;
            svg.upwards(&panel.y.title, [x, middle[1]], size, Ink::Text);
        }
        let title = [self.left, self.top - 12.0];
        svg.text(&panel.title, title, TEXT + 1.0, Ink::Text, "start");
    }

    /// Everything within the axes: labels above lines and curves, tooltips above all.
    fn draw(&self, svg: &mut Svg) {
        let mut areas = OccupiedAreas::default();
        let of_lines = self.draw_lines(svg, &mut areas);
        let of_guides = self.draw_guides(svg, &mut areas);
        if self.panel.front.len() > 1 {
            let corners = self.panel.front.iter().map(|at| self.place(*at));
            svg.line(&corners.collect::<Vec<Point>>(), Ink::Front, 6.0, "");
        }
        for curve in &self.panel.curves {
            self.draw_curve(curve, svg, &mut areas);
        }
        let mut wanted = self.draw_marks(svg, &mut areas);
        for (label, at) in of_lines {
            svg.label(label, at, LABEL, Ink::Soft, "end");
        }
        wanted.extend(of_guides);
        wanted.sort_by_key(|wanted| wanted.rank);
        let frame = [self.left, self.top, self.right, self.bottom];
        for WantedLabel {
            text, spots, ink, ..
        } in wanted
        {
            let size = [width(text, LABEL), 1.15 * LABEL];
            let mut spots = spots.into_iter();
            if let Some(at) = spots.find_map(|at| areas.find(at, size, RADIUS + 3.0, frame)) {
                svg.label(text, at, LABEL, ink, "start");
            }
        }
        self.draw_tooltips(svg);
    }

    /// Lines across, and their labels with the places of these.
    fn draw_lines(&self, svg: &mut Svg, areas: &mut OccupiedAreas) -> Vec<(&str, Point)> {
        let mut labels = Vec::new();
        for line in &self.panel.lines {
            let [_, y] = self.place([self.panel.x.low, line.at]);
            let ends = [[self.left, y], [self.right, y]];
            svg.line(&ends, Ink::Soft, 1.0, "");
            areas.take_line(ends[0], ends[1], ALONG);
            // Above the line, at the right, where curves that reach so far are rare.
            let at = [self.right - 4.0, y - 0.75 * LABEL];
            let left = at[0] - width(&line.label, LABEL);
            areas.take([left, at[1] - 0.625 * LABEL, self.right, y]);
            labels.push((line.label.as_str(), at));
        }
        labels
    }

    /// Guides, and the labels wanted for them.
    fn draw_guides(&self, svg: &mut Svg, areas: &mut OccupiedAreas) -> Vec<WantedLabel<'_>> {
        let panel = self.panel;
        let mut labels = Vec::new();
        for guide in &panel.guides {
            let (from, ink) = match guide.kind {
                GuideKind::OfCurve(style) => (panel.x.low, Ink::Curve(style)),
                GuideKind::Labelled(_) => (guide.through[0], Ink::Guide),
            };
            let Some(ends) = clipped(panel, guide.through, guide.slope, from) else {
                continue;
            };
            let [a, b] = ends.map(|end| self.place(end));
            svg.line(&[a, b], ink, 1.0, DOTTED);
            if let GuideKind::Labelled(text) = &guide.kind {
                areas.take_line(a, b, ALONG);
                // A little before its end, which is at the frame, or where else there is room.
                let spots = [0.93, 0.8, 0.68, 0.56, 0.44, 0.32]
                    .map(|share| [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])));
                labels.push(WantedLabel {
                    rank: 1,
                    text,
                    spots: spots.to_vec(),
                    ink: Ink::Soft,
                });
            }
        }
        labels
    }

    /// The line of a curve, whiskers and crosses.
    fn draw_curve(&self, curve: &Curve, svg: &mut Svg, areas: &mut OccupiedAreas) {
        let ink = Ink::Curve(curve.style);
        let points: Vec<Point> = curve
            .points
            .iter()
            .map(|point| self.place(point.at))
            .collect();
        if curve.width > 0.0 && points.len() > 1 {
            svg.line(&points, ink, curve.width, dashes(curve.style));
            for pair in points.windows(2) {
                areas.take_line(pair[0], pair[1], ALONG);
            }
        }
        for (point, &[x, y]) in curve.points.iter().zip(&points) {
            if let Some(ends) = point.whiskers {
                let [from, to] = ends.map(|end| self.place([end, point.at[1]])[0]);
                areas.take_line([from, y], [to, y], 0.5 * ALONG);
                svg.line(&[[from, y], [to, y]], ink, 1.0, "");
                for end in [from, to] {
                    svg.line(&[[end, y - ARM], [end, y + ARM]], ink, 1.0, "");
                }
            }
            if let Some((height, _)) = &point.cross {
                let [_, y] = self.place([point.at[0], *height]);
                svg.cross([x, y], ARM, ink);
                areas.take([x - ARM, y - ARM, x + ARM, y + ARM]);
            }
        }
    }

    /// Marks of points, and the labels wanted for them.
    fn draw_marks(&self, svg: &mut Svg, areas: &mut OccupiedAreas) -> Vec<WantedLabel<'_>> {
        let mut labels = Vec::new();
        let curves = self.panel.curves.iter();
        for curve in curves.filter(|curve| curve.marks > 0.0) {
            let (radius, last) = (RADIUS * curve.marks, curve.points.len().saturating_sub(1));
            for (at, point) in curve.points.iter().enumerate() {
                let [x, y] = self.place(point.at);
                svg.mark([x, y], radius, curve.style, point.is_hollow);
                let reach = radius + 0.5;
                areas.take([x - reach, y - reach, x + reach, y + reach]);
                let Some(text) = &point.label else {
                    continue;
                };
                labels.push(WantedLabel {
                    // The ends of all curves before the points between them.
                    rank: match at {
                        _ if point.is_urgent => 0,
                        _ if at == 0 || at == last => 1,
                        _ => 2 + at % 2,
                    },
                    text,
                    spots: vec![[x, y]],
                    ink: Ink::Curve(curve.style),
                });
            }
        }
        labels
    }

    fn draw_tooltips(&self, svg: &mut Svg) {
        for point in self.panel.curves.iter().flat_map(|curve| &curve.points) {
            svg.tooltip(self.place(point.at), &point.tooltip);
            if let Some((height, tooltip)) = &point.cross {
                svg.tooltip(self.place([point.at[0], *height]), tooltip);
            }
        }
    }
}

/// A label that is drawn where there is room.
struct WantedLabel<'p> {
    /// Labels of lower rank come first.
    rank: usize,
    text: &'p str,
    /// Points beside which it may stand, the best first.
    spots: Vec<Point>,
    ink: Ink,
}

/// The part of a line that is inside of the panel, from `from` on to the right.
fn clipped(panel: &Panel, [x, y]: [f64; 2], slope: f64, from: f64) -> Option<[[f64; 2]; 2]> {
    let mut ends = [from.max(panel.x.low), panel.x.high];
    if slope != 0.0 {
        let mut crossings = [panel.y.low, panel.y.high].map(|height| x + (height - y) / slope);
        crossings.sort_by(f64::total_cmp);
        ends = [ends[0].max(crossings[0]), ends[1].min(crossings[1])];
    }
    (ends[0] < ends[1]).then(|| ends.map(|end| [end, y + slope * (end - x)]))
}

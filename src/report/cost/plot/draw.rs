//! Draws a picture. `plotters` draws axes, grid, lines and marks; dashes, labels that keep clear of
//! one another and tooltips are added to its text.

use super::labels::{OccupiedAreas, width};
use super::picture::{LegendEntry, LegendKey, PlotPanel, PlotPicture};
use super::stroke::{Stroke, Theme, shape, themed};
use plotters::backend::SVGBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon, Rectangle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontFamily, IntoFont, IntoTextStyle, ShapeStyle, TextStyle};
use std::fmt::Write;

/// `plotters` draws at whole numbers: a unit of its is a tenth of ours.
const FINE: i32 = 10;

/// How the panels of a picture are put together.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PlotLayout {
    /// Side by side.
    Broad,
    /// One below the other, for narrow windows.
    Narrow,
}

impl PlotLayout {
    /// Width of a picture.
    fn width(self) -> i32 {
        match self {
            PlotLayout::Broad => 800,
            PlotLayout::Narrow => 440,
        }
    }
}

/// Heights above the axes, and of what is below them.
const ABOVE: i32 = 24;
const TICKS_BELOW: i32 = 42;
const LEGEND_LINE: i32 = 16;
/// Above and below a legend.
const GAP: i32 = 8;
/// Widths of what is left of the axes: the labels of ticks, and a title; and right of them.
const TICKS_LEFT: i32 = 46;
const TITLE_LEFT: i32 = 18;
const LEFT: i32 = 4;
const RIGHT: i32 = 12;

const TEXT: f64 = 11.5;
const LABEL: f64 = 10.5;
/// Of marks.
const RADIUS: f64 = 3.9;

const FONT: &str = "system-ui, Helvetica, Arial, sans-serif";

type PlotCanvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The picture as SVG; for a page, twice: broad and narrow, of which the page shows one.
pub(super) fn drawn(picture: &PlotPicture, theme: Theme) -> String {
    match theme {
        Theme::Standalone => drawn_as(picture, theme, PlotLayout::Broad),
        Theme::Page => [PlotLayout::Broad, PlotLayout::Narrow]
            .map(|layout| drawn_as(picture, theme, layout))
            .concat(),
    }
}

fn drawn_as(picture: &PlotPicture, theme: Theme, layout: PlotLayout) -> String {
    let all = layout.width();
    let count = picture.panels.len().max(1) as i32;
    let (across, down) = match layout {
        PlotLayout::Broad => (count, 1),
        PlotLayout::Narrow => (1, count),
    };
    let columns = legend_columns(&picture.legend, all);
    let lines = picture.legend.len().div_ceil(columns) as i32;
    let between = 2 * GAP;
    let panel_height = ABOVE + picture.height + TICKS_BELOW;
    let axes = panel_height * down + between * (down - 1) + GAP;
    let height = axes + LEGEND_LINE * lines + GAP;
    let mut svg = String::new();
    let mut over = String::new();
    {
        let size = ((all * FINE) as u32, (height * FINE) as u32);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        for (at, panel) in picture.panels.iter().enumerate() {
            let (column, row) = (at as i32 % across, at as i32 / across);
            let corner = [column * (all / across), row * (panel_height + between)];
            // Side by side the first has the title of all.
            let titled = match layout {
                PlotLayout::Broad => panel,
                PlotLayout::Narrow => &picture.panels[0],
            };
            let size = [all / across, picture.height];
            draw_panel(
                &root,
                panel,
                &titled.y.title,
                [corner, size],
                theme,
                &mut over,
            );
        }
        let each = (all - 20) / columns as i32;
        for (at, entry) in picture.legend.iter().enumerate() {
            let x = 14 + each * (at % columns) as i32;
            let y = axes + LEGEND_LINE * (at / columns) as i32;
            draw_entry(&root, entry, [x, y], each - 4, theme, &mut over);
        }
        root.present().expect(STRING);
    }
    let body = &svg[svg.find('>').map_or(0, |end| end + 1)..];
    let body = body.replace("</svg>", "");
    let body = themed(body, theme);
    let mut out = String::from("<svg xmlns=\"http://www.w3.org/2000/svg\"");
    let _ = match (theme, layout) {
        (Theme::Standalone, _) => write!(out, " width=\"{all}\" height=\"{height}\""),
        (Theme::Page, PlotLayout::Broad) => write!(out, " class=\"broad\""),
        (Theme::Page, PlotLayout::Narrow) => write!(out, " class=\"narrow\""),
    };
    let _ = writeln!(
        out,
        " viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" font-family=\"{FONT}\" \
         stroke-linejoin=\"round\" stroke-linecap=\"round\">",
        all * FINE,
        height * FINE,
        escaped(&picture.title)
    );
    if theme == Theme::Standalone {
        out.push_str("<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n");
    }
    out.push_str(&body);
    out.push_str(&over);
    out.push_str("</svg>\n");
    out
}

const STRING: &str = "a string takes every drawing";

/// As many columns as have room for the longest entry.
fn legend_columns(legend: &[LegendEntry], room: i32) -> usize {
    let widths = legend.iter().map(|entry| width(&entry.text, TEXT) + 52.0);
    let widest = widths.fold(1.0, f64::max);
    ((f64::from(room) / widest) as usize).clamp(1, 4)
}

fn fine(length: f64) -> i32 {
    (length * f64::from(FINE)).round() as i32
}

fn stroke(stroke: Stroke, width: f64) -> ShapeStyle {
    ShapeStyle {
        color: stroke.code().into(),
        filled: false,
        stroke_width: fine(width) as u32,
    }
}

fn filling(stroke: Stroke) -> ShapeStyle {
    ShapeStyle {
        color: stroke.code().into(),
        filled: true,
        stroke_width: 0,
    }
}

/// A style of text; `plotters` writes sizes divided by 1.24.
fn text_style(size: f64, stroke: Stroke) -> TextStyle<'static> {
    let font = (FontFamily::Name(FONT), size * f64::from(FINE) * 1.24).into_font();
    font.color(&stroke.code()).into_text_style(&(0, 0))
}

fn line(canvas: &PlotCanvas<'_>, points: Vec<(i32, i32)>, style: ShapeStyle) {
    canvas.draw(&PathElement::new(points, style)).expect(STRING);
}

fn draw_panel(
    root: &PlotCanvas<'_>,
    panel: &PlotPanel,
    y_title: &str,
    [[left, top], [width_all, height]]: [[i32; 2]; 2],
    theme: Theme,
    over: &mut String,
) {
    let area = root.clone().shrink(
        (left * FINE, top * FINE),
        (width_all * FINE, (ABOVE + height + TICKS_BELOW) * FINE),
    );
    let title_left = if y_title.is_empty() { 0 } else { TITLE_LEFT };
    let mut chart = ChartBuilder::on(&area)
        .margin_top(ABOVE * FINE)
        .margin_right(RIGHT * FINE)
        .margin_left(LEFT * FINE)
        .x_label_area_size(TICKS_BELOW * FINE)
        .y_label_area_size((TICKS_LEFT + title_left) * FINE)
        .build_cartesian_2d(panel.x.clone(), panel.y.clone())
        .expect(STRING);
    let on_chart = |x: f64, y: f64| chart.backend_coord(&(x, y));
    let (x0, y1) = on_chart(panel.x.low, panel.y.low);
    let (x1, y0) = on_chart(panel.x.high, panel.y.high);
    // Below everything, the grid too.
    for each in panel.lines.iter().filter(|each| each.is_shaded) {
        let (_, y) = on_chart(panel.x.low, each.at);
        let shade = Rectangle::new([(x0, y.max(y0)), (x1, y1)], filling(Stroke::Shade));
        root.draw(&shade).expect(STRING);
    }
    let mut mesh = chart.configure_mesh();
    mesh.bold_line_style(stroke(Stroke::Grid, 1.0))
        .light_line_style(stroke(Stroke::Grid, 0.5))
        .axis_style(stroke(Stroke::Soft, 1.0))
        .label_style(text_style(TEXT, Stroke::Soft))
        .axis_desc_style(text_style(TEXT + 0.5, Stroke::Text))
        .x_desc(panel.x.title.as_str())
        .set_all_tick_mark_size(4 * FINE);
    if !y_title.is_empty() {
        mesh.y_desc(y_title);
    }
    mesh.draw().expect(STRING);
    let title = text_style(TEXT + 1.0, Stroke::Text).pos(Pos::new(HPos::Left, VPos::Top));
    root.draw_text(&panel.title, &title, (x0, (top + 5) * FINE))
        .expect(STRING);

    let to_pixels = |at: [f64; 2]| {
        let (x, y) = chart.backend_coord(&(at[0], at[1]));
        [f64::from(x), f64::from(y)]
    };
    let frame = [x0, y0, x1, y1].map(f64::from);
    let mut areas = OccupiedAreas::default();
    let whole = |[x, y]: [f64; 2]| (x.round() as i32, y.round() as i32);
    let unit = f64::from(FINE);

    for each in &panel.lines {
        let [_, y] = to_pixels([panel.x.low, each.at]);
        line(
            root,
            vec![(x0, y as i32), (x1, y as i32)],
            stroke(Stroke::Soft, 1.0),
        );
        areas.take_line([frame[0], y], [frame[2], y], 4.0 * unit);
        let size = [width(&each.label, LABEL) * unit, 1.25 * LABEL * unit];
        // Above the line, at the right, where curves that reach so far are rare.
        let at = [frame[2] - 4.0 * unit, y - 0.75 * LABEL * unit];
        areas.take([at[0] - size[0], at[1] - size[1] / 2.0, frame[2], y]);
        push_label(over, &each.label, at, Stroke::Soft, theme, "end");
    }
    let mut guide_labels = Vec::new();
    for guide in &panel.guides {
        let from = if guide.is_ray {
            guide.through[0]
        } else {
            panel.x.low
        };
        let Some([a, b]) = clipped(panel, guide.through, guide.slope, from) else {
            continue;
        };
        let (a, b) = (to_pixels(a), to_pixels(b));
        let of_guide = guide.style.map_or(Stroke::Guide, Stroke::Dots);
        line(root, vec![whole(a), whole(b)], stroke(of_guide, 1.0));
        if let Some(label) = &guide.label {
            areas.take_line(a, b, 4.0 * unit);
            // A little before its end, which is at the frame, or where else there is room.
            let at = [0.93, 0.8, 0.68, 0.56, 0.44, 0.32]
                .map(|share| [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])));
            guide_labels.push((label, at.to_vec()));
        }
    }
    if panel.front.len() > 1 {
        let corners = panel.front.iter().map(|at| whole(to_pixels(*at)));
        line(root, corners.collect(), stroke(Stroke::Front, 6.0));
    }
    for curve in &panel.curves {
        let points: Vec<[f64; 2]> = curve
            .points
            .iter()
            .map(|point| to_pixels(point.at))
            .collect();
        if curve.is_joined && points.len() > 1 {
            let thickness = if curve.is_wide { 2.8 } else { 1.5 };
            line(
                root,
                points.iter().map(|at| whole(*at)).collect(),
                stroke(Stroke::Line(curve.style), thickness),
            );
            for pair in points.windows(2) {
                areas.take_line(pair[0], pair[1], 4.0 * unit);
            }
        }
        for point in &curve.points {
            let [x, y] = to_pixels(point.at);
            if let Some([from, to]) = point.whiskers {
                let [from, _] = to_pixels([from, point.at[1]]);
                let [to, _] = to_pixels([to, point.at[1]]);
                areas.take_line([from, y], [to, y], 2.0 * unit);
                let style = stroke(Stroke::Curve(curve.style), 1.0);
                line(root, vec![whole([from, y]), whole([to, y])], style);
                for end in [from, to] {
                    let tip = 3.0 * unit;
                    line(
                        root,
                        vec![whole([end, y - tip]), whole([end, y + tip])],
                        style,
                    );
                }
            }
            if let Some((height, _)) = &point.cross {
                let [_, y] = to_pixels([point.at[0], *height]);
                let arm = 3.0 * unit;
                let style = stroke(Stroke::Curve(curve.style), 1.4);
                for sign in [-1.0, 1.0] {
                    let ends = vec![
                        whole([x - arm, y - sign * arm]),
                        whole([x + arm, y + sign * arm]),
                    ];
                    line(root, ends, style);
                }
                areas.take([x - arm, y - arm, x + arm, y + arm]);
            }
        }
    }
    for curve in panel.curves.iter().filter(|curve| curve.marks > 0.0) {
        for point in &curve.points {
            let [x, y] = to_pixels(point.at);
            let radius = RADIUS * curve.marks;
            draw_mark(root, whole([x, y]), radius, curve.style, point.is_hollow);
            let reach = (radius + 0.5) * unit;
            areas.take([x - reach, y - reach, x + reach, y + reach]);
        }
    }
    // The ends of all curves before what is between them.
    let mut wanted = Vec::new();
    for curve in &panel.curves {
        let last = curve.points.len().saturating_sub(1);
        for (at, point) in curve.points.iter().enumerate() {
            if let Some(label) = &point.label {
                let rank = match at {
                    _ if point.is_urgent => 0,
                    _ if at == 0 || at == last => 1,
                    _ => 2 + at % 2,
                };
                wanted.push((
                    rank,
                    label,
                    vec![to_pixels(point.at)],
                    Stroke::Curve(curve.style),
                ));
            }
        }
    }
    for (label, at) in guide_labels {
        wanted.push((1, label, at, Stroke::Soft));
    }
    wanted.sort_by_key(|(rank, ..)| *rank);
    for (_, label, spots, stroke) in wanted {
        let size = [width(label, LABEL) * unit, 1.15 * LABEL * unit];
        let mut found = spots
            .into_iter()
            .filter_map(|at| areas.find(at, size, (RADIUS + 3.0) * unit, frame));
        if let Some(at) = found.next() {
            push_label(over, label, at, stroke, theme, "start");
        }
    }
    for curve in &panel.curves {
        for point in &curve.points {
            push_tooltip(over, to_pixels(point.at), &point.tooltip);
            if let Some((height, tooltip)) = &point.cross {
                push_tooltip(over, to_pixels([point.at[0], *height]), tooltip);
            }
        }
    }
}

/// The part of a line that is inside of the panel, from `from` on to the right.
fn clipped(panel: &PlotPanel, [x, y]: [f64; 2], slope: f64, from: f64) -> Option<[[f64; 2]; 2]> {
    let mut ends = [from.max(panel.x.low), panel.x.high];
    if slope != 0.0 {
        let mut crossings = [panel.y.low, panel.y.high].map(|height| x + (height - y) / slope);
        crossings.sort_by(f64::total_cmp);
        ends = [ends[0].max(crossings[0]), ends[1].min(crossings[1])];
    }
    (ends[0] < ends[1]).then(|| ends.map(|end| [end, y + slope * (end - x)]))
}

fn draw_mark(
    canvas: &PlotCanvas<'_>,
    (x, y): (i32, i32),
    radius: f64,
    style: usize,
    is_hollow: bool,
) {
    let (inside, outside) = match is_hollow {
        true => (filling(Stroke::Back), stroke(Stroke::Curve(style), 1.3)),
        // An edge in the colour of the paper tells marks apart that lie on one another.
        false => (filling(Stroke::Curve(style)), stroke(Stroke::Back, 0.7)),
    };
    let corners = shape(style);
    if corners.is_empty() {
        for look in [inside, outside] {
            let circle = Circle::new((x, y), fine(radius), look);
            canvas.draw(&circle).expect(STRING);
        }
        return;
    }
    let mut around: Vec<(i32, i32)> = corners
        .iter()
        .map(|[dx, dy]| (x + fine(radius * dx), y + fine(radius * dy)))
        .collect();
    canvas
        .draw(&Polygon::new(around.clone(), inside))
        .expect(STRING);
    around.push(around[0]);
    line(canvas, around, outside);
}

/// A line of a legend, cut to `room`.
fn draw_entry(
    canvas: &PlotCanvas<'_>,
    entry: &LegendEntry,
    [x, y]: [i32; 2],
    room: i32,
    theme: Theme,
    over: &mut String,
) {
    let (left, right, middle) = (x * FINE, (x + 30) * FINE, (y + LEGEND_LINE / 2) * FINE);
    let centre = ((left + right) / 2, middle);
    let across = vec![(left, middle), (right, middle)];
    match entry.key {
        LegendKey::Curve(style, is_wide) => {
            let thickness = if is_wide { 2.8 } else { 1.5 };
            line(canvas, across, stroke(Stroke::Line(style), thickness));
            draw_mark(canvas, centre, RADIUS, style, false);
        }
        LegendKey::Line(style) => line(canvas, across, stroke(Stroke::Line(style), 1.5)),
        LegendKey::Mark(style) => draw_mark(canvas, centre, RADIUS, style, false),
        LegendKey::Hollow => draw_mark(canvas, centre, RADIUS, 6, true),
        LegendKey::Cross => {
            let arm = 3 * FINE;
            for sign in [-1, 1] {
                let ends = vec![
                    (centre.0 - arm, middle - sign * arm),
                    (centre.0 + arm, middle + sign * arm),
                ];
                line(canvas, ends, stroke(Stroke::Text, 1.4));
            }
        }
        LegendKey::Front => line(canvas, across, stroke(Stroke::Front, 6.0)),
        LegendKey::Guide => line(canvas, across, stroke(Stroke::Guide, 1.0)),
    }
    let mut text = entry.text.clone();
    while width(&text, TEXT) > f64::from(room - 38) && text.pop().is_some() {}
    if text.len() < entry.text.len() {
        text.pop();
        text.push('…');
    }
    let at = [f64::from(right + 7 * FINE), f64::from(middle)];
    push_text(over, &text, at, TEXT, Stroke::Text, theme, "");
}

/// A text with an edge in the colour of the paper, to be read above lines.
fn push_label(
    over: &mut String,
    text: &str,
    at: [f64; 2],
    stroke: Stroke,
    theme: Theme,
    anchor: &str,
) {
    let edge = format!(
        " text-anchor=\"{anchor}\" stroke=\"{}\" stroke-width=\"30\" paint-order=\"stroke\"",
        Stroke::Back.colour(theme)
    );
    push_text(over, text, at, LABEL, stroke, theme, &edge);
}

fn push_text(
    over: &mut String,
    text: &str,
    [x, y]: [f64; 2],
    size: f64,
    stroke: Stroke,
    theme: Theme,
    more: &str,
) {
    let _ = writeln!(
        over,
        "<text x=\"{x:.0}\" y=\"{y:.0}\" dy=\".35em\" font-size=\"{}\" fill=\"{}\"{more}>{}</text>",
        size * f64::from(FINE),
        stroke.colour(theme),
        escaped(text)
    );
}

/// Browsers show the title of what the pointer rests on.
fn push_tooltip(over: &mut String, [x, y]: [f64; 2], tooltip: &str) {
    if !tooltip.is_empty() {
        let _ = writeln!(
            over,
            "<circle cx=\"{x:.0}\" cy=\"{y:.0}\" r=\"70\" fill=\"#000\" fill-opacity=\"0\"><title>{}</title></circle>",
            escaped(tooltip)
        );
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

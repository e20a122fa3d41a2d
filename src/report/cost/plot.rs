//! Error against work, and against time: SVG that needs neither fonts nor network.

use super::words;
use crate::cost::{Cost, Level, Sweep};
use crate::files::visible::xml_text;
use crate::math::log10;
use std::fmt::Write as _;

/// Width of the drawing, height of a panel, and what is above, below and beside the axes.
const WIDTH: f64 = 800.0;
const HEIGHT: f64 = 340.0;
const ABOVE: f64 = 26.0;
const BELOW: f64 = 44.0;
const LEFT: f64 = 66.0;
const BETWEEN: f64 = 20.0;
const RIGHT: f64 = 14.0;
/// Height of a line of the legend.
const LINE: f64 = 17.0;

/// Colours on white, dark enough to be read as text (at least 4.5 to 1); one for each sweep that there can be.
const COLOURS: [&str; 3] = ["#0b5cad", "#b3400a", "#00705a"];
/// Place of the labels of a curve, right of its marks and below; and the side that they end at.
const LABELS: [(f64, f64, &str); 3] = [
    (6.0, -7.0, "start"),
    (-6.0, 9.0, "end"),
    (7.0, 9.0, "start"),
];

const INK: &str = "#1c1c1a";
const SOFT: &str = "#55554f";
const GRID: &str = "#e3e3de";

/// A panel: an axis of work, or of seconds.
struct Axes {
    title: String,
    is_time: bool,
    /// Logarithms at the ends of the axes.
    x: [f64; 2],
    y: [f64; 2],
    /// Edges in the drawing.
    left: f64,
    right: f64,
}

/// The place of a setting along an axis; none of no work, or if it was not timed.
fn across(level: &Level, is_time: bool) -> Option<f64> {
    let value = match is_time {
        false => level.work.price(),
        true => level.time.as_ref()?.median,
    };
    (value > 0.0 && level.error.l2 > 0.0 && level.error.l2.is_finite()).then(|| log10(value))
}

/// Ends of an axis around `places`, with free space; at least half a decade.
fn ends(places: impl Iterator<Item = f64> + Clone) -> Option<[f64; 2]> {
    let low = places.clone().reduce(f64::min)?;
    let high = places.reduce(f64::max)?;
    let space = 0.25 + (0.5 - (high - low)).max(0.0) / 2.0;
    Some([low - space, high + space])
}

/// The diagram of the sweeps of a scene: relative RMS error against work, and against time where that was taken. A curve
/// for each sweep, hollow marks where the error may be that of the reference, a dotted line of the expected order.
pub fn plot(cost: &Cost) -> String {
    let lookups = cost.sweeps.iter().flat_map(|sweep| &sweep.levels);
    let work = match lookups.clone().any(|level| level.work.lookups() > 0.0) {
        true => "lookups per pixel",
        false => "random numbers per pixel",
    };
    let mut panels = Vec::new();
    for (is_time, title) in [
        (false, work),
        (true, "wall time per pixel: median, min to max"),
    ] {
        let places = lookups.clone().filter_map(|level| across(level, is_time));
        let drawn = lookups
            .clone()
            .filter(|level| across(level, is_time).is_some());
        let errors = drawn.map(|level| log10(level.error.l2));
        if let (Some(x), Some(y)) = (ends(places), ends(errors)) {
            panels.push((is_time, title, x, y));
        }
    }
    let count = panels.len().max(1) as f64;
    let each = (WIDTH - LEFT - RIGHT - (count - 1.0) * (LEFT + BETWEEN)) / count;
    let height = ABOVE + HEIGHT + BELOW + LINE * (cost.sweeps.len() as f64 + 1.0);
    let name = xml_text(&words::scene(cost));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
         viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"error against work: {name}\" \
         font-family=\"system-ui, Helvetica, Arial, sans-serif\" font-size=\"11.5\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    for (index, (is_time, title, x, y)) in panels.into_iter().enumerate() {
        let left = LEFT + index as f64 * (each + LEFT + BETWEEN);
        let axes = Axes {
            title: title.to_owned(),
            is_time,
            x,
            y,
            left,
            right: left + each,
        };
        axes.frame(&mut svg);
        for (at, sweep) in cost.sweeps.iter().enumerate() {
            axes.curve(&mut svg, at, sweep);
        }
    }
    legend(&mut svg, cost);
    svg + "</svg>\n"
}

/// A line for each curve, and one for the signs.
fn legend(svg: &mut String, cost: &Cost) {
    let top = ABOVE + HEIGHT + BELOW + 0.5 * LINE;
    for (at, sweep) in cost.sweeps.iter().enumerate() {
        let y = top + LINE * at as f64;
        let colour = COLOURS[at % COLOURS.len()];
        line(svg, &[[LEFT, y], [LEFT + 30.0, y]], colour, 1.8, "");
        mark(svg, [LEFT + 15.0, y], colour, false, "");
        let unit = sweep.parameter.unit();
        let text = format!("{} [{unit}s]: {}", sweep.name, words::fitted(&sweep.order));
        label(svg, &text, [LEFT + 38.0, y], INK, "start");
    }
    let y = top + LINE * cost.sweeps.len() as f64;
    let signs = "numbers: settings; ring: the scene's own; hollow: may be the error of the reference; \
                 dotted: the expected order";
    label(svg, signs, [LEFT, y], SOFT, "start");
}

impl Axes {
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let share = |[low, high]: [f64; 2], value: f64| (value - low) / (high - low);
        [
            self.left + (self.right - self.left) * share(self.x, x),
            ABOVE + HEIGHT * (1.0 - share(self.y, y)),
        ]
    }

    /// Lines at powers of ten with their labels, at 2 and 5 where there are few, and titles.
    fn frame(&self, svg: &mut String) {
        let bottom = ABOVE + HEIGHT;
        for (tick, text) in ticks(self.x, self.is_time) {
            let [x, _] = self.place([tick, self.y[0]]);
            line(svg, &[[x, ABOVE], [x, bottom]], GRID, 1.0, "");
            label(svg, &text, [x, bottom + 12.0], SOFT, "middle");
        }
        for (tick, text) in ticks(self.y, false) {
            let [_, y] = self.place([self.x[0], tick]);
            line(svg, &[[self.left, y], [self.right, y]], GRID, 1.0, "");
            label(svg, &text, [self.left - 6.0, y], SOFT, "end");
        }
        let corner = [self.left, bottom];
        line(
            svg,
            &[[self.left, ABOVE], corner, [self.right, bottom]],
            SOFT,
            1.0,
            "",
        );
        let middle = 0.5 * (self.left + self.right);
        label(svg, &self.title, [middle, bottom + 30.0], INK, "middle");
        label(svg, "relative RMS error", [self.left, 12.0], INK, "start");
    }

    /// The curve of a sweep, number `at` of them.
    fn curve(&self, svg: &mut String, at: usize, sweep: &Sweep) {
        let colour = COLOURS[at % COLOURS.len()];
        let place = |level: &Level| {
            let x = across(level, self.is_time)?;
            Some(self.place([x, log10(level.error.l2)]))
        };
        let points: Vec<_> = sweep.levels.iter().filter_map(place).collect();
        self.guide(svg, colour, sweep);
        line(svg, &points, colour, 1.8, "");
        let (right, below, anchor) = LABELS[at % LABELS.len()];
        for level in &sweep.levels {
            let Some([x, y]) = place(level) else {
                continue;
            };
            if let (true, Some(times)) = (self.is_time, &level.time) {
                let ends = [times.min, times.max].map(|time| self.place([log10(time), 0.0])[0]);
                let inside = ends.map(|x| x.clamp(self.left, self.right));
                line(svg, &[[inside[0], y], [inside[1], y]], colour, 1.0, "");
            }
            if level.value == sweep.own {
                let ring = format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"7\"");
                let _ = writeln!(svg, "{ring} fill=\"none\" stroke=\"{colour}\"/>");
            }
            let (setting, error) = (&level.setting, words::error(level.error.l2));
            let told = format!("{}, {setting}: error {error}", sweep.name);
            mark(
                svg,
                [x, y],
                colour,
                level.error.l2 <= sweep.order.known,
                &told,
            );
            label(
                svg,
                &short(level.value),
                [x + right, y + below],
                colour,
                anchor,
            );
        }
    }

    /// The expected order as a line through the finest setting whose error is surely its own.
    fn guide(&self, svg: &mut String, colour: &str, sweep: &Sweep) {
        let levels = sweep.levels.iter().rev();
        let mut sure = levels.filter(|level| level.error.l2 > sweep.order.known);
        let finest = sure.find_map(|level| Some((across(level, self.is_time)?, level.error.l2)));
        let (Some((x, error)), Some(order)) = (finest, sweep.order.expected) else {
            return;
        };
        // The work is proportional to samples, and inversely to steps.
        let (slope, y) = (-order.abs(), log10(error));
        // Up to where the line leaves the panel.
        let run = (x - self.x[0]).min((self.y[1] - y) / -slope);
        let ends = [[x - run, y - slope * run], [x, y]].map(|end| self.place(end));
        line(svg, &ends, colour, 1.2, " stroke-dasharray=\"1.5 3\"");
    }
}

/// A setting beside its mark: halves of a voxel as fractions, which are shorter.
fn short(value: f64) -> String {
    match value < 1.0 {
        true => format!("1/{}", 1.0 / value),
        false => value.to_string(),
    }
}

/// Logarithms along an axis with their labels.
fn ticks([low, high]: [f64; 2], is_time: bool) -> Vec<(f64, String)> {
    let span = high - low;
    let every = (span / 8.0).ceil();
    let mut ticks = Vec::new();
    for decade in low.floor() as i32..=high.floor() as i32 {
        for part in [1, 2, 5] {
            let tick = f64::from(decade) + log10(f64::from(part));
            let is_wanted = match part {
                1 => (f64::from(decade) / every).fract() == 0.0,
                _ => span < 2.0,
            };
            if is_wanted && (low..=high).contains(&tick) {
                ticks.push((tick, tick_label(part, decade, is_time)));
            }
        }
    }
    ticks
}

/// `part` times ten to the power of `decade`, with the unit of a time.
fn tick_label(part: i32, decade: i32, is_time: bool) -> String {
    let (unit, power) = match (is_time, decade) {
        (false, _) => ("", 0),
        (_, ..-6) => (" ns", -9),
        (_, -6..-3) => (" µs", -6),
        (_, -3..0) => (" ms", -3),
        (_, 0..) => (" s", 0),
    };
    match decade - power {
        left @ 0..5 => format!("{}{unit}", part * 10_i32.pow(left as u32)),
        left => format!("{part}e{left}{unit}"),
    }
}

fn line(svg: &mut String, points: &[[f64; 2]], colour: &str, width: f64, more: &str) {
    let points = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}"));
    let points = points.collect::<Vec<_>>().join(" ");
    let _ = writeln!(
        svg,
        "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{more}/>"
    );
}

/// A mark, and what browsers show where the pointer rests on it.
fn mark(svg: &mut String, [x, y]: [f64; 2], colour: &str, is_hollow: bool, told: &str) {
    let (fill, told) = (if is_hollow { "#ffffff" } else { colour }, xml_text(told));
    let _ = writeln!(
        svg,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.7\" fill=\"{fill}\" stroke=\"{colour}\"><title>{told}</title></circle>"
    );
}

/// A text beside a place, at its height, with an edge of white to be read above lines.
fn label(svg: &mut String, text: &str, [x, y]: [f64; 2], colour: &str, anchor: &str) {
    let text = xml_text(text);
    let _ = writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" dy=\".35em\" fill=\"{colour}\" text-anchor=\"{anchor}\" stroke=\"#ffffff\" \
         stroke-width=\"3\" paint-order=\"stroke\">{text}</text>"
    );
}
